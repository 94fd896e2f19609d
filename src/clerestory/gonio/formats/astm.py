"""Data files of ASTM E1392: a header of keywords, then lines of angles and values.

    KEYWORD value
    VARS theta_i,phi_i,theta_s,phi_s,BRDF
    0.17,0.0,0.35,3.14,0.081

Angles are in radians, or in degrees if any is larger than 2π. φ of source and scattered
light count alike, so that a mirror sends light to φ + 180°. Columns X, Y, Z make three
channels; of other colours the mean is taken, as of R, G, B or wavelengths.

References: ASTM E1392-96, "Standard practice for angle resolved optical scatter
measurements on specular or diffuse surfaces"; files of Cornell University's Light
Measurement Laboratory.
"""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.scattering_function import Function
from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.gonio.formats.columns import scans_of
from clerestory.gonio.formats.number_table import table
from clerestory.gonio.scattering_measurement import Measurement

_ANGLES = 4
_VARS = re.compile(r"^\s*VARS\s+(.*)$", re.IGNORECASE)


def read_astm(
    paths: Sequence[Path], *, function: Function = "reflection_front"
) -> tuple[Measurement, ...]:
    """Return the measurements of one file, one per channel.

    Raises
    ------
    InputError : the file is not of this format, or more than one is given
    """
    if len(paths) != 1:
        raise InputError(f"{len(paths)} ASTM files; one a measurement expected")
    (path,) = paths
    lines = list(enumerate(read_text(path).splitlines(), 1))
    heads = [(k, _VARS.match(text)) for k, text in lines]
    start, found = next(((k, m) for k, m in heads if m), (0, None))
    if found is None:
        raise InputError("no VARS line; the names of the columns expected", file=path)
    names = [name.strip().lower() for name in found[1].split(",") if name.strip()]
    if len(names) <= _ANGLES:
        raise InputError(
            f"{len(names)} columns; four angles and values expected",
            file=path,
            line=start,
        )
    what = "four angles and BSDF values [1/sr]"
    data = table(lines[start:], columns=len(names), what=what, file=path)
    angles = data[:, :_ANGLES]
    if np.abs(angles).max() <= 2 * np.pi + 1e-6:
        angles = np.degrees(angles)
    return tuple(
        Measurement(
            scans_of(np.column_stack([angles, values]), path),
            function,
            channel,
            name=path.stem,
        )
        for channel, values in _channels(names[_ANGLES:], data[:, _ANGLES:]).items()
    )


def _channels(
    names: list[str], values: Float[np.ndarray, "rows columns"]
) -> dict[str, Float[np.ndarray, " rows"]]:
    if names == ["x", "y", "z"]:
        x, y, z = values.T
        return {"visible": y, "cie-x": x, "cie-z": z}
    return {"visible": values.mean(axis=1)}
