"""Cosine-weighted integration of scattered measurement points over the hemisphere.

Directions are projected onto the unit disc, where areas are projected solid angles, and
triangulated. The weight of a point is a third of the area of its triangles, which
integrates the piecewise linear interpolation exactly. Between the outermost points and
the horizon, the value of the nearest point is used.
"""

import functools

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import Delaunay, QhullError, cKDTree

from clerestory.array_types import Directions, Values

# Number of points added on the horizon, each with the value of the nearest point.
_RIM = 240

# Points count as equal if they agree to this number of decimal places (at the normal
# all azimuths are one point).
_DIGITS = 9

# Points at larger radii on the unit disc count as on the horizon.
_AT_RIM = 0.9995


def integration_weights(direction: Directions) -> Values:
    """Projected solid angle of each point [sr]; the sum is π.

    >>> ring = 2 * np.pi * np.arange(12) / 12
    >>> points = np.stack([0.7 * np.cos(ring), 0.7 * np.sin(ring), 0 * ring + 0.714], 1)
    >>> round(float(integration_weights(points).sum()), 6)
    3.141593
    """
    # Cached: many instruments measure the same directions in every scan
    return _weights_of(np.ascontiguousarray(direction[:, :2]).tobytes())


@functools.lru_cache(maxsize=4)
def _weights_of(pattern: bytes) -> Values:
    every = np.round(np.frombuffer(pattern).reshape(-1, 2), _DIGITS)
    disc, place, count = np.unique(
        every, axis=0, return_inverse=True, return_counts=True
    )
    angle = 2 * np.pi * (np.arange(_RIM) + 0.5) / _RIM
    rim = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    _, nearest = cKDTree(disc).query(rim)
    inside = np.hypot(*disc.T) < _AT_RIM
    joined = np.concatenate([disc, rim])
    owner = np.concatenate([np.arange(len(disc)), nearest])
    weight = _thirds(joined, owner, len(disc))
    if not np.any(inside):
        weight = count.astype(float)
    weight = (weight / count)[place.ravel()] * (np.pi / weight.sum())
    weight.setflags(write=False)
    return np.asarray(weight)


def _thirds(
    point: Float[np.ndarray, "points 2"], owner: Int[np.ndarray, " points"], count: int
) -> Float[np.ndarray, " owners"]:
    try:
        mesh = Delaunay(point)
    except QhullError:  # all points are on one line
        return np.ones(count)
    corner = point[mesh.simplices]
    (ax, ay), (bx, by) = (
        (corner[:, 1] - corner[:, 0]).T,
        (corner[:, 2] - corner[:, 0]).T,
    )
    area = np.abs(ax * by - ay * bx) / 2
    share = np.bincount(mesh.simplices.ravel(), np.repeat(area / 3, 3), len(point))

    # Distribute the weight of a corner equally among coinciding points
    mates = np.ones(len(point))
    if len(mesh.coplanar):
        left, kept = mesh.coplanar[:, 0], mesh.coplanar[:, 2]
        np.add.at(mates, kept, 1)
        share[left] = share[kept] / mates[kept]
        share[kept] /= np.where(np.isin(np.arange(len(point)), kept), mates, 1)[kept]
    return np.bincount(owner, share, count)
