"""Luminance statistics of the field of view, and of regions of a picture.

Regions are zones, masks or horizontal bands.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clerestory.array_types import Image, ImageMask
from clerestory.checks import require
from clerestory.glare.glare_view import GlareView

# Luminance above which pixels of a mask picture mark the region [cd/m²] (evalglare)
MASK_LUMINANCE = 0.1


class FieldLuminances(NamedTuple):
    """Mean and median of L, L/P and L/P² in the field of view [cd/m²].

    L is the luminance and P the position index of a pixel. Means are weighted by solid
    angle.
    """

    average_by_position: float
    average_by_square: float
    median: float
    median_by_position: float
    median_by_square: float


def field_luminances(luminance: Image, eye: GlareView) -> FieldLuminances:
    """Return mean and median luminances of the pixels in view.

    `average_by_square` is divided by the solid angle of the view once, unlike
    av_lum_pos2 of evalglare, which is divided twice.
    """
    bright = luminance[eye.valid].astype(float)
    omega = eye.solid_angle[eye.valid]
    by_position = bright / eye.position_index[eye.valid]
    by_square = by_position / eye.position_index[eye.valid]
    return FieldLuminances(
        float(by_position @ omega) / eye.total_solid_angle,
        float(by_square @ omega) / eye.total_solid_angle,
        *(float(np.median(part)) for part in (bright, by_position, by_square)),
    )


@dataclass(frozen=True)
class RegionStatistics:
    """Pixel count, solid angle [sr], luminances [cd/m²] and illuminance of a region.

    The average luminance is weighted by solid angle, the other luminances are not. The
    illuminance from the region is vertical, at the eye [lux].
    """

    pixels: int
    solid_angle: float
    average: float
    median: float
    deviation: float
    percentile_75: float
    percentile_95: float
    least: float
    most: float
    illuminance: float


def region_statistics(
    luminance: Image, eye: GlareView, region: ImageMask
) -> RegionStatistics:
    """Return the luminance statistics of the pixels of a region that are in view."""
    inside = region & eye.valid
    values = np.sort(luminance[inside].astype(float))
    require(values.size, "the region has no pixel in view; a larger region expected")
    omega = eye.solid_angle[inside]
    flux = luminance[inside] * omega
    return RegionStatistics(
        pixels=values.size,
        solid_angle=float(omega.sum()),
        average=float(flux.sum() / omega.sum()),
        median=float(np.median(values)),
        deviation=float(values.std()),
        percentile_75=_percentile(values, 0.75),
        percentile_95=_percentile(values, 0.95),
        least=float(values[0]),
        most=float(values[-1]),
        illuminance=float((flux * eye.cosine[inside]).sum()),
    )


def _percentile(values: np.ndarray, share: float) -> float:
    # Mean of the two values adjacent to the percentile, as in evalglare
    at = int(values.size * share)
    return float((values[at] + values[max(at - 1, 0)]) / 2)


def band(eye: GlareView, half_width: float) -> ImageMask:
    """Mask of the pixels within an angle [rad] of the centre row of the picture.

    The angle is measured between pixels of the same column.
    """
    rows, _ = eye.shape
    middle = rows - 1 - (rows - 1) // 2
    cosine = np.einsum("ijk,jk->ij", eye.direction, eye.direction[middle])
    near = np.asarray(np.arccos(np.clip(cosine, -1, 1)) <= half_width)
    near[middle] = True
    return near
