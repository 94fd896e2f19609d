"""Triangulation of polygons by the even–odd rule, as in Radiance.

In Radiance, holes are inner loops of either orientation, connected to the rim by seams.
Edges that occur an even number of times, such as seams, are removed. The remaining
edges form loops; a loop within an odd number of other loops is a hole.

Self-intersecting contours are decomposed into slabs, which are bounded by the x
coordinates of all corners and intersections. Edges do not intersect inside a slab. The
filled region in a slab is between the first and second edge, third and fourth, ….
"""

from dataclasses import dataclass

import mapbox_earcut
import numpy as np
from jaxtyping import Float, Int

from clerestory.array_types import Faces, Vector, Vertices, Vertices2
from clerestory.checks import require

# Distance below which two vertices coincide, relative to the size of the polygon
_WELD = 1e-9

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
    tests = len(loops) * len(a)
    _require_few(len(a), tests, _MOST_PAIRS, "tests of loops within loops")
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


# Largest numbers of pairs of edges in one array operation and of all pairs, and largest
# number of parts of edges between crossings
_BLOCK, _MOST_PAIRS, _MOST_PARTS = 500_000, 100_000_000, 1_000_000


def crossings(
    segments: Float[np.ndarray, "edges 2 2"],
) -> Float[np.ndarray, " crossings"]:
    """Return the x coordinates of edge intersections other than common end points."""
    if not len(segments):
        return np.empty(0)
    size = float(np.ptp(segments.reshape(-1, 2), axis=0).max())
    low, high = segments.min(axis=1) - 1e-6 * size, segments.max(axis=1) + 1e-6 * size

    # Compare each edge with the following edges that begin before its end
    axis = int(np.argmin(_overlaps(low, high)))
    order = np.argsort(low[:, axis], kind="stable")
    low, high, segments = low[order], high[order], segments[order]
    ends = np.searchsorted(low[:, axis], high[:, axis], side="right")
    count = ends - np.arange(len(ends)) - 1
    _require_few(len(segments), int(count.sum()), _MOST_PAIRS, "pairs of edges overlap")
    total = np.cumsum(count)
    found = [np.empty(0)]
    start = 0
    while start < len(count):
        done = total[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(total, done + _BLOCK)))
        one = np.repeat(np.arange(start, stop), count[start:stop])
        before = np.repeat(
            total[start:stop] - count[start:stop] - done, count[start:stop]
        )
        other = one + 1 + np.arange(len(one)) - before
        beside = 1 - axis
        near = low[other, beside] <= high[one, beside]
        near &= low[one, beside] <= high[other, beside]
        found += _pair_crossings(segments[one[near]], segments[other[near]], size)
        start = stop
    return np.unique(np.concatenate(found))


def _overlaps(low: Vertices2, high: Vertices2) -> list[int]:
    # Number of pairs whose extents overlap, for each axis
    return [
        int(np.searchsorted(np.sort(low[:, k]), high[:, k], side="right").sum())
        for k in (0, 1)
    ]


def _require_few(edges: int, found: int, most: int, what: str) -> None:
    message = (
        f"polygon of {edges:,} edges: {found:.2g} {what}; at most {most:,} expected"
    )
    require(found <= most, message)


def slab_triangles(
    segments: Float[np.ndarray, "edges 2 2"],
) -> Float[np.ndarray, "corners 2"]:
    """Return triangles, three corners each, that fill the region enclosed by edges."""
    cuts = np.unique(np.concatenate([segments[:, :, 0].ravel(), crossings(segments)]))
    flip = segments[:, 0, 0] > segments[:, 1, 0]
    left = np.where(flip[:, None], segments[:, 1], segments[:, 0])
    right = np.where(flip[:, None], segments[:, 0], segments[:, 1])

    # Divide the edges at all cuts, and order the parts within each slab
    first, last = (np.searchsorted(cuts, end[:, 0]) for end in (left, right))
    count = last - first
    _require_few(
        len(segments), int(count.sum()), _MOST_PARTS, "parts between crossings"
    )
    edge = np.repeat(np.arange(len(count)), count)
    slab = np.arange(len(edge)) - np.repeat(np.cumsum(count) - count - first, count)
    low, high = cuts[slab], cuts[slab + 1]
    a, b = left[edge], right[edge]
    slope = (b[:, 1] - a[:, 1]) / (b[:, 0] - a[:, 0])
    at_low, at_high = (a[:, 1] + (x - a[:, 0]) * slope for x in (low, high))
    order = np.lexsort((at_low + at_high, slab))

    # Fill between the first and second part, third and fourth, … of each slab
    rank = np.arange(len(order)) - np.searchsorted(slab[order], slab[order])
    lower = order[:-1][(rank[:-1] % 2 == 0) & (rank[1:] % 2 == 1)]
    upper = order[1:][(rank[:-1] % 2 == 0) & (rank[1:] % 2 == 1)]
    one, two = (low[lower], at_low[lower]), (high[lower], at_high[lower])
    three, four = (high[upper], at_high[upper]), (low[upper], at_low[upper])
    corner = np.array([one, two, three, one, three, four]).transpose(2, 0, 1)
    corner = corner.reshape(-1, 3, 2)
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    doubled = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    size = np.ptp(segments.reshape(-1, 2), axis=0).max() if len(segments) else 0.0
    return np.asarray(corner[doubled > 1e-13 * size**2].reshape(-1, 2))


def _pair_crossings(
    one: Float[np.ndarray, "pairs 2 2"],
    other: Float[np.ndarray, "pairs 2 2"],
    size: float,
) -> list[Float[np.ndarray, " _"]]:
    # For each edge of a pair, the side of its line on which the other's ends lie
    (a, b), (c, d) = one.transpose(1, 0, 2), other.transpose(1, 0, 2)
    tiny = 1e-12 * size**2
    c_side, d_side = _side(a, b, c), _side(a, b, d)
    a_side, b_side = _side(c, d, a), _side(c, d, b)

    # x coordinates of edge crossings, and of end points in the interior of other edges
    across = (c_side * d_side < 0) & (a_side * b_side < 0)
    across &= np.minimum(abs(c_side), abs(d_side)) > tiny
    across &= np.minimum(abs(a_side), abs(b_side)) > tiny
    share = c_side[across] / (c_side[across] - d_side[across])
    found = [c[across, 0] + share * (d[across, 0] - c[across, 0])]
    ends = ((c, c_side, a, b), (d, d_side, a, b), (a, a_side, c, d), (b, b_side, c, d))
    for end, side, start, stop in ends:
        on = abs(side) <= tiny
        along = stop[on] - start[on]
        t = ((end[on] - start[on]) * along).sum(axis=1) / (along**2).sum(axis=1)
        found.append(end[on, 0][(t > 1e-9) & (t < 1 - 1e-9)])
    return found


def _side(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
    u, v = b - a, p - a
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
