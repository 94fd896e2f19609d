"""Text files with columns of incident θ and φ, scattered θ and φ [°], and a value.

    theta_i,phi_i,theta_s,phi_s,btdf
    30,0,30,180,12.5

Incident and scattered φ are measured from the same axis, from right to up: undeviated
transmission is at φ + 180°. The last column name is bsdf, brdf, btdf or value [1/sr],
or dsf for BSDF times the cosine of θ_s. Columns are separated by commas,
semicolons or blanks.
"""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.scattering_function import Function
from clerestory.errors import InputError
from clerestory.gonio.formats.file_format import FileFormat, ReadOptions
from clerestory.gonio.formats.text_tables import (
    check_angles,
    numbered_lines,
    scan_of_rows,
    table,
)
from clerestory.gonio.scattering_measurement import Measurement, Scan

_ANGLES = ("theta_i", "phi_i", "theta_s", "phi_s")
_VALUES = ("bsdf", "brdf", "btdf", "value", "dsf")


def scans_of(data: Float[np.ndarray, "rows 5"], path: Path) -> tuple[Scan, ...]:
    """Group rows of four angles [°] and BSDF [1/sr] into one scan per incidence."""
    check_angles(data[:, 0], most=90, file=path, what="incident θ")
    incident = np.round(data[:, :2] % [1e9, 360], 6)
    incident[incident[:, 0] == 0, 1] = 0
    every, which = np.unique(incident, axis=0, return_inverse=True)
    return tuple(
        scan_of_rows(angles, data[which.ravel() == k, 2:], path)
        for k, angles in enumerate(every.tolist())
    )


def _read(paths: Sequence[Path], options: ReadOptions) -> tuple[Measurement, ...]:
    scans: list[Scan] = []
    kind = ""
    for path in paths:
        data, kind = _read_file(path)
        scans.extend(scans_of(data, path))
    default: Function = "transmission_front" if kind == "btdf" else "reflection_front"
    function = options.function or default
    return (Measurement(tuple(scans), function, name=paths[0].stem),)


def _read_file(path: Path) -> tuple[Float[np.ndarray, "rows 5"], str]:
    lines = numbered_lines(path, comment="#")
    if not lines:
        raise InputError("the file is empty; columns with a header expected", file=path)
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


FORMAT = FileFormat("columns", lambda head: head.has_line("theta_i"), _read)
