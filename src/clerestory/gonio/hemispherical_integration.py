"""Integrals over scattered hemispheres that were measured at scattered points.

Over the disc below the hemisphere equal areas are equal projected solid angles. The
points are joined to triangles there, and each counts a third of the triangles about
it: the integral of the surface that is straight between neighbours. Gaps are bridged
by their edges; beyond the outermost points the nearest value goes on to the horizon.
"""

import functools

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import Delaunay, QhullError, cKDTree

from clerestory.array_types import Directions, Values

# Points on the horizon that carry the nearest measured value.
_RIM = 240

# Points alike to so many digits are one: all azimuths at the normal.
_DIGITS = 9

# Points this near to the horizon make further ones unnecessary.
_AT_RIM = 0.9995


def integration_weights(direction: Directions) -> Values:
    """Projected solid angle that each point stands for [sr]; the sum is π.

    >>> ring = 2 * np.pi * np.arange(12) / 12
    >>> points = np.stack([0.7 * np.cos(ring), 0.7 * np.sin(ring), 0 * ring + 0.714], 1)
    >>> round(float(integration_weights(points).sum()), 6)
    3.141593
    """
    # Instruments often scan the same pattern again, and its mesh takes long
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
    except QhullError:  # all on the rim
        return np.ones(count)
    corner = point[mesh.simplices]
    (ax, ay), (bx, by) = (
        (corner[:, 1] - corner[:, 0]).T,
        (corner[:, 2] - corner[:, 0]).T,
    )
    area = np.abs(ax * by - ay * bx) / 2
    share = np.bincount(mesh.simplices.ravel(), np.repeat(area / 3, 3), len(point))

    # Points that coincide with a corner, which Delaunay leaves out, share with it
    mates = np.ones(len(point))
    if len(mesh.coplanar):
        left, kept = mesh.coplanar[:, 0], mesh.coplanar[:, 2]
        np.add.at(mates, kept, 1)
        share[left] = share[kept] / mates[kept]
        share[kept] /= np.where(np.isin(np.arange(len(point)), kept), mates, 1)[kept]
    return np.bincount(owner, share, count)
