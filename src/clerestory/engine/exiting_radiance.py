"""Jobs for the light that flat patches send into a room, by direction."""

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.effort import Effort
from clerestory.engine.radiance_jobs import (
    PICTURE_BATCHES,
    Batches,
    RadianceEstimate,
    estimate_radiance,
    middle_unit,
)
from clerestory.engine.work_units import Unit
from clerestory.scene.model import Scene


@dataclass(frozen=True, eq=False)
class Patches:
    """Flat patches cut into triangles.

    Attributes
    ----------
    frame : of each patch; rows: two axes in it and its normal
    corner : of all triangles [m]
    first : of each patch, its first triangle; at the end the number of triangles
    cumulative : of each triangle, the share of its patch up to and with it
    """

    frame: Float[np.ndarray, "patch 3 3"]
    corner: Float[np.ndarray, "triangle 3 3"]
    first: Int[np.ndarray, " patches_and_end"]
    cumulative: Float[np.ndarray, " triangle"]


@dataclass(frozen=True, eq=False)
class ExitingRadianceJob:
    """Mean radiance that patches send within rings and sectors, patch by patch."""

    tracer: ClassVar[tuple[str, str]] = ("exiting_radiance_tracer", "prepare_outgoing")
    batches: ClassVar[int] = PICTURE_BATCHES

    scene: Scene
    patches: Patches
    rings: int
    sectors: int
    bounces: int | None
    seed: int
    device: Literal["cpu", "cuda"]

    @property
    def receivers(self) -> int:
        """Directions of all patches."""
        return len(self.patches.frame) * self.rings * self.sectors

    def pilot_unit(self, paths: int) -> Unit:
        """Return a unit of some directions."""
        return middle_unit(self.receivers, self.batches, paths)

    def error(self, values: Batches) -> float:
        """Return the error of the mean direction, relative."""
        mean, deviation = values.mean(), values.error()
        return float(np.sqrt(np.mean(deviation**2)) / max(mean.mean(), 1e-30))


def trace_exiting_radiance(
    scene: Scene, patches: Patches, rings: int, sectors: int, effort: Effort
) -> RadianceEstimate:
    """Return the radiance that patches send, but for suns seen straight through."""
    walk = effort.bounces, effort.seed, effort.resolved_device()
    return estimate_radiance(
        ExitingRadianceJob(scene, patches, rings, sectors, *walk), effort
    )
