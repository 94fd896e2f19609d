"""Factors of the terms of a blockwise product, and their error components."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float32, Int

from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.column_light import Light, PatchLight, SkyLight, add_signed
from clerestory.phases.matrix_equation import Readable
from clerestory.phases.received_sunlight import ReceivedSunlight
from clerestory.phases.receivers import SkyCoefficients, side_by_side
from clerestory.phases.stored_views import StoredColumns


@dataclass(frozen=True, eq=False)
class Components:
    """Error components due to one estimated matrix, for a block of receivers.

    `source` identifies the matrix in all blocks. `values` include the sign of the term.
    """

    source: tuple[int, int, int]
    steps: Int[np.ndarray, " step"]
    values: Float32[np.ndarray, "component out row step"]

    def plus(self, other: "Components") -> "Components":
        """Return the sum of components in the same or in other time steps."""
        if np.array_equal(self.steps, other.steps):
            self.values[:] += other.values
            return self
        steps = np.union1d(self.steps, other.steps)
        total = np.zeros((*self.values.shape[:-1], len(steps)), np.float32)
        for each in (self, other):
            total[..., np.searchsorted(steps, each.steps)] += each.values
        return replace(self, steps=steps, values=total)


@dataclass(frozen=True, eq=False)
class Factor:
    """Matrices V, C or C_ds, and the radiance or irradiance that they multiply.

    Attributes
    ----------
    source : numbers of the term, and of window and shade state
    sign : 1 or -1, sign of the term
    steps : time steps of the block with this light
    """

    source: tuple[int, int]
    sign: int
    matrices: Sequence[Readable]
    light: Light
    steps: Int[np.ndarray, " step"]

    @property
    def paths(self) -> tuple[int, int]:
        """Number of the paths, equal for matrices that are estimated from the same.

        These are C and C_d of a window and state, and V T D of all shade states.
        """
        if isinstance(self.matrices[0], SkyCoefficients):
            return self.source[0], -1
        same = isinstance(self.light, SkyLight)
        same &= isinstance(self.matrices[0], TransferMatrix | StoredColumns)
        return (-1, self.source[1]) if same else self.source

    def add(self, total: np.ndarray, rows: slice, *, errors: bool) -> list[Components]:
        """Add the light of some receivers, and return its error components."""
        layers = side_by_side(self.matrices, rows, errors=errors)
        found = self.light.received(layers)
        groups = [found[1:]]
        if errors and isinstance(self.light, PatchLight):
            groups += self.light.spread(layers[0])
        add_signed(self.sign, total, found[0], self.steps)
        if self.sign < 0:
            for values in groups:
                np.negative(values, out=values)
        return [
            Components((*self.source, number), self.steps, values)
            for number, values in enumerate(groups)
            if len(values)
        ]


@dataclass(frozen=True, eq=False)
class SunlightFactor:
    """C_ds S_sun of all receivers in a block of time steps, in steps with sunlight.

    Attributes as in `Factor`.
    """

    source: tuple[int, int]
    sign: int
    light: ReceivedSunlight
    steps: Int[np.ndarray, " step"]

    @property
    def paths(self) -> tuple[int, int]:
        """Number of the paths."""
        return self.source

    def add(self, total: np.ndarray, rows: slice, *, errors: bool) -> list[Components]:
        """Add the light of some receivers, and return its error component."""
        add_signed(self.sign, total, self.light.mean(rows), self.steps)
        if not errors:
            return []
        error = self.sign * self.light.error(rows)
        return [Components((*self.source, 0), self.steps, error[None])]
