"""Radiance's gensurf, genrev and genworm: surfaces given by formulas.

Formulas, and the definitions given by -e and -f, are in Radiance's function language.
Surfaces are flat facets and cones; -s (smooth normals) is ignored with a warning.
"""

import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
from jaxtyping import Bool, Float

from clerestory.array_types import Vector
from clerestory.errors import ClerestoryWarning
from clerestory.files import read_text
from clerestory.formats.word_reader import WordReader
from clerestory.radiance.cal.program import Program
from clerestory.radiance.cal.syntax import (
    Definition,
    Node,
    parse_definitions,
    parse_expression,
)
from clerestory.scene.primitive import Primitive, primitive

Find = Callable[[str], Path]

# Differences of coordinates or radii treated as zero, as in Radiance's generators
_TINY = 1e-7

# Maximum 1 − cos of the angle between two triangles merged to a quadrilateral
_FLAT = 1e-12

_MOST_STEPS = 100_000


@dataclass(frozen=True, eq=False)
class _Formulas:
    material: str
    name: str
    program: Program
    nodes: tuple[Node, ...]

    def part(self, kind: str, label: str, reals: npt.ArrayLike) -> Primitive:
        return primitive(self.material, kind, f"{self.name}.{label}", reals)

    def at(self, **places: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n values"]:
        """Return the formulas' values at given parameters; NaN where undefined."""
        count = len(next(iter(places.values())))
        computed = self.program.values(self.nodes, {"S": np.ones(count), **places})
        return np.where(computed.valid[:, None], computed.value, np.nan)


def revolution(words: WordReader, find: Find) -> list[Primitive]:
    """Return the primitives of `genrev material name z(t) r(t) segments`.

    Options: -e, -f and -s.
    """
    formulas, [count] = _read(words, find, 2, ("number of segments",))
    value = _finite(formulas.at(t=np.linspace(0, 1, count + 1)), words)
    made = []
    for i, ((z0, r0), (z1, r1)) in enumerate(pairwise(value), 1):
        level, straight = abs(z1 - z0) <= _TINY, abs(r1 - r0) <= _TINY
        axis = (0.0, 0.0, z0, 0.0, 0.0, z1)
        reals: tuple[float, ...]
        if level and straight:
            continue
        if straight:
            kind, reals = "tube" if z1 < z0 else "cylinder", (*axis, r1)
        elif level:
            facing = 1.0 if r1 < r0 else -1.0
            kind, reals = "ring", (0.0, 0.0, z1, 0.0, 0.0, facing, r0, r1)
        else:
            kind, reals = "cup" if z1 < z0 else "cone", (*axis, r0, r1)
        made.append(formulas.part(kind, str(i), reals))
    return made


def worm(words: WordReader, find: Find) -> list[Primitive]:
    """Return the primitives of `genworm material name x(t) y(t) z(t) r(t) segments`.

    Options: -e and -f.
    """
    formulas, [count] = _read(words, find, 4, ("number of segments",))
    value = _finite(formulas.at(t=np.linspace(0, 1, count + 1)), words)
    if value[:, 3].min() <= 0:
        raise words.error(f"the radius is {value[:, 3].min():g}; above 0 expected")
    made = [formulas.part("sphere", "s0", value[0])]
    for i, (last, this) in enumerate(pairwise(value), 1):
        made += _link(formulas, f"c{i}", last, this)
        made.append(formulas.part("sphere", f"s{i}", this))
    return made


def _link(
    formulas: _Formulas, label: str, last: np.ndarray, this: np.ndarray
) -> list[Primitive]:
    # Cone tangent to two spheres; none if one sphere contains the other
    step = this[:3] - last[:3]
    length = float(np.linalg.norm(step))
    fall = float(last[3] - this[3])
    if length <= abs(fall):
        return []
    if abs(fall) <= _TINY:
        reals = [*last[:3], *this[:3], this[3]]
        return [formulas.part("cylinder", label, reals)]
    sine = fall / length
    cosine = np.sqrt(1 - sine**2)
    along = step / length
    ends = [end[:3] + end[3] * sine * along for end in (last, this)]
    reals = [*ends[0], *ends[1], last[3] * cosine, this[3] * cosine]
    return [formulas.part("cone", label, reals)]


def surface(words: WordReader, find: Find) -> list[Primitive]:
    """Return the polygons of `gensurf material name x(s,t) y(s,t) z(s,t) m n`.

    Options: -e, -f and -s. If `valid(s,t)` is defined, points where it is zero or
    negative are omitted.
    """
    formulas, [m, n] = _read(words, find, 3, ("rows", "columns"))
    steps = np.arange(m + 1) / m, np.arange(n + 1) / n
    s, t = (grid.ravel() for grid in np.meshgrid(*steps, indexing="ij"))
    valid = np.ones(len(s), dtype=bool)
    if formulas.program.arity("valid") == 2:
        check = parse_expression("valid(s,t)")
        computed = formulas.program.values((check,), {"S": s * 0 + 1, "s": s, "t": t})
        valid = computed.value[:, 0] > 0
    points = np.zeros((len(s), 3))
    if valid.any():
        points[valid] = _finite(formulas.at(s=s[valid], t=t[valid]), words)
    grid = points.reshape(m + 1, n + 1, 3)
    shapes = _facets(grid, valid.reshape(m + 1, n + 1))
    return [formulas.part("polygon", str(i), c) for i, c in enumerate(shapes, 1)]


def _facets(
    grid: Float[np.ndarray, "rows columns 3"], valid: Bool[np.ndarray, "rows columns"]
) -> Iterator[Float[np.ndarray, "corners 3"]]:
    # One planar quadrilateral per cell, or two triangles with alternating diagonals
    for i in range(len(grid) - 1):
        for j in range(grid.shape[1] - 1):
            turned = bool(j & 1)
            if not (valid[i, j] and valid[i + 1, j + 1]):
                turned = True
            elif not (valid[i + 1, j] and valid[i, j + 1]):
                turned = False
            square = ((0, 0), (1, 0), (0, 1), (1, 1))
            square = square if turned else ((1, 0), (1, 1), (0, 0), (0, 1))
            cell = [(i + a, j + b) for a, b in square]
            corner = np.array([grid[place] for place in cell])
            yield from _square(corner, [bool(valid[place]) for place in cell])


def _square(
    p: Float[np.ndarray, "4 3"], known: list[bool]
) -> Iterator[Float[np.ndarray, "corners 3"]]:
    first = _normal(p[[0, 1, 2]]) if all(known[:3]) else None
    second = _normal(p[[2, 1, 3]]) if all(known[1:]) else None
    if first is not None and second is not None and first @ second >= 1 - _FLAT:
        yield p[[0, 1, 3, 2]]
        return
    if first is not None:
        yield p[[0, 1, 2]]
    if second is not None:
        yield p[[2, 1, 3]]


def _normal(corner: Float[np.ndarray, "3 3"]) -> Vector | None:
    # Written out, as np.cross of single vectors takes most of the time
    (a, b, c), (d, e, f) = (corner[1:] - corner[0]).tolist()
    normal = np.array([b * f - c * e, c * d - a * f, a * e - b * d])
    length = math.sqrt(normal @ normal)
    return normal / length if length > 0 else None


def _read(
    words: WordReader, find: Find, formulas: int, counts: tuple[str, ...]
) -> tuple[_Formulas, list[int]]:
    # Reads arguments in the order material, name, formulas, counts, options
    material, name = words.word("a material"), words.word("a name")
    nodes = tuple(
        parse_expression(words.word(f"formula {i + 1} of {formulas}"))
        for i in range(formulas)
    )
    steps = [words.whole(f"the {what}", 1, _MOST_STEPS) for what in counts]
    definitions: dict[str, Definition] = {}
    while words.left:
        match words.option():
            case "-e":
                definitions |= parse_definitions(words.word("a definition"))
            case "-f":
                path = find(words.word("a file"))
                definitions |= parse_definitions(read_text(path), file=str(path))
            case "-s":
                warnings.warn(
                    f'{words.program}: "{name}" remains faceted; -s is ignored',
                    ClerestoryWarning,
                    stacklevel=3,
                )
            case option:
                raise words.unknown(option)
    if np.prod(steps) > _MOST_STEPS:
        raise words.error(f"more than {_MOST_STEPS} cells; fewer expected")
    return _Formulas(material, name, Program(definitions), nodes), steps


def _finite(
    value: Float[np.ndarray, "n values"], words: WordReader
) -> Float[np.ndarray, "n values"]:
    if not np.all(np.isfinite(value)):
        raise words.error("a formula is undefined at a parameter between 0 and 1")
    return value
