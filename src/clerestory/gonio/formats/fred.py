"""Scatter data of the optics program FRED: many incident directions in one file.

    type bsdf_data
    format angles=deg bsdf=value scale=1
    10 0           incident θ and φ
    5 0 0.034271   θ, φ and BSDF [1/sr] of scattered light

A line of two numbers starts the next incident direction. The incident φ is the azimuth
of propagation: mirror reflection is at the incident φ.

Reference: Photon Engineering's article 304, and files in ua-loft/bsdf-tools.
"""

from collections.abc import Sequence
from pathlib import Path

from clerestory.errors import InputError
from clerestory.gonio.formats.file_format import FileFormat, FileHead, ReadOptions
from clerestory.gonio.formats.text_tables import (
    Line,
    number,
    numbered_lines,
    scan_of_block,
)
from clerestory.gonio.scattering_measurement import Measurement, Scan

_KEYS = {"angles": ("deg",), "bsdf": ("value",)}


def _read(paths: Sequence[Path], options: ReadOptions) -> tuple[Measurement, ...]:
    scans = tuple(scan for path in paths for scan in _read_file(path))
    function = options.function or "reflection_front"
    return (Measurement(scans, function, name=paths[0].stem),)


def _read_file(path: Path) -> list[Scan]:
    lines = numbered_lines(path)
    if len(lines) < 3 or lines[0][1].split()[:2] != ["type", "bsdf_data"]:
        raise InputError(
            'not a FRED file; "type bsdf_data" in the first line expected', file=path
        )
    scale = _scale(lines[1], path)
    starts = [k for k in range(2, len(lines)) if len(lines[k][1].split()) == 2]
    if not starts or starts[0] != 2:
        raise InputError(
            "no incident direction; a line of θ and φ expected",
            file=path,
            line=lines[2][0],
        )
    ends = [*starts[1:], len(lines)]
    return [
        scan_of_block(lines[start:end], path, scale=scale)
        for start, end in zip(starts, ends, strict=True)
    ]


def _scale(line: Line, path: Path) -> float:
    place, text = line
    words = dict(word.split("=", 1) for word in text.split() if "=" in word)
    for key, known in _KEYS.items():
        if words.get(key) not in known:
            raise InputError(
                f"{key} is {words.get(key)!r}; {' or '.join(known)} expected",
                file=path,
                line=place,
            )
    return number(words.get("scale", "1"), what="a scale", file=path, line=place)


def _recognizes(head: FileHead) -> bool:
    return bool(head.lines) and head.lines[0].startswith("type bsdf_data")


FORMAT = FileFormat("fred", _recognizes, _read)
