"""Differences between scattering matrices, their mirror images and their reciprocals.

The mismatch of two matrices is the fraction of the flux under a uniform sky that the
matrices scatter into different patches: 0 for equal and 1 for disjoint distributions.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float

from clerestory.array_types import ExitIncident, Indices
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import Function
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
    reverse = back.reciprocal()
    return mismatch(_flux_of_groups(front), _flux_of_groups(reverse))


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


@dataclass(frozen=True)
class Comparison:
    """Differences of one scattering function between two layers, second minus first."""

    # Root mean square difference of the BSDF [1/sr], weighted by the projected solid
    # angles of the exit and incident patches
    rms: float
    mean: float  # mean BSDF [1/sr] of the first layer, weighted as in `rms`
    # Fraction of the flux under a uniform sky that the second layer scatters into other
    # patches than the first; 0 for equal layers, 1 for disjoint distributions
    redistributed: float
    # Mean, root mean square and largest difference of directional-hemispherical
    # transmittance or reflectance
    share_bias: float
    share_rms: float
    share_worst: float
    worst_patch: int  # index of the incident patch with the largest difference
    incidents: RingPartition  # partition of incident directions used for the comparison
    # Diffuse transmittance or reflectance of the first and the second layer
    diffuse: tuple[float, float]


def compare(
    one: Bsdf,
    other: Bsdf,
    *,
    function: Function = "transmission_front",
    channel: str = "visible",
) -> Comparison:
    """Return the differences of one scattering function between two layers.

    Layers with different partitions are compared on the coarser of the two incident
    partitions. Tensor trees are averaged over Klems full patches.
    """
    first, second = (bsdf.function(function, channel=channel) for bsdf in (one, other))
    if not (
        first.exits.matches(second.exits) and first.incidents.matches(second.incidents)
    ):
        common = min(first.incidents, second.incidents, key=len)
        first, second = (
            bsdf.function(function, channel=channel, partition=common)
            for bsdf in (one, other)
        )
    exits = first.exits.projected_solid_angles()
    incidents = first.incidents.projected_solid_angles()
    weight = exits[:, None] * incidents / (exits.sum() * incidents.sum())
    share = [part.direct_hemispherical() for part in (first, second)]
    difference = share[1] - share[0]
    even = incidents / incidents.sum()
    worst = int(np.argmax(np.abs(difference)))
    return Comparison(
        rms=float(np.sqrt(np.sum(weight * (second.values - first.values) ** 2))),
        mean=float(np.sum(weight * first.values)),
        redistributed=mismatch(flux_table(first), flux_table(second)),
        share_bias=float(difference @ even),
        share_rms=float(np.sqrt(difference**2 @ even)),
        share_worst=float(difference[worst]),
        worst_patch=worst,
        incidents=first.incidents,
        diffuse=(float(share[0] @ even), float(share[1] @ even)),
    )
