"""Luminance of the cells of a sphere over time, and the statistical error of DGP."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.glare.dgp_error import DgpModel, Light, statistical_variance
from clerestory.glare.eye_directions import SunDisc
from clerestory.phases.picture_series import PixelSeries

# Number of time steps of a block of the product
STEPS = 256


class CellLuminance(NamedTuple):
    """Luminance of cells [cd/m²], and DGP by them, at each time step.

    `variance` is the statistical variance of DGP, `value` DGP without its limit of 1.
    """

    luminance: Light
    variance: Float[np.ndarray, "view step"]
    value: Float[np.ndarray, "view step"]


def cell_luminance(series: PixelSeries, model: DgpModel, sun: SunDisc) -> CellLuminance:
    """Return the luminance of the cells of a model, from a series with errors.

    `sun` is the sun's disc at the time steps of the series.
    """
    count, steps = model.samples.count, len(sun.luminance)
    light = np.zeros((count, steps), np.float32)
    variance, value = np.zeros((2, len(model.views), steps))
    for block in series.blocks(STEPS, rows=count):
        own, level = block.times.start + block.steps, block.light[0]
        light[:, own] = level
        terms = model.terms(level, sun.select(own))
        rest = block.variance, block.shared
        variance[:, own] = statistical_variance(model, terms, level, *rest)
        value[:, own] = terms.value
    return CellLuminance(light, variance, value)
