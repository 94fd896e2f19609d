"""Glare pixels in islands so far apart that no search leads from one to another."""

import numpy as np
from jaxtyping import Bool, Int
from scipy import ndimage

_AROUND = np.ones((3, 3), dtype=bool)

# Cells of the coarse grid per reach of a search
_CELLS = 4


def islands(
    mask: Bool[np.ndarray, "row column"], reach: int
) -> Int[np.ndarray, " pixel"]:
    """Island of each pixel of the mask in reading order, from 0.

    Pixels of different islands are more than `reach` apart in row or column. Islands
    are told apart on a coarse grid: near ones may be taken for one.

    >>> mask = np.zeros((40, 40), bool)
    >>> mask[2, [2, 5, 38]] = True
    >>> islands(mask, 8).tolist()
    [0, 0, 1]
    """
    size = max(reach // _CELLS, 1)
    row, column = np.nonzero(mask)
    row, column = row // size, column // size
    cells = np.zeros((row.max(initial=0) + 1, column.max(initial=0) + 1), dtype=bool)
    cells[row, column] = True
    # Cells within this distance may hold pixels within reach: let them touch
    grow = (reach // size + 2) // 2
    grown = np.pad(cells, grow)
    grown = ndimage.maximum_filter(grown, size=2 * grow + 1)
    labels, _ = ndimage.label(grown, structure=_AROUND)
    island: np.ndarray = labels[row + grow, column + grow] - 1
    return island
