"""Radiance's data files (.dat): interpolated tables over one or more axes.

Interpolation is multilinear. Beyond the ends of an axis, values are extrapolated
linearly over one grid interval; farther out, they decrease inversely with distance.

A file contains the number of axes; for each axis, `begin end count`, or `0 0 count` and
the positions if they are not equidistant; then the values, with the last axis fastest.

Reference: G. Ward, "The RADIANCE 6.0 Synthetic Imaging System",
section 2.3 (data files).
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.checks import finite, require
from clerestory.errors import InputError, located
from clerestory.files import read_text

# Maximum number of axes
_MOST_AXES = 5


@dataclass(frozen=True, eq=False)
class DataArray:
    """A table of values on a grid; the positions along each axis ascend or descend."""

    axes: tuple[Float[np.ndarray, " _"], ...]
    values: Float[np.ndarray, "..."]

    def __post_init__(self) -> None:
        lengths = tuple(len(axis) for axis in self.axes)
        require(
            lengths == self.values.shape,
            f"values of shape {self.values.shape} on axes of {lengths} positions; equal"
            " numbers expected",
        )
        for axis in self.axes:
            step = np.diff(axis)
            require(
                len(axis) > 1 and (np.all(step > 0) or np.all(step < 0)),
                "positions of an axis are fewer than 2 or out of order; 2 or more,"
                " ascending or descending, expected",
            )
        finite(self.values, "a value of the table")

    def value(
        self, position: Float[np.ndarray, "points axes"]
    ) -> Float[np.ndarray, " points"]:
        """Return the values interpolated at the given positions."""
        cells = [_cell(axis, x) for axis, x in zip(self.axes, position.T, strict=True)]
        return _interpolated(self.values, [], cells)


def read_data_array(path: str | Path) -> DataArray:
    """Return the table in a data file."""
    words = read_text(path).split()
    try:
        numbers = np.array(words, dtype=float)
    except ValueError as error:
        raise InputError(f"not a data file: {error}", file=path) from error
    reader = _Reader(numbers, path)
    axes = [_axis(reader) for _ in range(reader.whole("number of axes", 1, _MOST_AXES))]
    shape = tuple(len(a) for a in axes)
    values = reader.take(math.prod(shape), "values").reshape(shape)
    with located(file=path):
        return DataArray(tuple(axes), values)


@dataclass
class _Reader:
    numbers: Float[np.ndarray, " words"]
    path: str | Path
    at: int = 0

    def take(self, count: int, what: str) -> Float[np.ndarray, " count"]:
        part = self.numbers[self.at : self.at + count]
        message = f"the file ends after {len(part)} of {count} {what}"
        require(len(part) == count, message, file=self.path)
        self.at += count
        return part

    def whole(self, what: str, least: int, most: int) -> int:
        [number] = self.take(1, what)
        require(
            least <= number <= most and number == int(number),
            f"{what} is {number:g}; a whole number from {least} to {most} expected",
            file=self.path,
        )
        return int(number)


def _axis(reader: _Reader) -> Float[np.ndarray, " positions"]:
    begin, end = reader.take(2, "limits of an axis")
    # Limit of the number of positions: the table has at least one value for each
    most = max(len(reader.numbers), 2)
    count = reader.whole("number of positions on an axis", 2, most)
    if begin == end:
        return reader.take(count, "positions of an axis")
    return np.linspace(begin, end, count)


def _cell(
    axis: Float[np.ndarray, " positions"], x: Float[np.ndarray, " points"]
) -> tuple[np.ndarray, np.ndarray]:
    # Index of the grid interval of each point, and position in it (0 to 1 if inside)
    if axis[0] > axis[-1]:
        axis, x = -axis, -x
    cell = np.clip(np.searchsorted(axis, x, side="right") - 1, 0, len(axis) - 2)
    return cell, (x - axis[cell]) / (axis[cell + 1] - axis[cell])


def _interpolated(
    values: Float[np.ndarray, "..."],
    chosen: list[np.ndarray],
    cells: list[tuple[np.ndarray, np.ndarray]],
) -> Float[np.ndarray, " points"]:
    # Interpolates along all axes but the first recursively, then along the first
    if not cells:
        return np.asarray(values[tuple(chosen)])
    (cell, share), rest = cells[0], cells[1:]
    low = _interpolated(values, [*chosen, cell], rest)
    return _along(low, _interpolated(values, [*chosen, cell + 1], rest), share)


def _along(
    low: Float[np.ndarray, " points"],
    high: Float[np.ndarray, " points"],
    t: Float[np.ndarray, " points"],
) -> Float[np.ndarray, " points"]:
    # Linear up to one interval beyond the axis, then decreasing inversely with distance
    straight = low * (1 - t) + high * t
    above = (2 * high - low) / np.where(t > 2, t + 1, 1.0)
    below = (2 * low - high) / np.where(t < -1, -t, 1.0)
    return np.asarray(np.where(t > 2, above, np.where(t < -1, below, straight)))
