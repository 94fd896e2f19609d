"""Decomposition of self-intersecting polygons into slabs, by the even–odd rule.

Slabs are bounded by the x coordinates of all corners and intersections. Edges do not
intersect inside a slab. The filled region in a slab is between the first and second
edge, third and fourth, ….
"""

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vertices2
from clerestory.checks import require

# Largest number of pairs of edges that are compared
MOST_PAIRS = 100_000_000

# Largest number of pairs of edges in one array operation, and of parts of edges
# between crossings
_BLOCK, _MOST_PARTS = 500_000, 1_000_000


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
    require_few(len(segments), int(count.sum()), MOST_PAIRS, "pairs of edges overlap")
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


def require_few(edges: int, found: int, most: int, what: str) -> None:
    """Raise an error if the number of `what` of a polygon is larger than `most`."""
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
    require_few(len(segments), int(count.sum()), _MOST_PARTS, "parts between crossings")
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
