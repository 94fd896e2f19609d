"""Scatter data of the optics program FRED: many incident directions in one file.

    type bsdf_data
    format angles=deg bsdf=value scale=1
    10 0           incident θ and φ
    5 0 0.034271   θ, φ and BSDF [1/sr] of scattered light

A line of two numbers starts the next incident direction. The incident φ is the azimuth
of propagation: mirror reflection is at the same φ.

Reference: Photon Engineering's article 304, and files in ua-loft/bsdf-tools.
"""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

from clerestory.checks import require
from clerestory.gonio.formats.file_format import (
    FileFormat,
    ReadOptions,
    number,
    numbered_lines,
    scan_of_block,
)
from clerestory.gonio.scattering_measurement import Measurement


def _read(path: Path, options: ReadOptions) -> Iterator[Measurement]:
    lines = numbered_lines(path)
    require(
        len(lines) >= 3 and lines[0][1].split()[:2] == ["type", "bsdf_data"],
        'not a FRED file; "type bsdf_data" in the first line expected',
    )
    place, text = lines[1]
    words = dict(word.split("=", 1) for word in text.split() if "=" in word)
    for key, known in (("angles", "deg"), ("bsdf", "value")):
        message = f"{key} is {words.get(key)!r}; {known!r} expected"
        require(words.get(key) == known, message, line=place)
    scale = number(words.get("scale", "1"), what="a scale", line=place)
    starts = [k for k in range(2, len(lines)) if len(lines[k][1].split()) == 2]
    message = "no incident direction; a line of θ and φ expected"
    require(starts and starts[0] == 2, message, line=lines[2][0])
    scans = tuple(
        scan_of_block(lines[start:end], path, scale=scale)
        for start, end in pairwise([*starts, len(lines)])
    )
    yield Measurement(scans, options.function or "reflection_front", name=path.stem)


FORMAT = FileFormat("fred", lambda head: head.has_line("type bsdf_data"), _read)
