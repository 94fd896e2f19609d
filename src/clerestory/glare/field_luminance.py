"""Mean and median luminance of the field of view, weighted by position index."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.glare.glare_view import GlareView


class FieldLuminances(NamedTuple):
    """Luminance of the field of view [cd/m²].

    Attributes
    ----------
    average_by_position, average_by_square : mean of L/P and of L/P², with luminance L
        and position index P, weighted by solid angle
    median, median_by_position, median_by_square : median of L, of L/P and of L/P² over
        pixels
    """

    average_by_position: float
    average_by_square: float
    median: float
    median_by_position: float
    median_by_square: float


def field_luminances(
    luminance: Float[np.ndarray, "row column"], eye: GlareView
) -> FieldLuminances:
    """Return mean and median luminances of the pixels in view.

    `average_by_square` differs from av_lum_pos2 of evalglare, which is divided twice by
    the solid angle of the view.

    >>> from clerestory.glare.glare_view import glare_view
    >>> from clerestory.scene.view import View
    >>> eye = glare_view(View(kind="angular", horizontal=180, vertical=180), 64, 64)
    >>> field_luminances(np.full((64, 64), 90.0), eye).median
    90.0
    """
    bright = luminance[eye.valid].astype(float)
    omega = eye.solid_angle[eye.valid]
    by_position = bright / eye.position_index[eye.valid]
    by_square = by_position / eye.position_index[eye.valid]
    total = eye.total_solid_angle
    return FieldLuminances(
        average_by_position=float(by_position @ omega) / total,
        average_by_square=float(by_square @ omega) / total,
        median=float(np.median(bright)),
        median_by_position=float(np.median(by_position)),
        median_by_square=float(np.median(by_square)),
    )
