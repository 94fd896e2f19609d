"""Interpolation between the centres of patches, in polar angle and azimuth.

Quantities that are known by incident patch, such as transmittances and absorptances,
are evaluated at the true direction of the sun. Between the outermost ring and grazing
incidence they decrease to zero, as surfaces reflect all light there.
"""

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions
from clerestory.hemisphere.partition import RingPartition


def patch_weights(
    partition: RingPartition, direction: Directions
) -> Float[np.ndarray, "patch direction"]:
    """Weights of the patches for linear interpolation at each direction.

    At the centre of a patch they are one for this patch. The weights of a direction sum
    to one up to the centre of the outermost ring; beyond it, their sum decreases to
    zero at grazing incidence.

    Parameters
    ----------
    direction : directions over (direction, 3), with positive z, in the frame of the
        partition

    >>> from clerestory.hemisphere.klems import klems
    >>> basis = klems("quarter")
    >>> bool(np.allclose(patch_weights(basis, basis.centres()), np.eye(41)))
    True
    """
    x, y, z = np.asarray(direction, dtype=float).T
    theta = np.arctan2(np.hypot(x, y), z)
    along, across = (y, x) if partition.azimuth == "compass" else (x, y)
    turn = np.arctan2(across, along) / (2 * np.pi)

    # Polar angle of each ring, the innermost first
    centres = partition.centres()[partition.first]
    rings = np.arctan2(np.hypot(centres[:, 0], centres[:, 1]), centres[:, 2])
    order = np.argsort(rings)
    rings = rings[order]
    inner = np.clip(np.searchsorted(rings, theta, side="right") - 1, 0, len(rings) - 2)
    outwards = np.clip((theta - rings[inner]) / np.diff(rings)[inner], 0, 1)

    # One up to the outermost ring, zero at grazing incidence
    kept = np.clip((np.pi / 2 - theta) / (np.pi / 2 - rings[-1]), 0, 1)

    weights, every = np.zeros((len(partition), len(theta))), np.arange(len(theta))
    for ring, share in ((inner, 1 - outwards), (inner + 1, outwards * kept)):
        count, first = partition.count[order[ring]], partition.first[order[ring]]
        place = turn * count
        left = np.floor(place).astype(int)
        for patch, part in ((left, 1 - (place - left)), (left + 1, place - left)):
            np.add.at(weights, (first + patch % count, every), share * part)
    return weights
