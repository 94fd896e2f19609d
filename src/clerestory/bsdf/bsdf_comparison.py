"""Numerical differences between two BSDFs."""

from dataclasses import dataclass

import numpy as np

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.patch_symmetry import flux_table, mismatch
from clerestory.bsdf.scattering_function import Function
from clerestory.hemisphere.partition import RingPartition


@dataclass(frozen=True)
class Comparison:
    """Differences of one function of two layers, second minus first.

    Attributes
    ----------
    rms : root mean square difference of the BSDF, weighted by solid angle [1/sr]
    mean : mean of the first BSDF with the same weights [1/sr]
    redistributed : fraction of the light of a uniform sky that is scattered into other
        directions; 0 for equal layers, 1 for disjoint ones
    share_bias, share_rms, share_worst : differences of directional-hemispherical values
    worst_patch : incident patch of the largest difference
    incidents : incident partition of the comparison
    diffuse : diffuse transmittance or reflectance of each
    """

    rms: float
    mean: float
    redistributed: float
    share_bias: float
    share_rms: float
    share_worst: float
    worst_patch: int
    incidents: RingPartition
    diffuse: tuple[float, float]


def compare(
    one: Bsdf,
    other: Bsdf,
    *,
    function: Function = "transmission_front",
    channel: str = "visible",
) -> Comparison:
    """Return the differences between one function of two layers.

    Layers are compared on their own patches if these are equal, otherwise on the
    coarser incident partition of the two. Trees are averaged to Klems full.

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
