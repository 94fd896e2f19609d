"""Inverse transform sampling of piecewise constant distributions.

A cell is chosen with a probability proportional to its flux. The random number is then
rescaled to select the position within the cell.
"""

import numpy as np
from jaxtyping import Float, Int

from clerestory.hemisphere.shirley_chiu import directions_from_square

_Cells = Int[np.ndarray, " samples"]
_Samples = Float[np.ndarray, " samples"]


def choose_cells(
    flux: Float[np.ndarray, " cells"], first: _Cells, last: _Cells, u: _Samples
) -> tuple[_Cells, _Samples, _Samples]:
    """Sample a cell in each range first…last − 1, in proportion to the flux.

    Return the cells, the random numbers rescaled to 0…1, and the flux of each range.
    """
    running = np.concatenate([[0.0], np.cumsum(flux)])
    total = running[last] - running[first]
    target = running[first] + u * total
    cell = np.searchsorted(running, target, side="right") - 1
    cell = np.clip(cell, first, last - 1)
    rest = (target - running[cell]) / np.where(flux[cell] > 0, flux[cell], 1)
    return cell, np.clip(rest, 0, 1 - 1e-12), total


def sample_square(
    value: Float[np.ndarray, " cells"], u: Float[np.ndarray, "samples 2"]
) -> tuple[Float[np.ndarray, "samples 3"], _Samples]:
    """Sample directions from a BSDF on a square grid.

    Return the directions and their probability density [1/sr].

    `value`: BSDF of the cells of the Shirley–Chiu square, in row-major order.
    """
    first = np.zeros(len(u), dtype=int)
    cell, rest, total = choose_cells(value, first, first + len(value), u[:, 0])
    if not len(u) or total[0] <= 0:
        return np.tile([0.0, 0.0, 1.0], (len(u), 1)), np.zeros(len(u))
    edge = round(len(value) ** 0.5)
    row, column = np.divmod(cell, edge)
    leaving = directions_from_square((row + rest) / edge, (column + u[:, 1]) / edge)
    return leaving, value[cell] * len(value) / (np.pi * total) * leaving[:, 2]
