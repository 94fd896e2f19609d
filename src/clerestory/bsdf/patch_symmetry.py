"""Differences between scattering matrices, their mirror images and their reciprocals.

The mismatch of two matrices is the fraction of the flux under a uniform sky that the
matrices scatter into different patches: 0 for equal and 1 for disjoint distributions.
"""

from typing import Literal, get_args

import numpy as np
from jaxtyping import Float

from clerestory.array_types import ExitIncident, Indices
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.hemisphere.partition import RingPartition

Turn = Literal["half a turn", "left and right", "up and down", "a quarter turn"]
TURNS: tuple[Turn, ...] = get_args(Turn)

_SECTORS = 8
_RINGS_TOGETHER = 2


def mismatch(one: ExitIncident, other: ExitIncident) -> float:
    """Fraction of the flux that two flux tables scatter into different patches.

    >>> mismatch(np.array([[1.0, 1.0]]), np.array([[1.0, 1.2]])).__round__(6)
    0.047619
    """
    total = float(one.sum() + other.sum())
    return float(np.abs(one - other).sum()) / total if total > 0 else 0.0


def reciprocity_mismatch(front: ScatteringMatrix, back: ScatteringMatrix) -> float:
    """Mismatch between the front function and the reciprocal of the back function.

    Fluxes are summed over groups of patches, which averages out Monte Carlo noise. For
    a reflection, both arguments are the same function.
    """
    return mismatch(_flux_of_groups(front), _flux_of_groups(back.reciprocal()))


def reverse_ratios(
    front: ScatteringMatrix, back: ScatteringMatrix
) -> tuple[float, float]:
    """Range of the ratio of the reciprocal of the back function to the front function.

    The range holds 90 % of the flux: 5 % has smaller and 5 % larger ratios.
    """
    one, other = (
        _flux_of_groups(front).ravel(),
        _flux_of_groups(back.reciprocal()).ravel(),
    )
    some = one + other > 0
    one, other = one[some], other[some]
    ratio = np.divide(other, one, out=np.full(len(one), np.inf), where=one > 0)
    order = np.argsort(ratio)
    passed = np.cumsum((one + other)[order])
    least, most = np.searchsorted(passed, [0.05 * passed[-1], 0.95 * passed[-1]])
    return float(ratio[order[least]]), float(ratio[order[most]])


def turn_incident(part: ScatteringMatrix, turn: Turn) -> ScatteringMatrix:
    """Return the function with incident patches renumbered by a symmetry operation."""
    order = turned_patches(part.incidents, turn)
    return ScatteringMatrix(part.values[:, order], part.exits, part.incidents)


def turned_mismatch(part: ScatteringMatrix, turn: Turn) -> float:
    """Mismatch between a scattering function and the mirrored or rotated function."""
    exits, incidents = (turned_patches(p, turn) for p in (part.exits, part.incidents))
    flux = flux_table(part)
    return mismatch(flux, flux[np.ix_(exits, incidents)])


def turned_patches(partition: RingPartition, turn: Turn) -> Indices:
    """For each patch, index of the patch that contains the image of its centre."""
    x, y, z = partition.centres().T
    moved = {
        "half a turn": (-x, -y, z),
        "left and right": (-x, y, z),
        "up and down": (x, -y, z),
        "a quarter turn": (-y, x, z),
    }[turn]
    # If the image of a centre lies on a patch boundary, use the next patch
    return np.asarray(partition.find(np.stack(moved, axis=-1)))


def flux_table(part: ScatteringMatrix) -> ExitIncident:
    """Flux from incident to exit patches, per unit radiance of a uniform sky [sr]."""
    return np.asarray(
        part.exits.projected_solid_angles()[:, None] * part.flux_factors()
    )


def _flux_of_groups(part: ScatteringMatrix) -> Float[np.ndarray, "group group"]:
    exits, incidents = _groups(part.exits), _groups(part.incidents)
    return np.asarray(exits.T @ flux_table(part) @ incidents)


def _groups(partition: RingPartition) -> Float[np.ndarray, "patch group"]:
    # Membership of patches in groups: pole patch, and azimuth sectors of two rings
    x, y, _ = partition.centres().T
    sector = np.floor(np.arctan2(y, x) * _SECTORS / (2 * np.pi) + 0.5 + 1e-6)
    ring = np.repeat(np.arange(len(partition.count)), partition.count)
    band = (ring + _RINGS_TOGETHER - 1) // _RINGS_TOGETHER
    group = np.where(band == 0, 0, (band - 1) * _SECTORS + sector % _SECTORS + 1)
    return np.asarray(np.eye(int(group.max()) + 1)[group.astype(int)])
