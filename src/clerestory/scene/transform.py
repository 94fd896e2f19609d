"""Similarity transforms and the options of Radiance's xform.

Points are row vectors, as in Radiance: p' = p @ matrix.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float

from clerestory.array_types import Directions
from clerestory.checks import require
from clerestory.errors import InputError

_AXES = "xyz"

# Maximum coordinate [m] and maximum scale factor; larger values overflow when squared
LARGEST = 1e15

_TOO_LARGE = (
    f"the xform options scale or move by more than {LARGEST:.0e}, or scale by less than"
    f" {1 / LARGEST:.0e}; other values expected"
)


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
        large = np.abs(both.matrix).max() <= LARGEST and both.scale >= 1 / LARGEST
        require(large, _TOO_LARGE)
        return both


@dataclass(frozen=True, eq=False)
class Transforms:
    """Similarity transforms of the copies of an array, as in `Transform`."""

    matrix: Float[np.ndarray, "copies 4 4"]
    scale: Float[np.ndarray, " copies"]
    mirrored: Bool[np.ndarray, " copies"]

    def __post_init__(self) -> None:
        large = np.abs(self.matrix).max() <= LARGEST
        require(large and self.scale.min() >= 1 / LARGEST, _TOO_LARGE)

    def __len__(self) -> int:
        return len(self.scale)

    def __getitem__(self, copy: int) -> Transform:
        mirrored = bool(self.mirrored[copy])
        return Transform(self.matrix[copy], float(self.scale[copy]), mirrored)

    def then(self, outer: "Transforms", *, slow: bool = True) -> "Transforms":
        """Return each transform followed by each of `outer`.

        The index of `outer` varies slowest if `slow`, and fastest otherwise.
        """
        axes = (1, 0) if slow else (0, 1)
        with np.errstate(over="ignore", invalid="ignore"):
            matrix = self.matrix[:, None] @ outer.matrix
            scale = np.multiply.outer(self.scale, outer.scale)
            mirrored = np.not_equal.outer(self.mirrored, outer.mirrored)
        return Transforms(
            matrix.transpose(*axes, 2, 3).reshape(-1, 4, 4),
            scale.transpose(axes).ravel(),
            mirrored.transpose(axes).ravel(),
        )


def single(transform: Transform) -> Transforms:
    """Return one transform as an array of one copy."""
    scale, mirrored = np.array([transform.scale]), np.array([transform.mirrored])
    return Transforms(transform.matrix[None], scale, mirrored)


def parse_array(words: list[str]) -> tuple[Transforms, list[int], int]:
    """Parse the xform options at the start of a list of words, including arrays.

    Return the transform of each copy, the count of each array, and the number of words
    parsed. The options are those of `parse_transform` and `-a count`, which makes
    copies 0 to count-1 by repeating the options up to the next `-i` or `-a`. The index
    of the first array varies slowest.
    """
    if "-a" not in words:
        transform, at = parse_transform(words)
        return single(transform), [], at
    runs, at = _runs(words, ("-i", "-a"))
    total = single(Transform())
    for option, count, part in runs:
        array = option == "-a"
        powers = _powers(part, count) if array else single(_repeat(part, count))
        total = total.then(powers, slow=False)
    return total, [count for option, count, _ in runs if option == "-a"], at


def parse_transform(words: list[str]) -> tuple[Transform, int]:
    """Parse the xform options at the start of a list of words.

    Return the transform and the number of words parsed. Options: -t x y z, -rx -ry -rz
    degrees, -s factor, -mx -my -mz, and -i count, which repeats the options up to the
    next -i. Any other word ends the transform.
    """
    runs, at = _runs(words, ("-i",))
    total = Transform()
    for _, count, part in runs:
        total = total.then(_repeat(part, count))
    return total, at


_ARGUMENTS = (
    {"-t": 3, "-s": 1} | {f"-r{a}": 1 for a in _AXES} | {f"-m{a}": 0 for a in _AXES}
)


def _runs(
    words: list[str], repeating: tuple[str, ...]
) -> tuple[list[tuple[str, int, Transform]], int]:
    # Transforms with the option and count that repeat them; number of words taken
    runs = [("-i", 1, Transform())]
    at = 0
    while at < len(words) and words[at].startswith("-"):
        option = words[at]
        if option in repeating:
            count = array_count(words, at) if option == "-a" else _whole(words, at)
            runs.append((option, count, Transform()))
            taken = 1
        else:
            taken = _ARGUMENTS.get(option, -1)
            if taken < 0:
                break
            before, count, part = runs[-1]
            step = _step(option, _numbers(words, at, taken))
            runs[-1] = before, count, part.then(step)
        at += 1 + taken
    return runs, at


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


def _powers(part: Transform, count: int) -> Transforms:
    # Powers 0 to count-1 of a transform, by repeated doubling
    with np.errstate(over="ignore", invalid="ignore"):
        matrix, step = np.eye(4)[None], part.matrix
        while len(matrix) < count:
            matrix, step = np.concatenate([matrix, matrix @ step]), step @ step
        scale = part.scale ** np.arange(count)
    odd = np.arange(count) % 2 == 1
    return Transforms(matrix[:count], scale, odd & part.mirrored)


def array_count(words: list[str], at: int) -> int:
    """Return the count of the array option `-a`, which is the word `at`."""
    count = "".join(words[at + 1 : at + 2])
    require(
        count.isascii() and count.isdecimal() and len(count) < 12 and int(count) > 0,
        f'xform -a is followed by "{count}"; a count above 0 expected',
    )
    return int(count)


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
    require(given.lstrip("+-").isdecimal() and len(given) < 12, unclear)
    return int(given)


def number(word: str) -> float | None:
    """Return the finite number that a word represents; None for any other word."""
    try:
        value = float(word)
    except ValueError:
        return None
    return value if math.isfinite(value) and "_" not in word else None
