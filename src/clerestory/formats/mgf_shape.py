"""MGF shapes as polygons and cones, before transforms are applied."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.formats.mgf_definitions import MgfVertex

# Segments per quarter circle of a torus, as in Radiance
_PARTS_OF_QUARTER = 5

# Smallest cosine between the face normal and the vertex normals of a flat face
_FLAT = 0.999995


class Frustum(NamedTuple):
    """The lateral surface of a truncated cone; negative radii: it faces inwards."""

    base: Float[np.ndarray, "3"]
    base_radius: float
    top: Float[np.ndarray, "3"]
    top_radius: float


def faces(corner: list[MgfVertex]) -> list[list[MgfVertex]]:
    """Return a face as one polygon or two triangles; none if its area is zero.

    Vertex normals at all three or four corners define the front side. A face of four
    corners with different normals becomes two triangles, which are flat, not smooth.
    """
    normals = [v.normal for v in corner if v.normal is not None]
    if len(corner) > 4 or len(normals) < len(corner):
        return [corner]
    a, b, c = (np.array(v.point) for v in corner[:3])
    across = np.cross(b - a, c - b)
    length = math.sqrt(across @ across)
    if length == 0:
        return []
    facing = np.array(normals[:3]) @ across / length
    bent = np.abs(facing).min() < _FLAT or not (
        np.all(facing > 0) or np.all(facing < 0)
    )
    pieces = [corner]
    if bent and len(corner) == 4:
        pieces = [corner[:3], [corner[2], corner[3], corner[0]]]
    return [p[::-1] for p in pieces] if np.all(facing < 0) else pieces


def joined_holes(names: list[str]) -> list[str]:
    """Join the vertices of an outline and its holes; a hyphen precedes each hole."""
    text = " ".join(names).removesuffix(" -")
    outside, *holes = (loop.split() for loop in f" {text} ".split(" - "))
    valid = all(len(loop) > 2 for loop in (outside, *holes))
    require(valid, "a face or a hole has fewer than 3 vertices; 3 or more expected")
    if not holes:
        return outside
    seams = [name for hole in holes for name in (hole[-1], *hole)]
    return [*outside, *seams, outside[-1]]


def prism(corner: list[MgfVertex], length: float) -> Iterator[list[MgfVertex]]:
    """Yield the faces of a prism: sides, far end and near end.

    For a positive length, the given corners are counter-clockwise as seen from outside,
    and the far end lies behind them.
    """
    point = np.array([v.point for v in corner])
    spoke = point - point[0]
    across = np.cross(spoke[1:-1], spoke[2:]).sum(axis=0)
    size = math.sqrt(across @ across)
    solid = size > 0 and length != 0
    require(solid, "the base area or length of a prism is 0; other values expected")
    moved = point - length * across / size
    far = [
        MgfVertex((float(x), float(y), float(z)), v.normal)
        for v, (x, y, z) in zip(corner, moved, strict=True)
    ]
    for k in range(len(corner)):
        yield [far[k], corner[k], corner[k - 1], far[k - 1]]
    yield [MgfVertex(v.point) for v in reversed(far)]
    yield [MgfVertex(v.point) for v in corner]


def torus(centre: MgfVertex, inner: float, outer: float) -> Iterator[Frustum]:
    """Yield cones that approximate a torus; negative radii make them face inwards."""
    if centre.normal is None:
        raise InputError("a torus centre has no normal; a vertex with normal expected")
    sign = -1.0 if inner < 0 or (inner == 0 and outer < 0) else 1.0
    grows = sign * (outer - inner) > 0
    require(grows, f"torus from {inner:g} to {outer:g}; increasing radii expected")
    axis, middle = np.array(centre.normal), np.array(centre.point)
    half, mean = (outer - inner) / 2, (outer + inner) / 2
    parts = 2 * _PARTS_OF_QUARTER
    angle = np.pi * np.arange(2 * parts + 1) / parts
    point = middle + sign * half * np.cos(angle)[:, None] * axis
    radius = mean + half * np.sin(angle)
    for k in range(2 * parts):
        # Cones of the inner half face the axis
        side = 1 if k < parts else -1
        yield Frustum(
            point[k], side * float(radius[k]), point[k + 1], side * float(radius[k + 1])
        )
