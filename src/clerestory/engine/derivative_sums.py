"""Sums of the derivatives of a matrix, beside the sums of the matrix.

Each row has *places*: the batches of the matrix, the batches of the derivative by each
parameter, and one for each pair of parameters. Second derivatives have no standard
errors, and are summed over a quarter of the batches. The sums are those of logarithmic
derivatives, as signed integers.
"""

from dataclasses import dataclass, replace

import numpy as np

from clerestory.engine.sums import Sums, estimated
from clerestory.matrix.derivatives import Derivatives, Parameter, pair_indices

# A logarithmic derivative of 1 adds these fractions of the unit of the sums, so that
# those of long paths, and second derivatives without batches, stay in range
_FIRST, _SECOND = 2.0**-8, 2.0**-12


@dataclass(frozen=True)
class Places:
    """Places of a row of sums, for a number of batches and parameters."""

    batches: int
    parameters: int

    @property
    def count(self) -> int:
        """Number of places."""
        pairs = len(pair_indices(self.parameters))
        return self.batches * (1 + self.parameters) + pairs

    @property
    def of_pairs(self) -> int:
        """Number of batches that are summed in second derivatives."""
        return max(1, self.batches // 4)

    @property
    def unit_of_first(self) -> float:
        """Weight that a logarithmic derivative of 1 adds."""
        return _FIRST

    @property
    def unit_of_second(self) -> float:
        """Weight that a second logarithmic derivative of 1 adds."""
        return _SECOND

    def pair(self, one, other):  # type: ignore[no-untyped-def]
        """Return the place of a pair of parameters: numbers, or Dr.Jit arrays."""
        before = (one * (2 * self.parameters + 1 - one)) >> 1
        return self.batches * (1 + self.parameters) + before + (other - one)


def values_of(sums: Sums, batches: int) -> Sums:
    """Return the sums of a matrix without those of its derivatives."""
    return replace(sums, total=sums.total[:, :batches])


def derivatives_of(
    sums: Sums, batches: int, parameters: tuple[Parameter, ...], *, components: bool
) -> Derivatives:
    """Return the derivatives of some rows of a matrix."""
    rows, _, columns, channels = sums.total.shape
    count, shape = len(parameters), (channels, rows, columns)
    theta = np.array([parameter.value for parameter in parameters])
    first = np.empty((count, *shape))
    deviations = np.empty((batches, count, *shape), "f4") if components else None
    for number, value in enumerate(theta):
        start = batches * (1 + number)
        part = _signed(sums, slice(start, start + batches), _FIRST)
        found = estimated(part, reached=True, components=components)
        np.divide(found.values, value, out=first[number])
        if deviations is not None and found.components is not None:
            np.divide(found.components, np.float32(value), out=deviations[:, number])
    last = slice(batches * (1 + count), None)
    pairs = _signed(sums, last, _SECOND).means() / Places(batches, count).of_pairs
    scale = np.array([theta[i] * theta[j] for i, j in pair_indices(count)])
    second = np.moveaxis(pairs, (1, 3), (0, 1)) / scale[:, None, None, None]
    return Derivatives(parameters, first, second, deviations)


def _signed(sums: Sums, places: slice, unit: float) -> Sums:
    return replace(
        sums, total=sums.total[:, places].view(np.int64), one=sums.one * unit
    )


def joined(blocks: list[Derivatives]) -> Derivatives:
    """Return the derivatives of successive blocks of rows as one."""
    first, *rest = blocks
    if not rest:
        return first
    parts = [block.components for block in blocks if block.components is not None]
    return Derivatives(
        first.parameters,
        np.concatenate([block.first for block in blocks], axis=2),
        np.concatenate([block.second for block in blocks], axis=2),
        np.concatenate(parts, axis=3) if parts else None,
    )
