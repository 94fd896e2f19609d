"""Jobs of light from distant sources on sensors, unobstructed or through glass.

Coefficients are summed in floating point. No two units contain the same element of the
matrix, so the result does not depend on the order of units.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.channels import channels_of
from clerestory.engine.controller import EstimatedJob
from clerestory.engine.sums import Sums
from clerestory.engine.work_units import Unit, UnitSize, evenly_spaced
from clerestory.scene.sensors import Sensors

# Largest number of parallel rays (lanes) in one work unit
LANES = 1 << 21


@dataclass(frozen=True, eq=False, kw_only=True)
class UnscatteredJob(EstimatedJob):
    """Irradiance of sensors from distant sources, unobstructed or through glass.

    Each column has one source; `directions` are unit vectors to sample points of the
    source, batch by batch. `samples` is the number of rays per sensor and source.
    If there are `probes`, directions to other points of the source, the samples are
    traced only for pairs of sensor and source whose first probes, at the rim of the
    source, differ in transmittance, such as sensors in the penumbra of the sun. The
    estimate of other pairs is the mean of the `inside` last probes, independent random
    points of the source. It is unbiased, as these have no part in the choice.
    """

    tracer: ClassVar[tuple[str, str]] = ("direct_visibility", "prepare_unscattered")
    together: ClassVar[bool] = False

    samples: int
    sensors: Sensors
    directions: Float[np.ndarray, "column point 3"]
    probes: Float[np.ndarray, "column probe 3"] | None = None
    inside: int = 0

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Numbers of sensors, batches, sources and channels."""
        rows, columns = len(self.sensors), len(self.directions)
        return rows, self.batches, columns, channels_of(self.scene)

    @property
    def points(self) -> int:
        """Number of sample points in each batch."""
        return -(-self.samples // self.batches)

    @property
    def first_rays(self) -> int:
        """Number of rays traced at first for each pair of sensor and source."""
        return (
            self.batches * self.points if self.probes is None else self.probes.shape[1]
        )

    @property
    def receivers(self) -> int:
        """Number of pairs of a sensor (row) and a source (column)."""
        return self.shape[0] * self.shape[2]

    def pilot_unit(self, paths: int) -> Unit:
        """Return a pilot unit of consecutive rows and evenly spaced columns."""
        rows, _, columns, _ = self.shape
        pairs = max(1, paths // self.first_rays)
        few = evenly_spaced(columns, max(1, min(pairs, max(8, pairs // rows))))
        block = max(1, min(rows, pairs // max(1, len(few))))
        first = (rows - block) // 2
        return Unit(np.arange(first, first + block), 0, self.points, few)

    def empty_sums(self, rows: int) -> Sums:
        """Return zero sums, to which units add the means of batches."""
        return Sums.empty(float, (rows, *self.shape[1:]), 1 / self.points)

    def error(self, sums: Sums) -> float:
        """Return zero: convergence is not tested, as the number of rays is given."""
        return 0.0

    def units(
        self, rows: Int[np.ndarray, " row"], first: int, end: int, size: UnitSize
    ) -> Iterator[Unit]:
        """Divide the rows and columns of the matrix into work units."""
        del size
        columns = np.arange(self.shape[2])
        pairs = max(1, LANES // self.first_rays)
        block = min(len(rows), pairs)
        every = max(1, pairs // block)
        for start in range(0, len(columns), every):
            for at in range(0, len(rows), block):
                chosen = rows[at : at + block], columns[start : start + every]
                yield Unit(chosen[0], first, end - first, chosen[1])
