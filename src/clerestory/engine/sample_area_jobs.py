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
    """From the incident patches of some sides to the patches both ways out.

    A row is an incident patch of a side, side by side; the columns are the patches of
    transmission, then those of reflection. Patches are those of the direction of
    travel, upright. Values are shares of light: a row sums to what is not absorbed.

    Attributes
    ----------
    box : of the slab, between the planes that paths start from [m]
    sides : for each side in turn, whether it is the back, that of the room
    incidents : numbers of the incident patches
    stands_for : how many patches that are alike each of them stands for
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
        """Rows, batches, columns and channels."""
        rows = len(self.sides) * len(self.incidents)
        return rows, self.batches, 2 * len(self.partition), channels_of(self.scene)

    def error(self, sums: Sums) -> float:
        """Error of the BSDF of all pairs of patches, relative to its mean."""
        alike = self.stands_for / self.stands_for.mean()
        weight = np.tile(alike, len(self.sides))[:, None, None]
        measure = np.tile(self.partition.projected_solid_angles(), 2)
        values = sums.means() / measure[:, None]
        error = float(np.sqrt(np.mean(weight * variance(values, axis=1))))
        mean = float(np.mean(weight[..., None] * values))
        return error / mean if mean > 0 else 0.0
