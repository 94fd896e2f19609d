"""Scatter data of the optics program FRED: many incident directions in one file.

    type bsdf_data
    format angles=deg bsdf=value scale=1
    10 0           incident θ and φ
    5 0 0.034271   θ, φ and BSDF [1/sr] of scattered light

A line of two numbers starts the next incident direction. A mirror sends light to the
φ of the incident light: the source stands opposite.

Reference: Photon Engineering's article 304, and files in ua-loft/bsdf-tools.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from clerestory.bsdf.scattering_function import Function
from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.formats.number_table import check_angles, number, table
from clerestory.gonio.scattering_measurement import Measurement, Scan

_KEYS = {"angles": ("deg",), "bsdf": ("value",)}


def read_fred(
    paths: Sequence[Path], *, function: Function = "reflection_front"
) -> tuple[Measurement, ...]:
    """Return the measurement in files of one sample.

    Raises
    ------
    InputError : a file is not of this format
    """
    scans = tuple(scan for path in paths for scan in _read(path))
    return (Measurement(scans, function, name=Path(paths[0]).stem),)


def _read(path: Path) -> list[Scan]:
    lines = [
        (k, text)
        for k, text in enumerate(read_text(path).splitlines(), 1)
        if text.strip()
    ]
    if len(lines) < 3 or lines[0][1].split()[:2] != ["type", "bsdf_data"]:
        raise InputError('not FRED\'s; "type bsdf_data" expected first', file=path)
    scale = _scale(lines[1], path)
    starts = [k for k in range(2, len(lines)) if len(lines[k][1].split()) == 2]
    if not starts or starts[0] != 2:
        raise InputError(
            "no incident direction; a line of θ and φ expected",
            file=path,
            line=lines[2][0],
        )
    scans = []
    for start, end in zip(starts, [*starts[1:], len(lines)], strict=True):
        what = "incident θ and φ [°]"
        incident = table(lines[start : start + 1], columns=2, what=what, file=path)[0]
        what = "θ, φ [°] and BSDF [1/sr]"
        data = table(lines[start + 1 : end], columns=3, what=what, file=path)
        check_angles(incident[:1], most=90, file=path, what="incident θ")
        check_angles(data[:, 0], most=90, file=path)
        source = from_degrees(float(incident[0]), float(incident[1]) + 180)
        leaving = from_degrees(np.minimum(data[:, 0], 89.99), data[:, 1])
        scans.append(Scan(source, leaving, data[:, 2] * scale, str(path)))
    return scans


def _scale(line: tuple[int, str], path: Path) -> float:
    place, text = line
    words = dict(word.split("=", 1) for word in text.split() if "=" in word)
    for key, known in _KEYS.items():
        if words.get(key) not in known:
            raise InputError(
                f"{key} of {words.get(key)!r}; {' or '.join(known)} expected",
                file=path,
                line=place,
            )
    return number(words.get("scale", "1"), what="a scale", file=path, line=place)
