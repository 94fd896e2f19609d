"""Triangulation of polygons by the even–odd rule, as in Radiance.

In Radiance, holes are inner loops of either orientation, connected to the rim by seams.
Edges that occur an even number of times, such as seams, are removed. The remaining
edges form loops; a loop within an odd number of other loops is a hole.
"""

from dataclasses import dataclass

import mapbox_earcut
import numpy as np
from jaxtyping import Float, Int

from clerestory.array_types import Faces, Vector, Vertices, Vertices2
from clerestory.checks import require
from clerestory.scene.slab_decomposition import (
    MOST_PAIRS,
    crossings,
    require_few,
    slab_triangles,
)

# Distance below which two vertices coincide, relative to the size of the polygon
_WELD = 1e-9

# Largest number of edges; the time of triangulation grows with its square
_MOST_EDGES = 1 << 16

Loop = list[int]


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles with the orientation of the polygon that they fill."""

    vertices: Vertices
    faces: Faces

    def areas(self) -> Float[np.ndarray, " triangles"]:
        """Return the areas of the triangles [m²]."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        return np.asarray(np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2)


def triangulate(vertices: Vertices) -> Triangles:
    """Return triangles that fill a polygon by the even–odd rule.

    The polygon is planar except for rounding; the area vector points to the front. New
    vertices are added only if the contour intersects itself.
    """
    origin, frame = _plane(vertices)
    flat = (vertices - origin) @ frame.T
    points, size = flat[:, :2], float(np.abs(flat).max())

    # Loops of a contour without intersections are triangulated
    edges = _odd_edges(_weld(points, size))
    faces = _simple(points, edges)
    if faces is not None:
        return Triangles(vertices, _facing_up(points, faces, size))

    # A self-intersecting contour is decomposed into slabs
    corner = slab_triangles(points[edges])
    lifted = np.concatenate([corner, np.zeros((len(corner), 1))], axis=1)
    faces = np.arange(len(corner)).reshape(-1, 3)
    return Triangles(origin + lifted @ frame, _facing_up(corner, faces, size))


def simple_faces(vertices: Vertices) -> Faces | None:
    """Return triangles between a polygon's vertices; None if it intersects itself."""
    origin, frame = _plane(vertices)
    points = ((vertices - origin) @ frame.T)[:, :2]
    size = float(np.abs(points).max())
    faces = _simple(points, _odd_edges(_weld(points, size)))
    return None if faces is None else _facing_up(points, faces, size)


def _simple(points: Vertices2, edges: Int[np.ndarray, "edges 2"]) -> Faces | None:
    many = f"polygon of {len(edges):,} edges; at most {_MOST_EDGES:,} expected"
    require(len(edges) <= _MOST_EDGES, many)
    if len(edges) and not crossings(points[edges]).size:
        return _fill(points, _loops(edges))
    return None


def _plane(vertices: Vertices) -> tuple[Vector, Float[np.ndarray, "3 3"]]:
    # Mean of the vertices, and right-handed axes: two in the plane, and the normal
    origin = vertices.mean(axis=0)
    away = vertices - origin
    normal = np.cross(away, np.roll(away, -1, axis=0)).sum(axis=0)
    normal = normal / np.linalg.norm(normal)
    first = np.cross(np.eye(3)[np.argmin(np.abs(normal))], normal)
    first = first / np.linalg.norm(first)
    return origin, np.stack([first, np.cross(normal, first), normal])


def _weld(points: Vertices2, size: float) -> Int[np.ndarray, " vertices"]:
    # For each vertex, the index of the first vertex that coincides with it
    grid = np.round(points / (size * _WELD))
    _, first, same = np.unique(grid, axis=0, return_index=True, return_inverse=True)
    return first[same.ravel()]


def _odd_edges(vertex: Int[np.ndarray, " vertices"]) -> Int[np.ndarray, "edges 2"]:
    # Edges that occur an odd number of times, in either direction
    edges = np.sort(np.stack([vertex, np.roll(vertex, -1)], axis=1), axis=1)
    edges = edges[edges[:, 0] != edges[:, 1]]
    edges, count = np.unique(edges, axis=0, return_counts=True)
    return np.asarray(edges[count % 2 == 1])


def _loops(edges: Int[np.ndarray, "edges 2"]) -> list[Loop]:
    # Follows edges until a vertex repeats, which closes a loop; each vertex has an even
    # number of edges
    neighbours: dict[int, set[int]] = {}
    for a, b in edges.tolist():
        neighbours.setdefault(a, set()).add(b)
        neighbours.setdefault(b, set()).add(a)
    loops = []
    for start in list(neighbours):
        path, place = [start], {start: 0}
        while neighbours[path[-1]]:
            here = path[-1]
            there = neighbours[here].pop()
            neighbours[there].discard(here)
            if there in place:
                loops.append(path[place[there] :])
                for left in path[place[there] + 1 :]:
                    del place[left]
                path = path[: place[there] + 1]
            else:
                place[there] = len(path)
                path.append(there)
    return loops


def _fill(points: Vertices2, loops: list[Loop]) -> Faces | None:
    # Triangles between outer loops and their holes; None if their total area is wrong
    area = np.array([abs(_area(points[loop])) for loop in loops])
    inside = _containment(points, loops)
    depth = inside.sum(axis=1)
    faces = []
    for outer in np.flatnonzero(depth % 2 == 0):
        holes = np.flatnonzero(inside[:, outer] & (depth == depth[outer] + 1))
        ring = [loops[outer], *(loops[h] for h in holes)]
        index = np.concatenate(ring)
        ends = np.cumsum([len(r) for r in ring]).astype(np.uint32)
        flat = mapbox_earcut.triangulate_float64(
            np.ascontiguousarray(points[index]), ends
        )
        faces.append(index[flat.astype(np.int64)].reshape(-1, 3))
    filled = np.concatenate(faces)
    expected = float((area * (1 - 2 * (depth % 2))).sum())
    found = float(np.abs(_doubled_areas(points, filled)).sum() / 2)
    return filled if abs(found - expected) <= 1e-9 * float(area.sum()) else None


def _area(loop: Vertices2) -> float:
    x, y = (loop - loop[0]).T
    return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


def _containment(points: Vertices2, loops: list[Loop]) -> np.ndarray:
    # Entry [i, j]: whether loop i is inside loop j; loops touch at vertices only
    a = points[np.concatenate(loops)]
    b = points[np.concatenate([np.roll(loop, -1) for loop in loops])]
    owner = np.repeat(np.arange(len(loops)), [len(loop) for loop in loops])
    result = np.zeros((len(loops), len(loops)), dtype=bool)
    if len(loops) == 1:
        return result
    require_few(len(a), len(loops) * len(a), MOST_PAIRS, "tests of loops within loops")
    for i, loop in enumerate(loops):
        x, y = points[loop[:2]].mean(axis=0)
        spans = np.flatnonzero((a[:, 1] > y) != (b[:, 1] > y))
        p, q = a[spans], b[spans]
        at = p[:, 0] + (y - p[:, 1]) * (q[:, 0] - p[:, 0]) / (q[:, 1] - p[:, 1])
        crossed = np.bincount(owner[spans[at > x]], minlength=len(loops))
        result[i] = crossed % 2 == 1
        result[i, i] = False
    return result


def _doubled_areas(points: Vertices2, faces: Faces) -> Float[np.ndarray, " triangles"]:
    a, b, c = (points[faces[:, k]] for k in range(3))
    u, v = b - a, c - a
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])


def _facing_up(points: Vertices2, faces: Faces, size: float) -> Faces:
    # Orients triangles like the polygon, and omits triangles of zero area
    doubled = _doubled_areas(points, faces)
    turned = np.where((doubled < 0)[:, None], faces[:, ::-1], faces)
    return np.asarray(turned[np.abs(doubled) > 1e-14 * size**2])
