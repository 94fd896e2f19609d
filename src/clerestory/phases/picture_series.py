"""Pictures over time by the matrix equation.

Each step's picture is yielded and not kept. Blocks of some steps and some thousand
pixels are multiplied at a time, so that memory does not grow with the year.
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

# Steps multiplied at a time: 640,000 pixels of 16 steps take 123 MB
_STEPS = 16

# Pixels multiplied at a time: their half-precision coefficients are widened for it
_PIXELS = 1 << 15


def pictures_over_time(
    windows: Sequence[WindowMatrices],
    terms: Sequence[Term],
    camera: Camera,
    skies: Skies,
    states: States | None = None,
) -> Iterator[Picture]:
    """Yield the picture of every time step, in order, a few of them in memory.

    With direct sun that is reflected by one surface (C_R-ds) and seen in the window
    (C_F-ds), the five terms are those of the extended five-phase method.

    Parameters
    ----------
    windows : their matrices have the pixels of the camera as receivers
    terms : of the equation
    states : number of the state at each step, per window; by default the first

    Raises
    ------
    MatrixError : matrices do not fit each other, or skies have different times
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
