"""Matrices of a traced system on the patches of a partition."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.scattering import Function, ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdfgen.area import SampleArea
from clerestory.bsdfgen.bands import Weights, band_values, tristimulus
from clerestory.bsdfgen.effort import TraceEffort
from clerestory.hemisphere.partition import RingPartition
from clerestory.scene.model import Scene


@dataclass(frozen=True, eq=False)
class TracedMatrices:
    """Matrices of some sides.

    Attributes
    ----------
    functions : by band and function, with their standard errors
    paths : traced in all
    reached : whether the relative error aimed at was reached
    """

    functions: dict[tuple[str, Function], ScatteringFunction]
    paths: int
    reached: bool


def trace_matrices(
    engine: Any,
    scene: Scene,
    area: SampleArea,
    *,
    partition: RingPartition,
    backs: tuple[bool, ...],
    bands: Mapping[str, Weights],
    colour: bool,
    effort: TraceEffort,
) -> TracedMatrices:
    """Return matrices of transmission and reflection for light from some sides.

    Parameters
    ----------
    engine : module `engine.sample_area_matrix`
    backs : for each side, whether it is that of the room
    """
    traced = engine.trace_matrix(
        scene,
        area.slab(),
        partition,
        periodic=area.periodic,
        sides=backs,
        effort=effort,
    )
    count = len(partition)
    functions: dict[tuple[str, Function], ScatteringFunction] = {}
    for number, back in enumerate(backs):
        side = "back" if back else "front"
        incident = slice(number * count, (number + 1) * count)
        for kind, exits in (
            ("transmission", slice(0, count)),
            ("reflection", slice(count, 2 * count)),
        ):
            name: Any = f"{kind}_{side}"
            part = traced.values[:, incident, exits]
            spread = np.moveaxis(traced.components[:, :, incident, exits], 0, 1)
            for band, weights in bands.items():
                value, error = (band_values(of, weights) for of in (part, spread))
                functions[band, name] = _matrix(value, error, partition)
            if colour:
                xyz, errors = tristimulus(part), tristimulus(spread)
                for band, axis in (("cie-x", 0), ("cie-z", 2)):
                    matrix = _matrix(xyz[axis], errors[axis], partition)
                    functions[band, name] = matrix
    return TracedMatrices(functions, traced.paths, traced.reached)


def _matrix(
    share: Float[np.ndarray, "incident exit"],
    components: Float[np.ndarray, "component incident exit"],
    partition: RingPartition,
) -> ScatteringMatrix:
    # The share of light that leaves through a patch, over its projected solid angle
    measure = partition.projected_solid_angles()[:, None]
    error = np.sqrt(np.square(components.astype(float)).sum(axis=0)).T
    value = np.ascontiguousarray(share.T / measure)
    return ScatteringMatrix(value, partition, partition, error / measure)
