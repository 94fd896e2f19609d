"""Radiance's genbox: plain, bevelled or rounded boxes.

The index of a corner has one bit for each axis: 0 at the origin, 1 at the opposite
face. With bevelled or rounded edges, three more bits mark the axes along which the
corner is moved inwards.
"""

import numpy as np
from jaxtyping import Float

from clerestory.formats.word_reader import WordReader
from clerestory.radiance.generators.scene_text import polygon, primitive

# Faces of the plain box and of the bevelled box; vertex order as in genbox
_FACES = ("1540", "4620", "2310", "3267", "5137", "6457")

# fmt: off
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


def box(words: WordReader) -> list[str]:
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

    corners = _Corners(size, cut, inward)
    if not cut:
        faces = [tuple(int(digit) for digit in face) for face in _FACES]
    else:
        faces = [*_INNER, *(() if rounded else _BEVELS)]
    made = [
        polygon(material, f"{name}.{_letters(face)}", corners.at(*face))
        for face in faces
    ]
    return made + (_rounded(material, name, corners) if rounded else [])


class _Corners:
    # Positions of the corners by index

    def __init__(self, size: Float[np.ndarray, "3"], cut: float, inward: bool) -> None:
        self.size, self.cut, self.inward = size, cut, inward

    def at(self, *numbers: int) -> Float[np.ndarray, "corners 3"]:
        bit = np.array([[n >> i & 1 for i in range(3)] for n in numbers], dtype=bool)
        drawn = np.array([[n >> i & 8 for i in range(3)] for n in numbers], dtype=bool)
        near = np.where(drawn, self.cut, 0.0)
        return np.where(bit != self.inward, self.size - near, near)


def _letters(numbers: tuple[int, ...]) -> str:
    return "".join(_LETTERS[n] for n in numbers)


def _rounded(material: str, name: str, corners: _Corners) -> list[str]:
    # Cylinders along the edges and spheres at the corners
    kinds = ("tube", "bubble") if corners.inward else ("cylinder", "sphere")
    made = []
    for one in (0o70, 0o73, 0o75, 0o76):  # no two of these share an edge
        for axis in (1, 4, 2):
            ends = (one, one ^ axis)
            reals = [*corners.at(*ends).ravel(), corners.cut]
            label = f"{name}.{_letters(ends)}"
            made.append(primitive(material, kinds[0], label, reals=reals))
    for one in range(0o70, 0o100):
        reals = [*corners.at(one).ravel(), corners.cut]
        label = f"{name}.{_letters((one,))}"
        made.append(primitive(material, kinds[1], label, reals=reals))
    return made
