"""Similarity transforms and the options of Radiance's xform.

Points are row vectors, as in Radiance: p' = p @ matrix.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions
from clerestory.checks import require
from clerestory.errors import InputError

_AXES = "xyz"

# Maximum coordinate [m] and maximum scale factor; larger values overflow when squared
LARGEST = 1e15


@dataclass(frozen=True, eq=False)
class Transform:
    """A similarity transform: rotation, uniform scaling, reflection and translation.

    The matrix multiplies row vectors (x, y, z, 1) from the right. The scale factor is
    positive; `mirrored` tells whether the transform reverses handedness.
    """

    matrix: Float[np.ndarray, "4 4"] = field(default_factory=lambda: np.eye(4))
    scale: float = 1.0
    mirrored: bool = False

    def points(self, points: Directions) -> Directions:
        """Return the points transformed."""
        return np.asarray(points @ self.matrix[:3, :3] + self.matrix[3, :3])

    def vectors(self, vectors: Directions) -> Directions:
        """Return the vectors rotated, reflected and scaled, but not translated."""
        return np.asarray(vectors @ self.matrix[:3, :3])

    def then(self, outer: "Transform") -> "Transform":
        """Return the transform followed by a second one."""
        both = Transform(
            self.matrix @ outer.matrix,
            self.scale * outer.scale,
            self.mirrored != outer.mirrored,
        )
        require(
            np.abs(both.matrix).max() <= LARGEST and both.scale >= 1 / LARGEST,
            f"the xform options scale or move by more than {LARGEST:.0e}, or scale by"
            f" less than {1 / LARGEST:.0e}; other values expected",
        )
        return both


def parse_transform(words: list[str]) -> tuple[Transform, int]:
    """Return the transform that the first words give, and the number of these words.

    Options: -t x y z, -rx -ry -rz degrees, -s factor, -mx -my -mz, and -i count, which
    repeats the options up to the next -i. Any other word ends the transform.
    """
    total, part, count = Transform(), Transform(), 1
    at = 0
    while at < len(words) and words[at].startswith("-"):
        option = words[at]
        if option == "-i":
            total = total.then(_repeat(part, count))
            part, count, taken = Transform(), _whole(words, at), 1
        else:
            taken = _ARGUMENTS.get(option, -1)
            if taken < 0:
                break
            part = part.then(_step(option, _numbers(words, at, taken)))
        at += 1 + taken
    return total.then(_repeat(part, count)), at


_ARGUMENTS = (
    {"-t": 3, "-s": 1} | {f"-r{a}": 1 for a in _AXES} | {f"-m{a}": 0 for a in _AXES}
)


def _step(option: str, value: list[float]) -> Transform:
    matrix = np.eye(4)
    match option[1]:
        case "t":
            matrix[3, :3] = value
            return Transform(matrix)
        case "s":
            require(value[0], "xform -s is 0; a factor other than 0 expected")
            matrix[:3, :3] *= value[0]
            return Transform(matrix, abs(value[0]), value[0] < 0)
        case "m":
            axis = _AXES.index(option[2])
            matrix[axis, axis] = -1
            return Transform(matrix, mirrored=True)
        case _:
            # Rotates y towards z (-rx), z towards x (-ry) or x towards y (-rz)
            axis = _AXES.index(option[2])
            one, two = (axis + 1) % 3, (axis + 2) % 3
            angle = math.radians(value[0])
            matrix[one, one] = matrix[two, two] = math.cos(angle)
            matrix[one, two] = math.sin(angle)
            matrix[two, one] = -math.sin(angle)
            return Transform(matrix)


def _repeat(part: Transform, count: int) -> Transform:
    # Transform applied `count` times, by repeated squaring
    if count == 1:
        return part
    result = Transform()
    while count > 0:
        result = result.then(part) if count % 2 else result
        count //= 2
        part = part.then(part) if count else part
    return result


def _numbers(words: list[str], at: int, count: int) -> list[float]:
    given = words[at + 1 : at + 1 + count]
    values = [number(word) for word in given]
    if len(values) < count or None in values:
        noun = "1 number" if count == 1 else f"{count} numbers"
        raise InputError(
            f'xform {words[at]} is followed by "{" ".join(given)}"; {noun} expected'
        )
    return [v for v in values if v is not None]


def _whole(words: list[str], at: int) -> int:
    given = "".join(words[at + 1 : at + 2])
    unclear = f'xform {words[at]} is followed by "{given}"; a count expected'
    require(given.lstrip("+-").isdecimal(), unclear)
    return int(given)


def number(word: str) -> float | None:
    """Return the finite number that a word represents; None for any other word."""
    try:
        value = float(word)
    except ValueError:
        return None
    return value if math.isfinite(value) and "_" not in word else None
