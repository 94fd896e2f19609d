"""BSDF tables of Radiant and Zemax by rotation, incidence, azimuth and radius.

Scattered directions are relative to the mirror direction: the radius is the angle to
the mirror direction, azimuth 0 points to the normal, and azimuths run anticlockwise. A
sample rotation rotates the incident direction in the opposite sense. Zeros after the
last non-zero value of a row mark directions that were not measured; these directions
and directions below the sample are skipped.

"PlaneSymmetrical" files contain half of the azimuths and are completed by mirror
images. A sample with a single rotation is treated as isotropic. Of tristimulus files
only Y is read.

References: R. Rykowski, "BSDF Data Interchange File Format Specification", Radiant
Zemax 2008; for the coordinate frame, ua-loft/bsdf-tools, fred_frame_to_zemax.m.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.bsdf.scattering_function import OF_SIDE, Side
from clerestory.checks import require
from clerestory.gonio.angles import angle_between, from_degrees, undeviated
from clerestory.gonio.formats.file_format import (
    FileFormat,
    Line,
    ReadOptions,
    check_angles,
    numbered_lines,
    table,
)
from clerestory.gonio.scattering_measurement import Measurement, Scan
from clerestory.gonio.symmetry import Symmetry

_AXES = ("SampleRotation", "AngleOfIncidence", "ScatterAzimuth", "ScatterRadial")
_SYMMETRIES = ("planesymmetrical", "asymmetrical", "asymmetrical4d")

# Largest number of values in a file; a larger number indicates a damaged file.
_MOST_VALUES = 50_000_000

_SAME = 1e-6  # angle below which directions count as equal [rad]


# Line number and words of each header line, by the first word
_Heads = dict[str, tuple[int, list[str]]]


@dataclass(frozen=True, eq=False)
class _Table:
    kind: str
    symmetry: str
    axes: tuple[Float[np.ndarray, " _"], ...]
    values: Float[np.ndarray, "rotation incidence azimuth radius"]


def _read(path: Path, options: ReadOptions) -> Iterator[Measurement]:
    side: Side = "back" if (options.function or "").endswith("back") else "front"
    found = _read_file(path)
    scans: list[Scan] = []
    for rotation, block in zip(found.axes[0], found.values, strict=True):
        if len(found.axes[0]) > 1 and rotation >= 360:
            continue
        for incidence, values in zip(found.axes[1], block, strict=True):
            scans.append(_scan(float(rotation), float(incidence), values, found, path))
    function = OF_SIDE[side][0 if found.kind == "btdf" else 1]
    claimed: Symmetry | None = "isotropic" if len(found.axes[0]) == 1 else None
    yield Measurement(tuple(scans), function, name=path.stem, claimed=claimed)


def _read_file(path: Path) -> _Table:
    numbered = numbered_lines(path, comment="#")
    lines = [(number, text.strip()) for number, text in numbered]
    heads = [(k, text.split()) for k, text in lines if text[:1].isalpha()]
    head: _Heads = {words[0]: (k, words) for k, words in heads}
    kind = _choice(head, "ScatterType", ("brdf", "btdf"))
    symmetry = _choice(head, "Symmetry", _SYMMETRIES)
    axes = tuple(_axis(lines, head, name) for name in _AXES)
    check_angles(axes[1], most=90, what="angle of incidence")
    shape = tuple(len(axis) for axis in axes)
    counts = " × ".join(map(str, shape))
    message = f"{counts} values; at most {_MOST_VALUES} expected"
    require(np.prod(shape, dtype=float) <= _MOST_VALUES, message)
    marks = [
        k
        for k, (_, text) in enumerate(lines, 1)
        if text.upper().startswith("DATABEGIN")
    ]
    require(marks, "no DataBegin line; DataBegin and a table of BSDF values expected")
    # Tristimulus files contain tables of X, Y and Z in this order
    rows = [
        line
        for line in lines[marks[1 if len(marks) == 3 else 0] :]
        if not line[1].upper().startswith(("TIS", "DATAEND"))
    ]
    wanted = shape[0] * shape[1] * shape[2]
    require(
        len(rows) >= wanted,
        f"{len(rows)} rows of values; {wanted} rows (rotations × incidences ×"
        " azimuths) expected",
    )
    data = table(rows[:wanted], columns=shape[3], what="BSDF values [1/sr]")
    return _Table(kind, symmetry, axes, data.reshape(shape))


def _choice(head: _Heads, key: str, known: tuple[str, ...]) -> str:
    place, words = head.get(key, (None, [key]))
    value = words[1].lower() if len(words) > 1 else "missing"
    message = f"{key} is {value}; one of {', '.join(known)} expected"
    require(value in known, message, line=place)
    return value


def _axis(lines: list[Line], head: _Heads, key: str) -> Values:
    message = f"no {key}; the number of angles and a line of angles expected"
    require(key in head, message)
    place, words = head[key]
    following = next(((k, text) for k, text in lines if k > place), (place, ""))
    count = len(following[1].split())
    angles = table([following], columns=count or 1, what=f"angles of {key}")
    message = f"{count} angles of {key}; {words[-1]} expected"
    require(len(words) < 2 or words[1] == str(count), message, line=following[0])
    return np.asarray(angles[0])


def _scan(
    rotation: float,
    incidence: float,
    values: Float[np.ndarray, "azimuth radius"],
    found: _Table,
    path: Path,
) -> Scan:
    azimuth, radius = np.radians(found.axes[2]), np.radians(found.axes[3])
    source = from_degrees(incidence, 180.0 - rotation)
    centre = undeviated(source)
    ahead = np.array([0.0, 0, 1]) - centre[2] * centre
    if np.linalg.norm(ahead) < _SAME:
        ahead = np.array(
            [-np.cos(np.radians(rotation)), np.sin(np.radians(rotation)), 0]
        )
    ahead = ahead / np.linalg.norm(ahead)
    across = np.cross(centre, ahead)
    a, r = np.meshgrid(azimuth, radius, indexing="ij")
    leaving = (
        np.cos(r)[..., None] * centre
        + (np.sin(r) * np.cos(a))[..., None] * ahead
        + (np.sin(r) * np.sin(a))[..., None] * across
    )
    measured = np.flip(np.cumsum(np.flip(values != 0, 1), 1), 1) > 0
    keep = measured & (leaving[..., 2] > 1e-3)
    # Radius 0 is the same direction in every row: keep only the first row's value
    keep[1:, :] &= angle_between(leaving[1:], leaving[:1]) > _SAME
    points, bsdf = leaving[keep], values[keep]
    if found.symmetry == "planesymmetrical":
        side = np.cross(centre, [0, 0, 1.0]) if incidence > 0 else across
        side = side / np.linalg.norm(side)
        image = points - 2 * (points @ side)[:, None] * side
        new = angle_between(points, image) > _SAME
        points = np.concatenate([points, image[new]])
        bsdf = np.concatenate([bsdf, bsdf[new]])
    return Scan(source, points, bsdf, str(path))


FORMAT = FileFormat(
    "zemax", lambda head: head.has_line("samplerotation", "angleofincidence"), _read
)
