"""Radiance's genprism: polygons in the plane z = 0, extruded along a vector.

Corners may be rounded. A circle of radius r that is tangent to both edges at a corner
has its centre t·r before the corner, measured along the edge, and r inside the outline;
t is the tangent of half the exterior angle, negative at concave corners.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from jaxtyping import Float

from clerestory.array_types import Vector
from clerestory.files import read_text
from clerestory.formats.word_reader import WordReader
from clerestory.scene.primitive import Primitive, primitive
from clerestory.scene.transform import number

_TINY = 1e-6
_MOST_CORNERS = 100_000


@dataclass(frozen=True, eq=False)
class _Prism:
    material: str
    name: str
    outline: Float[np.ndarray, "corners 2"]
    along: Vector
    radius: float
    ends: bool
    open_side: bool

    @property
    def upwards(self) -> float:
        return 1.0 if self.along[2] > 0 else -1.0

    def part(self, kind: str, label: str, reals: npt.ArrayLike) -> Primitive:
        return primitive(self.material, kind, f"{self.name}.{label}", reals)

    def ends_at(self, points: Float[np.ndarray, "corners 2"]) -> list[Primitive]:
        base = _base(points)
        return [
            self.part("polygon", "b", base),
            self.part("polygon", "t", base[::-1] + self.along),
        ]


def prism(words: WordReader, find: Callable[[str], Path]) -> list[Primitive]:
    """Return the primitives of a prism.

    `genprism material name {file | N x1 y1 … xN yN} [-l x y z][-r radius][-c][-e]`:
    -l gives the extrusion vector (default 0 0 1), -r rounds corners, -c omits the face
    from the last corner to the first, -e omits both ends.
    """
    material, name = words.word("a material"), words.word("a name")
    outline = _outline(words, find)
    along, radius, ends, open_side = np.array([0.0, 0.0, 1.0]), 0.0, True, False
    while words.left:
        match words.option():
            case "-l":
                along = words.several(3, "the vector")
            case "-r":
                radius = words.real("the radius")
            case "-e":
                ends = not ends
            case "-c":
                open_side = not open_side
            case option:
                raise words.unknown(option)
    if abs(along[2]) <= _TINY:
        raise words.error("the vector of -l is in the plane of the outline")
    made = _Prism(material, name, outline, along, radius, ends, open_side)
    if radius <= _TINY:
        return _sharp(made)
    if radius > abs(along[2]):
        raise words.error(f"rounding by {radius:g} exceeds the height; less expected")
    return _round(made, words)


def _outline(
    words: WordReader, find: Callable[[str], Path]
) -> Float[np.ndarray, "corners 2"]:
    first = words.word("a file of corners, or their number")
    if first == "-":
        raise words.error("corners from standard input are not supported")
    if first[0].isdigit():
        words.at -= 1
        count = words.whole("number of corners", 3, _MOST_CORNERS)
        flat = [words.real(f"coordinate {i + 1}") for i in range(2 * count)]
    else:
        read = [number(word) for word in read_text(find(first)).split()]
        flat = [value for value in read if value is not None]
        if len(flat) < max(len(read), 6) or len(flat) % 2:
            raise words.error(
                f'the file "{first}" has {len(read)} words; two numbers for each of'
                " at least 3 corners expected"
            )
    return np.array(flat).reshape(-1, 2)


def _base(points: Float[np.ndarray, "points 2"]) -> Float[np.ndarray, "points 3"]:
    return np.column_stack([points, np.zeros(len(points))])


def _sides(made: _Prism) -> range:
    return range(len(made.outline) - made.open_side)


def _sharp(made: _Prism) -> list[Primitive]:
    low = _base(made.outline)
    top = low + made.along
    parts = made.ends_at(made.outline) if made.ends else []
    for i in _sides(made):
        j = (i + 1) % len(low)
        corners = np.stack([low[i], top[i], top[j], low[j]])
        parts.append(made.part("polygon", f"{i + 1}", corners))
    return parts


def _round(made: _Prism, words: WordReader) -> list[Primitive]:
    # u: unit vector from each corner to the previous one
    corner, r = made.outline, made.radius * made.upwards
    back = np.roll(corner, 1, axis=0) - corner
    length = np.linalg.norm(back, axis=1, keepdims=True)
    if length.min() <= _TINY:
        raise words.error("two corners coincide; distinct corners expected")
    u = back / length
    ahead = np.roll(u, -1, axis=0)
    cosine = np.einsum("cx,cx->c", u, ahead)
    if (1 + cosine).min() <= _TINY:
        raise words.error("two sides overlap; sides at an angle expected")
    turn = np.sign(ahead[:, 0] * u[:, 1] - ahead[:, 1] * u[:, 0])
    t = turn * np.sqrt(np.maximum(1 - cosine, 0) / (1 + cosine))
    inside = np.stack([-u[:, 1], u[:, 0]], axis=1)
    centre = corner + r * (t[:, None] * u + inside)

    parts = _round_ends(made, centre, t, r) if made.ends else []
    for i in _sides(made):
        parts += _round_side(made, i, u, t, centre)
    return parts


def _round_side(
    made: _Prism,
    i: int,
    u: Float[np.ndarray, "corners 2"],
    t: Float[np.ndarray, " corners"],
    centre: Float[np.ndarray, "corners 2"],
) -> list[Primitive]:
    j, r = (i + 1) % len(t), made.radius * made.upwards
    # In oblique prisms, the tangent points are not in a horizontal plane
    tilt = made.along[1] * u[j, 0] - made.along[0] * u[j, 1]
    sine = made.upwards * tilt / np.linalg.norm(made.along)
    sine = sine if abs(sine) > _TINY else 0.0
    level = 1 - np.sqrt(1 - sine**2)
    shift = r * np.array([-level * u[j, 1], level * u[j, 0], sine])
    rise = np.array([0, 0, r])
    start = np.append(made.outline[i] - r * t[i] * u[j], 0) + shift
    end = np.append(made.outline[j] + r * t[j] * u[j], 0) + shift
    lid = made.along - rise
    corners = np.stack([start + rise, start + lid, end + lid, end + rise])
    parts = [made.part("polygon", f"{i + 1}", corners)]
    if made.upwards * t[j] >= 0:
        axis = np.append(centre[j], 0)
        reals = [*(axis + rise), *(axis + lid), made.radius]
        parts.append(made.part("cylinder", f"e{i + 1}", reals))
    return parts


def _round_ends(
    made: _Prism,
    centre: Float[np.ndarray, "corners 2"],
    t: Float[np.ndarray, " corners"],
    r: float,
) -> list[Primitive]:
    parts = made.ends_at(centre)
    lifts = {"b": np.array([0, 0, r]), "t": made.along - np.array([0, 0, r])}
    for end, lift in lifts.items():
        points = _base(centre) + lift
        for i, point in enumerate(points):
            if made.upwards * t[i] > 0:
                parts.append(
                    made.part("sphere", f"{end}c{i + 1}", [*point, made.radius])
                )
            reals = [*points[i - 1], *point, made.radius]
            parts.append(made.part("cylinder", f"{end}e{i + 1}", reals))
    return parts
