"""Pictures over time by the matrix equation.

Pictures are yielded one by one. The product is computed in blocks of pixels and time
steps, so that memory does not grow with the number of steps.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from clerestory.image.picture import Picture
from clerestory.phases.blockwise_product import BlockwiseProduct
from clerestory.phases.matrix_equation import (
    Skies,
    States,
    Term,
    WindowMatrices,
    equation_bands,
)
from clerestory.phases.picture_matrices import Camera

# Time steps per block: 640,000 pixels × 16 steps take 123 MB
_STEPS = 16

# Pixels per block: the memory for coefficients converted from half precision to float32
_PIXELS = 1 << 15


def pictures_over_time(
    windows: Sequence[WindowMatrices],
    terms: Sequence[Term],
    camera: Camera,
    skies: Skies,
    states: States | None = None,
) -> Iterator[Picture]:
    """Yield the picture of every time step, in order.

    The rows of all matrices are the pixels of the camera. With matrices from
    `picture_matrices`, the terms `FIVE_PHASE` give the extended five-phase method.
    """
    bands = equation_bands(windows, skies)
    product = BlockwiseProduct(
        windows,
        terms,
        skies,
        states,
        np.eye(len(bands)),
        len(camera),
        errors=False,
        most_receivers=_PIXELS,
        most_steps=_STEPS,
    )
    light = np.zeros((0, 0, 0), np.float32)
    for block in product.blocks():
        if block.rows.start == 0:
            shape = len(bands), len(camera), block.times.stop - block.times.start
            light = np.zeros(shape, np.float32)
        light[:, block.rows, block.steps] = block.terms.sum(axis=0)
        if block.rows.stop == len(camera):
            for step, moment in enumerate(skies.times[block.times]):
                stamp = np.datetime_as_string(moment, unit="m")
                pixels = np.maximum(light[:, :, step], 0)
                yield camera.picture(pixels, f"TIME= {stamp}", bands=bands)
