"""Numerical differences between two BSDFs."""

from dataclasses import dataclass

import numpy as np

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.patch_symmetry import flux_table, mismatch
from clerestory.bsdf.scattering_function import Function
from clerestory.hemisphere.partition import RingPartition


@dataclass(frozen=True)
class Comparison:
    """Differences of one scattering function between two layers, second minus first."""

    # Root mean square difference of the BSDF [1/sr], weighted by the projected solid
    # angles of the exit and incident patches
    rms: float
    mean: float  # mean of the first BSDF [1/sr], weighted in the same way
    # Under a uniform sky, the fraction of the flux that the second layer scatters into
    # other patches; 0 for equal layers, 1 for disjoint distributions
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

    >>> from clerestory.bsdf.analytic import lambertian
    >>> from clerestory.hemisphere.klems import klems
    >>> result = compare(*(lambertian(t, klems("full")) for t in (0.4, 0.5)))
    >>> round(result.share_bias, 9), round(result.rms * np.pi, 9)
    (0.1, 0.1)
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
