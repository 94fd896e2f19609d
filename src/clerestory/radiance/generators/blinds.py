"""Radiance's genblinds: venetian blinds with flat or curved slats.

Slats are parallel to y, from y = 0 to the width of the blind. Each slat is rotated
about its edge at x = 0.
"""

from itertools import pairwise

import numpy as np
from jaxtyping import Float

from clerestory.formats.word_reader import WordReader
from clerestory.scene.primitive import Primitive, primitive

# Maximum angle between adjacent flat strips of a curved slat [deg]
_STRIP_DEG = 3.0

_MOST_SLATS = 100_000


def blinds(words: WordReader) -> list[Primitive]:
    """Return the primitives of a blind.

    Syntax: `genblinds material name depth width height slats angle [-r|+r radius]`,
    with the angle in degrees. The front of a slat is its upper side; -r curves slats
    downwards, +r upwards.
    """
    material, name = words.word("a material"), words.word("a name")
    depth = words.positive("depth of the slats")
    width = words.positive("width of the slats")
    height = words.positive("height of the blind")
    count = words.whole("number of slats", 1, _MOST_SLATS)
    angle = np.radians(words.real("angle of the slats"))
    radius = 0.0
    while words.left:
        option = words.option()
        if radius or option not in ("-r", "+r"):
            raise words.unknown(option)
        radius = words.positive("radius of curvature") * (1 if option == "-r" else -1)
    if radius and depth > 2 * abs(radius):
        raise words.error(
            f"the slats have a depth of {depth:g} and a radius of {abs(radius):g};"
            " a depth of at most twice the radius expected"
        )

    return [
        primitive(
            material, "polygon", f"{name}.{slat}.{strip}", _strip(ends, width, lift)
        )
        for slat in range(1, count + 1)
        for lift in (height * (slat - 0.5) / count,)
        for strip, ends in enumerate(pairwise(_profile(depth, angle, radius)))
    ]


def _profile(
    depth: float, angle: float, radius: float
) -> Float[np.ndarray, "points 2"]:
    # Cross-section of a slat: points (x, z) from the edge at x = 0 to the other edge
    chord = np.array([np.cos(angle), np.sin(angle)])
    if radius == 0:
        return np.stack([np.zeros(2), depth * chord])
    # Circular arc over the chord; angles are measured from the middle of the arc
    half = np.arcsin(depth / (2 * abs(radius)))
    strips = int(2 * np.degrees(half) / _STRIP_DEG + 0.99999)
    turn = np.linspace(-half, half, strips + 1)
    along = abs(radius) * (np.sin(turn) + np.sin(half))
    sag = -np.sign(radius) * abs(radius) * (np.cos(turn) - np.cos(half))
    across = np.array([-chord[1], chord[0]])
    return np.asarray(np.outer(along, chord) + np.outer(sag, across))


def _strip(
    ends: tuple[np.ndarray, np.ndarray], width: float, lift: float
) -> Float[np.ndarray, "4 3"]:
    (x0, z0), (x1, z1) = ends
    corners = [(x0, 0, z0), (x0, width, z0), (x1, width, z1), (x1, 0, z1)]
    return np.asarray(np.array(corners) + np.array([0, 0, lift]))
