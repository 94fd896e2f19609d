"""Data files of ASTM E1392: a header of keywords, then lines of angles and values.

    KEYWORD value
    VARS theta_i,phi_i,theta_s,phi_s,BRDF
    0.17,0.0,0.35,3.14,0.081

Angles are in radians, or in degrees if any angle exceeds 2π. Incident and scattered φ
are measured from the same axis: mirror reflection is at φ + 180°. Columns X, Y and Z
are read as three channels; other columns (R, G, B or wavelengths) are averaged.

References: ASTM E1392-96, "Standard practice for angle resolved optical scatter
measurements on specular or diffuse surfaces"; files of Cornell University's Light
Measurement Laboratory.
"""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.errors import InputError
from clerestory.gonio.formats.columns import scans_of
from clerestory.gonio.formats.file_format import FileFormat, ReadOptions, single_file
from clerestory.gonio.formats.text_tables import numbered_lines, table
from clerestory.gonio.scattering_measurement import Measurement

_ANGLES = 4
_VARS = re.compile(r"^\s*VARS\s+(.*)$", re.IGNORECASE)


def _read(paths: Sequence[Path], options: ReadOptions) -> tuple[Measurement, ...]:
    path = single_file(paths, "ASTM")
    lines = numbered_lines(path)
    heads = ((k, _VARS.match(text)) for k, (_, text) in enumerate(lines))
    start, found = next(((k, match) for k, match in heads if match), (0, None))
    if found is None:
        raise InputError("no VARS line; the names of the columns expected", file=path)
    names = [name.strip().lower() for name in found[1].split(",") if name.strip()]
    if len(names) <= _ANGLES:
        raise InputError(
            f"{len(names)} columns; four angles and one or more values expected",
            file=path,
            line=lines[start][0],
        )
    what = "four angles and BSDF values [1/sr]"
    data = table(lines[start + 1 :], columns=len(names), what=what, file=path)
    angles = data[:, :_ANGLES]
    if np.abs(angles).max() <= 2 * np.pi + 1e-6:
        angles = np.degrees(angles)
    return tuple(
        Measurement(
            scans_of(np.column_stack([angles, values]), path),
            options.function or "reflection_front",
            channel,
            name=path.stem,
        )
        for channel, values in _channels(names[_ANGLES:], data[:, _ANGLES:]).items()
    )


def _channels(
    names: list[str], values: Float[np.ndarray, "rows columns"]
) -> dict[str, Values]:
    if names == ["x", "y", "z"]:
        x, y, z = values.T
        return {"visible": y, "cie-x": x, "cie-z": z}
    return {"visible": values.mean(axis=1)}


FORMAT = FileFormat("astm", lambda head: head.has_line("vars"), _read)
