"""Extruded cross-sections of slats, prisms and channels."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from clerestory.array_types import Points2
from clerestory.directions import circular_arc
from clerestory.scene.model import Polygon

# Largest arc angle of a flat strip that approximates part of a curved slat [rad].
_STRIP = np.radians(3.0)


def arc(width: float, rise: float) -> Points2:
    """Points (along, above) of a slat profile from edge to edge, its middle at 0.

    `width` is the chord, `rise` the height of the middle above the chord.
    """
    if rise == 0:
        return np.array([[-width / 2, 0.0], [width / 2, 0.0]])
    radius = (width**2 / 4 + rise**2) / (2 * abs(rise))
    half = np.arctan2(width / 2, radius - abs(rise))
    strips = int(np.ceil(2 * half / _STRIP))
    return circular_arc(np.sign(rise) * radius, half, strips) - [0, rise]


def extruded(
    section: Points2,
    *,
    ends: tuple[float, float],
    material: str,
    name: str,
    closed: bool = False,
) -> Iterator[Polygon]:
    """Extrude a cross-section (y, z) along x to one strip per segment.

    The normal of a strip has positive y where the cross-section runs towards −z.

    `ends`: range of x [m]. `closed`: whether to connect the last point to the first.
    """
    points = [*section, section[0]] if closed else list(section)
    ring = ends[0], ends[1], ends[1], ends[0]
    for number, (a, b) in enumerate(pairwise(points)):
        corners = [(x, *point) for x, point in zip(ring, (a, a, b, b), strict=True)]
        yield Polygon(np.array(corners, dtype=float), material, f"{name}.{number}")


def rotated(polygons: Iterator[Polygon]) -> Iterator[Polygon]:
    """Rotate polygons about z by −90°, from up (+y) to right (+x)."""
    for polygon in polygons:
        x, y, z = polygon.vertices.T
        yield Polygon(np.stack([y, -x, z], axis=1), polygon.material, polygon.name)
