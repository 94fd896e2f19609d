"""BSDF matrices of a sample area: shares of light from patch to patch."""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.channels import channels_of
from clerestory.engine.controller import (
    Estimate,
    MatrixJob,
    Sums,
    all_or_none,
    estimate,
    variance,
)
from clerestory.engine.device import in_use
from clerestory.engine.effort import Effort
from clerestory.engine.matrix_tracers import matrix_tracer
from clerestory.engine.patches import PatchTable
from clerestory.engine.path_tracer import segments_of
from clerestory.engine.primary_rays import Lanes
from clerestory.engine.sample_area import follow, lower_slab, start
from clerestory.engine.sampler import PathNumbers
from clerestory.engine.sinks import MatrixSink
from clerestory.engine.sums import BATCHES
from clerestory.engine.upload import on_device
from clerestory.engine.work_units import Tracer, Unit
from clerestory.hemisphere.partition import RingPartition
from clerestory.scene.model import Scene

__all__ = ["trace_matrix"]

# Keeps the sample points apart from those of other matrices made with the same seed.
_SALT = 0x5BD1E995


@dataclass
class Patches:
    """Scores light by the patch through which it leaves.

    Attributes
    ----------
    sink : sums of transmission, then of reflection
    table, count : patches of either
    back : of each path, whether it came from the room
    """

    sink: MatrixSink
    table: PatchTable
    count: int
    back: mi.Bool

    def receive(self, paths: Lanes, direction, weight, active) -> None:
        """Add light to the patch of a direction of travel."""
        column = self.table.find(direction)
        reflected = (direction.z > 0) == self.back
        column += dr.select(reflected, mi.UInt32(self.count), 0)
        self.sink.score(paths.slot, column, weight, active)


@dataclass(frozen=True, eq=False)
class SlabJob(MatrixJob):
    """From the incident patches of a sample area to the patches both ways out."""

    tracer: ClassVar[tuple[str, str]] = ("sample_area_matrix", "prepare_slab")
    together: ClassVar[bool] = True

    scene: Scene
    box: Float[np.ndarray, "2 3"]
    partition: RingPartition
    periodic: bool
    sides: tuple[bool, ...]
    bounces: int | None
    seed: int
    batches: int
    device: Literal["cpu", "cuda"]
    incidents: Int[np.ndarray, " incident"]
    stands_for: Int[np.ndarray, " incident"]

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Rows, batches, columns and channels."""
        rows = len(self.sides) * len(self.incidents)
        return rows, self.batches, 2 * len(self.partition), channels_of(self.scene)

    def unfinished(self, sums: Sums, aim: float) -> tuple[np.ndarray, float]:
        """Judge the BSDF of all pairs of patches."""
        alike = self.stands_for / self.stands_for.mean()
        weight = np.tile(alike, len(self.sides))[:, None, None]
        measure = np.tile(self.partition.projected_solid_angles(), 2)
        values = sums.means() / measure[:, None]
        error = float(np.sqrt(np.mean(weight * variance(values, axis=1))))
        mean = float(np.mean(weight[..., None] * values))
        return all_or_none(sums, error, mean, aim)


def trace_matrix(
    scene: Scene,
    box: Float[np.ndarray, "2 3"],
    partition: RingPartition,
    incidents: Int[np.ndarray, " incident"],
    *,
    stands_for: Int[np.ndarray, " incident"],
    periodic: bool,
    sides: tuple[bool, ...],
    effort: Effort,
) -> Estimate:
    """Trace from incident patches of some sides to the patches both ways out.

    A row is an incident patch of a side, side by side; the columns are the patches of
    transmission, then those of reflection. Patches are those of the direction of
    travel, upright. Values are shares of light: a row sums to what is not absorbed.

    The relative error is the root mean square, over all pairs of patches, of the error
    of the BSDF, relative to its mean.

    Parameters
    ----------
    box : of the slab, between the planes that paths start from [m]
    incidents : numbers of the incident patches
    stands_for : number of equivalent patches that each of them represents
    sides : for each side in turn, whether it is the back, that of the room
    """
    job = SlabJob(
        scene,
        box,
        partition,
        periodic,
        sides,
        effort.bounces,
        effort.seed,
        effort.batches or BATCHES,
        in_use(),
        incidents,
        stands_for,
    )
    return estimate(job, effort)


def prepare_slab(job: SlabJob) -> Tracer:
    """Return what traces units of the matrices of a sample area."""
    slab = lower_slab(job.scene, job.box, periodic=job.periodic)
    table, count = PatchTable.of(job.partition), len(job.incidents)
    incidents = on_device(mi.UInt32, job.incidents)
    backs = mi.Bool([bool(side) for side in job.sides])
    limit = segments_of(job.bounces)

    def launch(sink: MatrixSink, numbers: PathNumbers, paths: Lanes, _: Unit) -> None:
        back = dr.gather(mi.Bool, backs, paths.number // count)
        patch = dr.gather(mi.UInt32, incidents, paths.number % count)
        ray = start(slab, numbers.points, paths, table, patch, back)
        receiver = Patches(sink, table, len(job.partition), back)
        follow(slab, receiver, numbers.points, paths, ray, dr.opaque(mi.UInt32, limit))

    return matrix_tracer(job, launch, stream=0, seed=job.seed ^ _SALT)
