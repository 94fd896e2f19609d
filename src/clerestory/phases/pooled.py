"""Fewer error components of a matrix, by pooling of batches.

The mean of several batches is a batch as well, so the expected variance is unchanged.
Fewer components need less memory and time, but the standard error is less precise.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from clerestory.errors import MatrixError
from clerestory.matrix.transfer_matrix import TransferMatrix

# Number of error components after pooling
FEW = 4


def pooled(
    components: Float[np.ndarray, "component channel row column"], count: int
) -> Float[np.ndarray, "few channel row column"]:
    """Return a smaller number of error components.

    Raises
    ------
    MatrixError : the number of components is no multiple of `count`

    Examples
    --------
    >>> few = pooled(np.full((16, 1, 1, 1), 0.25), 4)
    >>> few.shape
    (4, 1, 1, 1)
    """
    batches = len(components)
    if batches % count:
        raise MatrixError(f"{batches} error components; a multiple of {count} expected")
    each = batches // count
    groups = components.reshape(count, each, *components.shape[1:]).sum(axis=1)
    scale = np.sqrt(batches * (batches - 1) / (count * (count - 1))) / each
    return np.asarray(groups * components.dtype.type(scale))


def with_few_components(matrix: TransferMatrix) -> TransferMatrix:
    """Return a matrix with four error components, or without any if it has none."""
    if matrix.components is None:
        return matrix
    return replace(matrix, components=pooled(matrix.components, FEW))
