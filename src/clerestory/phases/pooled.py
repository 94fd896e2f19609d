"""Fewer error components of a matrix: batches of its estimate pooled.

A mean of batches is a batch as well: the expected variance stays what it is. With
fewer components the error itself is known less well, but matrices take less room and
their products less time.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from clerestory.errors import MatrixError
from clerestory.matrix.transfer_matrix import TransferMatrix

# Error components where memory, disk or time is short
FEW = 4


def pooled(
    components: Float[np.ndarray, "component channel row column"], count: int
) -> Float[np.ndarray, "few channel row column"]:
    """Return so many error components in place of those given.

    Raises
    ------
    MatrixError : as many batches cannot be pooled evenly

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
    """Return a matrix with four error components, or none where it has none."""
    if matrix.components is None:
        return matrix
    return replace(matrix, components=pooled(matrix.components, FEW))
