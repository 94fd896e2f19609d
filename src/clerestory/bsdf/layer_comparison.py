"""Differences between two layers, and exchanges that explain them."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from clerestory.array_types import ExitIncident
from clerestory.brief_repr import brief
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.patch_symmetry import Turn, flux_table, mismatch, turned_patches
from clerestory.bsdf.scattering_function import OF_SIDE, Function
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.hemisphere.partition import RingPartition

# Smallest redistributed fraction of the flux for which exchanges are tried, largest
# part of it that an exchange may leave, and ratio up to which two are equally good.
_REDISTRIBUTED, _REMAINING, _EQUALLY = 0.03, 0.4, 1.1

_TURNED: dict[Turn, str] = {
    "half a turn": "turned by 180°",
    "left and right": "mirrored left to right",
    "up and down": "mirrored top to bottom",
}


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
    # Exchange in the second layer that explains most of the redistribution, such as
    # "the sides look swapped", and the rest of the redistribution; None if none does
    exchange: tuple[str, float] | None

    __repr__ = brief


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
    exchanged = dict(_exchanged(other, second, function, channel))
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
        exchange=_explanation(flux_table(first), second, exchanged),
    )


def _explanation(
    flux: ExitIncident, second: ScatteringMatrix, exchanged: dict[str, ScatteringMatrix]
) -> tuple[str, float] | None:
    # The first of the exchanges after which about the least flux is redistributed
    rest = {title: mismatch(flux, flux_table(p)) for title, p in exchanged.items()}
    before, least = mismatch(flux, flux_table(second)), min(rest.values(), default=1)
    if before < _REDISTRIBUTED or least > _REMAINING * before:
        return None
    return next((t, r) for t, r in rest.items() if r <= _EQUALLY * least)


def _exchanged(
    layer: Bsdf, part: ScatteringMatrix, function: Function, channel: str
) -> Iterator[tuple[str, ScatteringMatrix]]:
    # Function of a layer after each exchange of sides or directions, with a title
    if not part.exits.matches(part.incidents):
        return
    pairs = zip(*OF_SIDE.values(), strict=True)
    opposite = next(b if f == function else f for f, b in pairs if function in (f, b))
    if layer.has(opposite, channel=channel):
        other = layer.function(opposite, channel=channel, partition=part.exits)
        yield "the sides look swapped", other
    for turn, title in _TURNED.items():
        order = turned_patches(part.incidents, turn)
        values = part.values[np.ix_(order, order)]
        yield f"the layer looks {title}", replace(part, values=values)
        values = part.values[:, order]
        yield f"the incident azimuths look {title}", replace(part, values=values)
    values = part.values.T
    yield "incident and exit directions look swapped", replace(part, values=values)
