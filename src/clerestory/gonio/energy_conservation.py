"""Energy conservation of fitted layers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from clerestory.array_types import Values
from clerestory.bsdf.scattering_function import OF_SIDE, Function
from clerestory.gonio.fitted_measurement import Fitted
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.optimal_transport import Network


@dataclass(frozen=True, eq=False)
class Conserved:
    """Fitted functions, scaled so that transmittance plus reflectance is at most 1."""

    fits: tuple[Fitted, ...]  # scaled functions in the given order
    largest: float  # largest transmittance plus reflectance before the correction
    changed: int  # number of incident directions at which fluxes were scaled


def conserve_energy(fits: Sequence[Fitted]) -> Conserved:
    """Scale fluxes where transmittance plus reflectance exceeds 1.

    The scale factors of the visible channel are used for all channels.
    """
    visible = {
        fit.function: fit.interpolant for fit in fits if fit.channel == "visible"
    }
    largest, changed = 0.0, 0
    result = []
    for fit in fits:
        sums = _sums(fit, visible)
        largest = max(largest, float(sums.max()))
        factors = 1 / np.maximum(sums, 1)
        if fit.channel == "visible":
            changed += int(np.sum(factors < 1))
        network = _scaled(fit.interpolant.network, factors)
        interpolant = replace(fit.interpolant, network=network)
        result.append(replace(fit, interpolant=interpolant))
    return Conserved(tuple(result), largest, changed)


def _sums(fit: Fitted, visible: dict[Function, Interpolant]) -> Values:
    # Visible transmittance plus reflectance at each incident direction of the mesh
    vertices = fit.interpolant.network.mesh.vertices
    side = next(pair for pair in OF_SIDE.values() if fit.function in pair)
    known = [visible[name] for name in side if name in visible]
    shares = [interpolant.hemispherical(vertices) for interpolant in known]
    return np.asarray(np.sum([np.zeros(len(vertices)), *shares], axis=0))


def _scaled(network: Network, factors: Values) -> Network:
    lobes = tuple(
        replace(part, flux=part.flux * factor)
        for part, factor in zip(network.lobes, factors, strict=True)
    )
    plans = tuple(
        replace(
            plan,
            sent=plan.sent * factors[a],
            received=plan.received * factors[b],
            fading=plan.fading * factors[a],
            rising=plan.rising * factors[b],
        )
        for plan, (a, b) in zip(network.plans, network.mesh.edges, strict=True)
    )
    return replace(network, lobes=lobes, plans=plans)
