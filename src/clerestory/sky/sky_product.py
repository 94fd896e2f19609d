"""Product of daylight coefficients and an annual sky matrix, in blocks of time steps.

The sky radiance in each band is achromatic radiance times a colour per patch. Daylight
coefficients are therefore first summed over bands, with weights such as luminous
efficacy, and a year takes one matrix product instead of one per band.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, Float32, Int
from scipy.sparse import csc_array

# Largest number of float32 values of one block: 128 MB
_BLOCK = 32_000_000


def fold(
    values: Float[np.ndarray, "*batch channel row patch"],
    colour: Float[np.ndarray, "band patch"],
    weights: Float[np.ndarray, " band"],
) -> Float32[np.ndarray, "*batch row patch"]:
    """Sum of weight · colour · daylight coefficient over bands.

    Daylight coefficients with a single channel apply to all bands.
    """
    tint = weights[:, None] * colour
    if values.shape[-3] == 1:
        tint = tint.sum(axis=0, keepdims=True)
    total = values[..., 0, :, :] * tint[0]
    for channel in range(1, len(tint)):
        total += values[..., channel, :, :] * tint[channel]
    return np.asarray(total, dtype=np.float32)


def lit_steps(
    diffuse: Float32[np.ndarray, "patch time"], sun: csc_array
) -> Int[np.ndarray, " lit"]:
    """Indices of the time steps with sky or sun radiance above zero."""
    return np.flatnonzero(diffuse.T.any(axis=1) | (np.diff(sun.indptr) > 0))


def product_blocks(
    sky: Float32[np.ndarray, "row patch"],
    sun: Float32[np.ndarray, "row patch"],
    *,
    diffuse: Float32[np.ndarray, "patch time"],
    direct: csc_array,
    steps: Int[np.ndarray, " lit"],
) -> Iterator[tuple[Int[np.ndarray, " block"], Float32[np.ndarray, "row block"]]]:
    """Yield blocks of time steps with the products, such as illuminance, for all rows.

    `sky` and `sun` are results of `fold`, for the colours of sky and sun;
    `diffuse` and `direct` are achromatic radiances of sky and sun [W/(m²·sr)].
    """
    rows, patches = sky.shape
    size = max(1, min(_BLOCK // max(rows, patches), 4096))
    sun_columns = np.ascontiguousarray(sun.T)
    dark = not diffuse.any()
    for start in range(0, len(steps), size):
        block = steps[start : start + size]
        if dark:
            received = np.zeros((rows, len(block)), np.float32)
        else:
            received = sky @ diffuse.T[block].T
        part = direct[:, block]
        if part.nnz:
            received += (part.T @ sun_columns).T
        yield block, received


def row_blocks(rows: int, *, layers: int, patches: int) -> Iterator[slice]:
    """Yield slices of rows; the coefficients of a slice take at most 128 MB."""
    size = max(1, _BLOCK // (layers * patches))
    for start in range(0, rows, size):
        yield slice(start, min(start + size, rows))
