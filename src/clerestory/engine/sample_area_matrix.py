"""BSDF matrices of a sample area: shares of light from patch to patch."""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi

from clerestory.engine.matrix_tracers import matrix_tracer
from clerestory.engine.patches import PatchTable
from clerestory.engine.primary_rays import Lanes
from clerestory.engine.sample_area import follow, lower_slab, start
from clerestory.engine.sample_area_jobs import SlabJob
from clerestory.engine.sampler import Points
from clerestory.engine.upload import on_device
from clerestory.engine.walk import Target
from clerestory.engine.work_units import Tracer, Unit

# Keeps the sample points apart from those of other matrices made with the same seed.
_SALT = 0x5BD1E995


@dataclass
class Patches:
    """Scores light by the patch through which it leaves.

    Attributes
    ----------
    target : sums of transmission, then of reflection
    table, count : patches of either
    back : of each path, whether it came from the room
    """

    target: Target
    table: PatchTable
    count: int
    back: mi.Bool

    def receive(self, paths: Lanes, direction, weight, active) -> None:
        """Add light to the patch of a direction of travel."""
        column = self.table.find(direction)
        reflected = (direction.z > 0) == self.back
        column += dr.select(reflected, mi.UInt32(self.count), 0)
        self.target.score(paths.slot, column, weight, active)


def prepare_slab(job: SlabJob) -> Tracer:
    """Return what traces units of the matrices of a sample area."""
    slab = lower_slab(job.scene, job.box, periodic=job.periodic)
    table, count = PatchTable.of(job.partition), len(job.incidents)
    incidents = on_device(mi.UInt32, job.incidents)
    backs = mi.Bool([bool(side) for side in job.sides])
    limit = (1 << 30) if job.bounces is None else job.bounces + 1

    def launch(target: Target, sequence: Points, paths: Lanes, _unit: Unit) -> None:
        back = dr.gather(mi.Bool, backs, paths.number // count)
        patch = dr.gather(mi.UInt32, incidents, paths.number % count)
        ray = start(slab, sequence, paths, table, patch, back)
        receiver = Patches(target, table, len(job.partition), back)
        follow(slab, receiver, sequence, paths, ray, dr.opaque(mi.UInt32, limit))

    target = Target(None, None, mi.UInt64(), *job.shape[2:])
    return matrix_tracer(job, target, launch, stream=0, seed=job.seed ^ _SALT)
