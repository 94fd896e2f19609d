"""Even–odd filling of self-intersecting polygons by slab decomposition.

Slabs are bounded by the x coordinates of all corners and intersections. Edges do not
intersect within a slab, so that the filled region is between its first and second,
third and fourth, … edge.
"""

from itertools import pairwise

import numpy as np
from jaxtyping import Float

# Maximum number of edge pairs that are intersected together
_BLOCK = 2_000_000


def crossings(
    segments: Float[np.ndarray, "edges 2 2"],
) -> Float[np.ndarray, " crossings"]:
    """Return the x coordinates of edge intersections other than common end points.

    Examples
    --------
    >>> cross = np.array([[[0.0, 0.0], [2.0, 2.0]], [[0.0, 2.0], [2.0, 0.0]]])
    >>> crossings(cross).tolist()
    [1.0]
    """
    step = max(1, _BLOCK // max(1, len(segments)))
    found = [
        _block_crossings(segments[start : start + step], segments)
        for start in range(0, len(segments), step)
    ]
    return np.unique(np.concatenate([np.empty(0), *found]))


def slab_triangles(
    segments: Float[np.ndarray, "edges 2 2"],
) -> Float[np.ndarray, "corners 2"]:
    """Return the corners, three per triangle, of the region enclosed by edges.

    Examples
    --------
    >>> corner = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    >>> slab_triangles(np.stack([corner, np.roll(corner, -1, axis=0)], axis=1)).shape
    (3, 2)
    """
    cuts = np.unique(np.concatenate([segments[:, :, 0].ravel(), crossings(segments)]))
    flip = segments[:, 0, 0] > segments[:, 1, 0]
    left = np.where(flip[:, None], segments[:, 1], segments[:, 0])
    right = np.where(flip[:, None], segments[:, 0], segments[:, 1])
    corners = [np.empty((0, 2))]
    for low, high in pairwise(cuts):
        spanning = (
            (left[:, 0] <= low) & (right[:, 0] >= high) & (left[:, 0] < right[:, 0])
        )
        a, b = left[spanning], right[spanning]
        slope = (b[:, 1] - a[:, 1]) / (b[:, 0] - a[:, 0])
        at_low, at_high = (a[:, 1] + (x - a[:, 0]) * slope for x in (low, high))
        order = np.argsort(at_low + at_high, kind="stable")
        for lower, upper in zip(order[0::2], order[1::2], strict=False):
            first, second = (low, at_low[lower]), (high, at_high[lower])
            third, fourth = (high, at_high[upper]), (low, at_low[upper])
            corners.append(np.array([first, second, third, first, third, fourth]))
    corner = np.concatenate(corners).reshape(-1, 3, 2)
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    doubled = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    size = np.ptp(segments.reshape(-1, 2), axis=0).max(initial=0)
    return np.asarray(corner[doubled > 1e-13 * size**2].reshape(-1, 2))


def _block_crossings(
    some: Float[np.ndarray, "some 2 2"], all_: Float[np.ndarray, "edges 2 2"]
) -> Float[np.ndarray, " crossings"]:
    # Side of each edge's line on which the end points of all other edges are
    a, b = some[:, None, 0], some[:, None, 1]
    c, d = all_[None, :, 0], all_[None, :, 1]
    size = np.ptp(all_.reshape(-1, 2), axis=0).max()
    tiny = 1e-12 * size**2
    c_side, d_side = _side(a, b, c), _side(a, b, d)
    a_side, b_side = _side(c, d, a), _side(c, d, b)

    # Edges that intersect, and end points within another edge
    across = (c_side * d_side < 0) & (a_side * b_side < 0)
    across &= np.minimum(abs(c_side), abs(d_side)) > tiny
    across &= np.minimum(abs(a_side), abs(b_side)) > tiny
    i, j = np.nonzero(across)
    share = c_side[i, j] / (c_side[i, j] - d_side[i, j])
    found = [all_[j, 0, 0] + share * (all_[j, 1, 0] - all_[j, 0, 0])]
    for end, side in ((0, c_side), (1, d_side)):
        i, j = np.nonzero(abs(side) <= tiny)
        along = some[i, 1] - some[i, 0]
        t = ((all_[j, end] - some[i, 0]) * along).sum(axis=1) / (along**2).sum(axis=1)
        within = (t > 1e-9) & (t < 1 - 1e-9)
        found.append(all_[j[within], end, 0])
    return np.concatenate(found)


def _side(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
    u, v = b - a, p - a
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
