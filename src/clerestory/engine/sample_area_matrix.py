"""BSDF matrices of a sample area: flux from patch to patch per incident flux."""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi

from clerestory.engine.matrix_jobs import SlabJob
from clerestory.engine.matrix_tracers import matrix_tracer
from clerestory.engine.patches import PatchTable
from clerestory.engine.path_tracer import segments_of
from clerestory.engine.primary_rays import Lanes
from clerestory.engine.sample_area import follow, lower_slab, start
from clerestory.engine.sinks import MatrixSink
from clerestory.engine.upload import on_device
from clerestory.engine.work_units import Tracer, Unit

# Makes the random numbers differ from those of other matrices with the same seed.
_SALT = 0x5BD1E995


@dataclass
class Patches:
    """Receiver that adds up path weights by patch of the leaving direction.

    `count` is the number of transmission patches; `back` is true for paths that
    started on the side of the room.
    """

    sink: MatrixSink
    table: PatchTable
    count: int
    back: mi.Bool

    def receive(self, direction, weight, active) -> None:
        """Add the path weight to the patch of the leaving direction."""
        column = self.table.find(direction)
        reflected = (direction.z > 0) == self.back
        column += dr.select(reflected, mi.UInt32(self.count), 0)
        self.sink.add(None, column, weight, active)


def prepare_slab(job: SlabJob) -> Tracer:
    """Return a function that traces units of the BSDF matrices of a sample area."""
    slab = lower_slab(job.scene, job.box, periodic=job.periodic)
    table, count = PatchTable.of(job.partition), len(job.incidents)
    incidents = on_device(mi.UInt32, job.incidents)
    backs = mi.Bool([bool(side) for side in job.sides])
    limit = segments_of(job.bounces)

    def launch(sink: MatrixSink, paths: Lanes, _: Unit) -> None:
        back = dr.gather(mi.Bool, backs, paths.number // count)
        patch = dr.gather(mi.UInt32, incidents, paths.number % count)
        ray = start(slab, paths.numbers, table, patch, back)
        receiver = Patches(sink, table, len(job.partition), back)
        follow(slab, receiver, paths.numbers, ray, limit)

    return matrix_tracer(job, launch, stream=0, seed=job.seed ^ _SALT)
