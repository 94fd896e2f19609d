"""Text files with columns of incident θ and φ, scattered θ and φ [°], and BSDF.

    theta_i,phi_i,theta_s,phi_s,btdf
    30,0,30,180,12.5

Incident and scattered φ both run from right (0°) to up (90°): undeviated transmission
is at φ + 180°. The last column name is bsdf, brdf, btdf or value [1/sr], or dsf for
BSDF times the cosine of θ_s. Columns are separated by commas, semicolons or blanks.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.scattering_function import Function
from clerestory.checks import require
from clerestory.gonio.formats.file_format import (
    FileFormat,
    ReadOptions,
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
    check_angles(data[:, 0], most=90, what="incident θ")
    incident = np.round(data[:, :2] % [1e9, 360], 6)
    incident[incident[:, 0] == 0, 1] = 0
    every, which = np.unique(incident, axis=0, return_inverse=True)
    return tuple(
        scan_of_rows(angles, data[which.ravel() == k, 2:], path)
        for k, angles in enumerate(every.tolist())
    )


def _read(path: Path, options: ReadOptions) -> Iterator[Measurement]:
    lines = numbered_lines(path, comment="#")
    require(lines, "the file is empty; columns with a header expected")
    place, text = lines[0]
    *angles, value = (word.lower() for word in re.split(r"[,;\s]+", text.strip()))
    require(
        angles == list(_ANGLES) and value in _VALUES,
        f"columns {', '.join([*angles, value])[:80]}; {', '.join(_ANGLES)} and one of"
        f" {', '.join(_VALUES)} expected",
        line=place,
    )
    data = table(lines[1:], columns=5, what="four angles [°] and a value")
    if value == "dsf":
        data[:, 4] /= np.maximum(np.cos(np.radians(data[:, 2])), 1e-6)
    default: Function = "transmission_front" if value == "btdf" else "reflection_front"
    yield Measurement(scans_of(data, path), options.function or default, name=path.stem)


FORMAT = FileFormat("columns", lambda head: head.has_line("theta_i"), _read)
