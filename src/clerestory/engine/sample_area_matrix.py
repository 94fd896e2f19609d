"""BSDF matrices of a sample area: shares of light from patch to patch."""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.estimate import Effort, Estimate, Sums, estimate, variance
from clerestory.engine.patches import PatchTable
from clerestory.engine.points import points
from clerestory.engine.sample_area import follow, lower_slab, start
from clerestory.engine.starts import Lanes, lanes
from clerestory.engine.walk import Target
from clerestory.hemisphere.partition import RingPartition
from clerestory.scene.model import Scene

__all__ = ["Effort", "trace_matrix"]

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


def trace_matrix(
    scene: Scene,
    box: Float[np.ndarray, "2 3"],
    partition: RingPartition,
    *,
    periodic: bool,
    sides: tuple[bool, ...],
    effort: Effort,
) -> Estimate:
    """Trace from the incident patches of some sides to the patches both ways out.

    A row is an incident patch of a side, side by side; the columns are the patches of
    transmission, then those of reflection. Patches are those of the direction of
    travel, upright. Values are shares of light: a row sums to what is not absorbed.

    The relative error is the root mean square, over all pairs of patches, of the error
    of the BSDF, relative to its mean.

    Parameters
    ----------
    box : of the slab, between the planes that paths start from [m]
    sides : for each side in turn, whether it is the back, that of the room
    """
    slab = lower_slab(scene, box, periodic=periodic)
    table, count = PatchTable.of(partition), len(partition)
    backs = mi.Bool([bool(side) for side in sides])
    limit = (1 << 30) if effort.bounces is None else effort.bounces + 1
    measure = np.tile(partition.projected_solid_angles(), 2)

    def launch(target: Target, rows: np.ndarray, first: int, number: int) -> None:
        sequence = points(first, number)
        seed = effort.seed ^ _SALT
        paths = lanes(sequence, rows=rows, batches=effort.batches, seed=seed, stream=0)
        back = dr.gather(mi.Bool, backs, paths.number // count)
        ray = start(slab, sequence, paths, table, paths.number % count, back)
        receiver = Patches(target, table, count, back)
        follow(slab, receiver, sequence, paths, ray, dr.opaque(mi.UInt32, limit))

    def noisy(sums: Sums) -> tuple[np.ndarray, float]:
        values = sums.means() / measure[:, None]
        error = np.sqrt(np.mean(variance(values, axis=1)))
        mean = float(np.mean(values))
        ratio = error / (effort.relative_error * mean) if mean > 0 else 0.0
        return np.full(len(sums.count), ratio > 1), float(ratio)

    target = Target(None, None, mi.UInt64(), 2 * count, 1 if slab.grey else 3)
    return estimate(launch, target, len(sides) * count, effort, noisy, together=True)
