"""Radiance's genbox: plain, bevelled or rounded boxes.

Corners are numbered by one bit per axis: 0 at the origin, 1 at the opposite face. With
bevelled or rounded edges, three more bits mark the axes along which the corner is moved
inwards.
"""

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vector
from clerestory.formats.word_reader import WordReader
from clerestory.scene.primitive import Primitive, primitive

# Faces of the plain box and of the bevelled box; vertex order as in genbox
# fmt: off
_FACES = (
    (1, 5, 4, 0), (4, 6, 2, 0), (2, 3, 1, 0), (3, 2, 6, 7), (5, 1, 3, 7), (6, 4, 5, 7),
)
_INNER = (
    (0o51, 0o55, 0o54, 0o50), (0o64, 0o66, 0o62, 0o60), (0o32, 0o33, 0o31, 0o30),
    (0o53, 0o52, 0o56, 0o57), (0o65, 0o61, 0o63, 0o67), (0o36, 0o34, 0o35, 0o37),
)
_BEVELS = (
    (0o31, 0o51, 0o50, 0o30), (0o60, 0o62, 0o32, 0o30), (0o50, 0o54, 0o64, 0o60),
    (0o34, 0o36, 0o66, 0o64), (0o37, 0o57, 0o56, 0o36), (0o52, 0o62, 0o66, 0o56),
    (0o52, 0o53, 0o33, 0o32), (0o57, 0o67, 0o63, 0o53), (0o61, 0o31, 0o33, 0o63),
    (0o65, 0o67, 0o37, 0o35), (0o55, 0o51, 0o61, 0o65), (0o34, 0o54, 0o55, 0o35),
    (0o30, 0o50, 0o60), (0o51, 0o31, 0o61), (0o32, 0o62, 0o52), (0o64, 0o54, 0o34),
    (0o36, 0o56, 0o66), (0o65, 0o35, 0o55), (0o53, 0o63, 0o33), (0o37, 0o67, 0o57),
)
# fmt: on
_LETTERS = "0123456789._ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"


def box(words: WordReader) -> list[Primitive]:
    """Return the primitives of `genbox mat name x y z [-i] [-b cut | -r round]`."""
    material, name = words.word("a material"), words.word("a name")
    size = np.array([words.positive(f"size along {axis}") for axis in "xyz"])
    cut, rounded, inward = 0.0, False, False
    while words.left:
        match words.option():
            case "-i":
                inward = not inward
            case "-b" | "-r" as option:
                cut, rounded = words.positive("size of the cut"), option == "-r"
            case option:
                raise words.unknown(option)
    if 2 * cut > size.min():
        raise words.error(
            f"a bevel of {cut:g} exceeds half of the smallest size, {size.min():g}"
        )

    if cut:
        shapes = [("polygon", f) for f in (*_INNER, *(() if rounded else _BEVELS))]
    else:
        shapes = [("polygon", face) for face in _FACES]
    if rounded:
        shapes += _rounded(inward=inward)
    position = _positions(size, cut, inward=inward)
    made = []
    for kind, corners in shapes:
        radius = () if kind == "polygon" else (cut,)
        label = f"{name}.{''.join(_LETTERS[n] for n in corners)}"
        reals = [*position[list(corners)].ravel(), *radius]
        made.append(primitive(material, kind, label, reals))
    return made


def _positions(size: Vector, cut: float, *, inward: bool) -> Float[np.ndarray, "64 3"]:
    # Positions of the 64 possible corners
    bits = np.arange(64)[:, None] >> np.arange(3)
    margin = np.where(bits & 8, cut, 0.0)
    return np.where((bits & 1 == 1) != inward, size - margin, margin)


def _rounded(*, inward: bool) -> list[tuple[str, tuple[int, ...]]]:
    # Cylinders along the edges and spheres at the corners
    edge, corner = ("tube", "bubble") if inward else ("cylinder", "sphere")
    ends = (0o70, 0o73, 0o75, 0o76)  # no two of these corners share an edge
    edges = [(edge, (one, one ^ axis)) for one in ends for axis in (1, 4, 2)]
    return [*edges, *((corner, (one,)) for one in range(0o70, 0o100))]
