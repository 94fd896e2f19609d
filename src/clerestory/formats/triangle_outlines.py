"""Outlines of flat parts of triangle meshes, such as panes and floors.

Triangles of a plane, or of parallel planes that are close together, are projected onto
their mean plane; the union of the projections is returned as polygons.
"""

from collections.abc import Iterator
from importlib import import_module

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from clerestory.array_types import Vector
from clerestory.formats.building_model import seamed

Corners = Float[np.ndarray, "triangle 3 3"]

# Grid to which corners are rounded [m], and area below which a polygon is omitted [m²]
_ROUNDED, _SMALLEST = 1e-4, 1e-3

# Cosine of the angle between normals of one plane, either way
_SAME = np.cos(np.radians(5.0))


def area_normals(corners: Corners) -> Float[np.ndarray, "triangle 3"]:
    """Return the normals of triangles, with the areas [m²] as lengths."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray(np.cross(first, second) / 2)


def outlines(corners: Corners, *, gap: float) -> list[Float[np.ndarray, "_ 3"]]:
    """Return the outlines of triangles, plane by plane, joined with their holes.

    Parameters
    ----------
    corners : corners of each triangle; their orientation is ignored [m]
    gap : distance between parallel planes that are treated as one [m]

    Examples
    --------
    >>> import numpy as np
    >>> a, b, c, d = np.array([[0.0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]])
    >>> [outline] = outlines(np.array([[a, b, c], [a, c, d]]), gap=0.01)
    >>> len(outline)
    4
    """
    found: list[Float[np.ndarray, "_ 3"]] = []
    for normal, chosen in _planes(corners, gap):
        found += _union(corners[chosen], normal)
    return found


def lowest(corners: Corners, *, gap: float) -> Bool[np.ndarray, " triangle"]:
    """Return which triangles have no other one more than `gap` [m] below their centre.

    >>> low = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]])
    >>> lowest(np.stack([low, low + (0, 0, 3), low + (9, 0, 3)]), gap=0.01).tolist()
    [True, False, True]
    """
    centre, plan = corners.mean(axis=1), corners[:, :, :2]
    found = np.ones(len(corners), dtype=bool)
    for triangle, below in zip(plan, centre[:, 2] + gap, strict=True):
        ends = np.roll(triangle, -1, axis=0) - triangle
        away = centre[:, None, :2] - triangle
        side = ends[:, 0] * away[..., 1] - ends[:, 1] * away[..., 0]
        inside = np.all(side >= 0, axis=1) | np.all(side <= 0, axis=1)
        found &= ~(inside & (centre[:, 2] > below))
    return found


def connected_parts(
    faces: Int[np.ndarray, "triangle 3"], part: Int[np.ndarray, " triangle"]
) -> Int[np.ndarray, " triangle"]:
    """Return the number of the connected surface of each triangle.

    Triangles are connected if they share a vertex and belong to the same `part`.
    """
    _, place = np.unique(
        np.column_stack([faces.ravel(), np.repeat(part, 3)]),
        axis=0,
        return_inverse=True,
    )
    corner = place.reshape(-1, 3)
    ends = np.concatenate([corner[:, [0, 1]], corner[:, [1, 2]]])
    count = int(corner.max(initial=-1)) + 1
    graph = coo_array((np.ones(len(ends)), ends.T), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1][corner[:, 0]])


def extents(
    points: Float[np.ndarray, "point 3"], area: Float[np.ndarray, "triangle 3"]
) -> tuple[Vector, Vector]:
    """Return the normal of a slab and its thickness, height and width [m].

    The normal is the direction in which the areas of the triangles face on average.
    """
    length = np.linalg.norm(area, axis=1)
    weighted = area / np.sqrt(np.maximum(length, 1e-30))[:, None]
    normal = np.linalg.eigh(weighted.T @ weighted)[1][:, -1]
    flat = points @ _plane_axes(normal)
    turned = flat @ np.linalg.eigh(np.cov(flat.T))[1]
    sides = np.sort(np.ptp(turned, axis=0))
    return normal, np.array([np.ptp(points @ normal), *sides])


def _planes(corners: Corners, gap: float) -> Iterator[tuple[Vector, np.ndarray]]:
    # Normal and triangles of each plane, the largest triangles first
    area = area_normals(corners)
    size = np.linalg.norm(area, axis=1)
    left = size > _ROUNDED**2
    while left.any():
        largest = int(np.where(left, size, 0).argmax())
        normal = area[largest] / size[largest]
        along = left & (np.abs(area @ normal) > _SAME * size)
        offset = corners.mean(axis=1) @ normal
        order = np.flatnonzero(along)[np.argsort(offset[along])]
        runs = np.split(order, np.flatnonzero(np.diff(offset[order]) > gap) + 1)
        for run in runs:
            yield normal, run
        left &= ~along


def _union(corners: Corners, normal: Vector) -> Iterator[Float[np.ndarray, "_ 3"]]:
    # Polygons of the union of triangles in their mean plane
    shapely = import_module("shapely")  # of the extra "ifc"
    axes = _plane_axes(normal)
    weight = np.linalg.norm(area_normals(corners), axis=1)
    depth = np.average(corners.mean(axis=1) @ normal, weights=weight)
    flat = corners @ axes
    united = shapely.union_all(shapely.polygons(flat), grid_size=_ROUNDED)
    for polygon in shapely.get_parts(shapely.simplify(united, _ROUNDED)):
        if shapely.area(polygon) < _SMALLEST:
            continue
        rings = (polygon.exterior, *polygon.interiors)
        loops = [shapely.get_coordinates(ring)[:-1] for ring in rings]
        yield seamed([loop @ axes.T + depth * normal for loop in loops])


def _plane_axes(normal: Vector) -> Float[np.ndarray, "3 2"]:
    # Two unit vectors, as columns, that form a right-handed system with the normal
    first = np.cross(np.eye(3)[np.abs(normal).argmin()], normal)
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(normal, first)])
