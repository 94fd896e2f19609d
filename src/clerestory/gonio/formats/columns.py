"""Plain columns: incident θ and φ, scattered θ and φ [°], and a value.

    theta_i,phi_i,theta_s,phi_s,btdf
    30,0,30,180,12.5

φ of source and scattered light count alike, from the right towards up: straight on is
φ + 180°. The head names the value: bsdf, brdf, btdf or value [1/sr], or dsf for BSDF
times the cosine of θ_s. Columns are separated by commas, semicolons or blanks.
"""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.scattering_function import Function
from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.formats.number_table import check_angles, table
from clerestory.gonio.scattering_measurement import Measurement, Scan

_ANGLES = ("theta_i", "phi_i", "theta_s", "phi_s")
_VALUES = ("bsdf", "brdf", "btdf", "value", "dsf")


def read_columns(
    paths: Sequence[Path], *, function: Function | None = None
) -> tuple[Measurement, ...]:
    """Return the measurement in files of one sample.

    Parameters
    ----------
    function : None for what the head says, transmission for btdf, else reflection

    Raises
    ------
    InputError : a file is not of this format
    """
    scans: list[Scan] = []
    kind = ""
    for path in paths:
        data, kind = _read(path)
        scans.extend(scans_of(data, path))
    deduced: Function = "transmission_front" if kind == "btdf" else "reflection_front"
    return (Measurement(tuple(scans), function or deduced, name=paths[0].stem),)


def _read(path: Path) -> tuple[Float[np.ndarray, "rows 5"], str]:
    lines = [
        (k, text)
        for k, text in enumerate(read_text(path).splitlines(), 1)
        if text.strip() and not text.lstrip().startswith("#")
    ]
    if not lines:
        raise InputError("an empty file; columns with a head expected", file=path)
    head = [word.lower() for word in re.split(r"[,;\s]+", lines[0][1].strip())]
    value = head[-1]
    if tuple(head[:-1]) != _ANGLES or value not in _VALUES:
        raise InputError(
            f"columns {', '.join(head)[:80]}; theta_i, phi_i, theta_s, phi_s and one of"
            f" {', '.join(_VALUES)} expected",
            file=path,
            line=lines[0][0],
        )
    data = table(lines[1:], columns=5, what="four angles [°] and a value", file=path)
    if value == "dsf":
        data[:, 4] /= np.maximum(np.cos(np.radians(data[:, 2])), 1e-6)
    return data, value


def scans_of(data: Float[np.ndarray, "rows 5"], path: Path) -> tuple[Scan, ...]:
    """Return a scan for each incident direction among rows of angles [°] and BSDF."""
    check_angles(data[:, 0], most=90, file=path, what="incident θ")
    check_angles(data[:, 2], most=90, file=path)
    turned = np.round(data[:, :2] % [1e9, 360], 6)
    turned[turned[:, 0] == 0, 1] = 0
    incident, which = np.unique(turned, axis=0, return_inverse=True)
    leaving = from_degrees(np.minimum(data[:, 2], 89.99), data[:, 3])
    return tuple(
        Scan(
            from_degrees(float(theta), float(phi)),
            leaving[which.ravel() == k],
            data[which.ravel() == k, 4],
            str(path),
        )
        for k, (theta, phi) in enumerate(incident)
    )
