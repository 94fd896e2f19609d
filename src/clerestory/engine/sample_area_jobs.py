"""Job of the BSDF matrices of a sample area of a shading system."""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.channels import channels_of
from clerestory.engine.controller import EstimatedJob
from clerestory.engine.sums import Sums, variance
from clerestory.hemisphere.partition import RingPartition


@dataclass(frozen=True, eq=False, kw_only=True)
class SlabJob(EstimatedJob):
    """Flux fractions from incident patches to transmitted and reflected patches.

    The rows are the incident patches of the first side, then of the second. The columns
    are the patches of transmission, then of reflection. Patches refer to the direction
    of travel, with its z component taken as positive. A value is a fraction of the
    incident flux; a row sums to one minus the absorptance.

    Attributes
    ----------
    box : lower and upper corner of the slab; paths start on its end planes [m]
    sides : for each side in order, whether it is the back (facing the room)
    incidents : indices of the incident patches
    stands_for : number of equivalent patches that each incident patch represents
    """

    tracer: ClassVar[tuple[str, str]] = ("sample_area_matrix", "prepare_slab")
    together: ClassVar[bool] = True

    box: Float[np.ndarray, "2 3"]
    partition: RingPartition
    periodic: bool
    sides: tuple[bool, ...]
    incidents: Int[np.ndarray, " incident"]
    stands_for: Int[np.ndarray, " incident"]

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Numbers of rows, batches, columns and channels."""
        rows = len(self.sides) * len(self.incidents)
        return rows, self.batches, 2 * len(self.partition), channels_of(self.scene)

    def error(self, sums: Sums) -> float:
        """RMS error of the BSDF over all pairs of patches, relative to its mean."""
        alike = self.stands_for / self.stands_for.mean()
        weight = np.tile(alike, len(self.sides))[:, None, None]
        measure = np.tile(self.partition.projected_solid_angles(), 2)
        values = sums.means() / measure[:, None]
        error = float(np.sqrt(np.mean(weight * variance(values, axis=1))))
        mean = float(np.mean(weight[..., None] * values))
        return error / mean if mean > 0 else 0.0
