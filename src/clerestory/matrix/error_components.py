"""Error components of hourly results, compressed to eight bytes per value.

Deviations of batches whose indices are equal modulo eight are added, over all matrices:
matrices are independent, so the expected variance of any sum of results is unchanged.
The components are stored as fractions of the standard error, which has full precision.
"""

import numpy as np
from jaxtyping import Float32, Int8, Int16

# Number of components, and the integer that stands for one standard error
COUNT, UNIT = 8, 127


def add_components(
    total: Float32[np.ndarray, "eight row step"],
    components: Float32[np.ndarray, "component row step"],
) -> None:
    """Add the error components due to one matrix to `total`."""
    for first in range(0, len(components), COUNT):
        part = components[first : first + COUNT]
        total[: len(part)] += part


def compressed(
    total: Float32[np.ndarray, "eight row step"],
) -> Int8[np.ndarray, "row eight step"]:
    """Return the error components in units of the standard error / 127.

    >>> compressed(np.array([[[3.0]], [[-4.0]]], np.float32)).ravel().tolist()
    [76, -102]
    """
    size = np.sqrt(np.einsum("krs,krs->rs", total, total))
    share = total * (UNIT / np.where(size > 0, size, 1))
    return np.rint(share).astype(np.int8).transpose(1, 0, 2)


def signed_sums(
    components: Int8[np.ndarray, "row eight step"],
) -> Int16[np.ndarray, "row eight step"]:
    """Return eight sums of the components, with the signs of a Hadamard matrix.

    >>> signed_sums(np.array([[[3], [4]]], np.int8)).ravel().tolist()
    [7, -1]
    """
    rows, count, steps = components.shape
    total, half = components.astype(np.int16), 1
    while half < count:
        pairs = total.reshape(rows, -1, 2, half, steps)
        one, other = pairs[:, :, 0], pairs[:, :, 1]
        pairs[:, :, 0], pairs[:, :, 1] = one + other, one - other
        half *= 2
    return total
