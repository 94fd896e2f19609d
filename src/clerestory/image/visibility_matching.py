"""Visibility-matching tone mapping by histogram adjustment.

Luminance is mapped by its cumulative histogram, with a limited slope, so that no
contrast becomes visible that an observer would not see in the scene. One-degree samples
(the foveal field, to which the eye adapts) and single pixels have equal total weight.

References
----------
G. Ward Larson, H. Rushmeier, C. Piatko, "A visibility matching tone reproduction
operator for high dynamic range scenes", IEEE Trans. Visualization and Computer
Graphics 3 (1997) 291–306; pcond of Radiance. Loss of acuity is not modelled.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Float32

from clerestory.checks import require
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.image.arithmetic import reduce
from clerestory.image.picture import Picture, photometric
from clerestory.image.veiling_glare import foveal_view, with_veil

# Number of histogram bins, and range of visible luminance [cd/m²] (pcond.h)
_BINS = 100
_DARKEST, _BRIGHTEST = 1e-7, 1e7

# Fraction of samples that may exceed the limit of the slope (pcond3.c: CVRATIO)
_TOLERANCE = 0.025

# Upper limit of scotopic and lower limit of photopic vision [cd/m²] (pcond.h)
_RODS_ONLY, _CONES_ONLY = 5.62e-3, 5.62

# Weights of red, green and blue in scotopic luminance (pcond.h)
_SCOTOPIC_WEIGHTS = (0.062, 0.608, 0.330)


@dataclass(frozen=True)
class Screen:
    """Display on which a picture is shown.

    Attributes
    ----------
    white : largest luminance [cd/m²]
    contrast : ratio of largest to smallest luminance
    """

    white: float = 100.0
    contrast: float = 100.0

    def __post_init__(self) -> None:
        require(
            0 < self.white < np.inf and 1 < self.contrast < np.inf,
            f"screen of {self.white:g} cd/m² and contrast {self.contrast:g};"
            " a positive luminance and a contrast above 1 expected",
        )

    @property
    def black(self) -> float:
        """Smallest luminance of the display [cd/m²]."""
        return self.white / self.contrast


def human_vision(
    picture: Picture,
    *,
    contrast_sensitivity: bool = True,
    colour_loss: bool = True,
    veil: bool = False,
    screen: Screen | None = None,
) -> Float32[np.ndarray, "row column 3"]:
    """Display values, 0…1, that show what an observer would see in the scene.

    In the dark, the contrast sensitivity of the eye is lower and colour vision is lost.
    Without `contrast_sensitivity`, contrast is limited to the contrast in the scene.
    With `veil`, veiling luminance is added around bright sources, which is slow for
    fisheye views. A picture without a view is assumed to be 40° wide.
    """
    screen = screen or Screen()
    seen = with_veil(picture) if veil else picture
    histogram = _histogram(seen)
    values = _with_colour_loss(seen) if colour_loss else seen.rgb
    if histogram is None:
        return np.zeros_like(values)
    luminance = photometric(seen)
    shown = _shown(luminance, histogram, screen, sensitive=contrast_sensitivity)
    # Scale each pixel to its displayed luminance, which preserves colours
    ratio = LUMINOUS_EFFICACY * np.divide(
        shown, luminance, out=np.zeros_like(luminance), where=luminance > _DARKEST
    )
    return np.asarray(values * ratio[..., None].astype(np.float32))


class _Histogram(NamedTuple):
    # Histogram of the logarithm of luminance: weight of each bin, limits of the bins
    # (of equal width), and mean
    weight: Float[np.ndarray, " bins"]
    borders: Float[np.ndarray, " bins+1"]
    mean: float


def _histogram(picture: Picture) -> _Histogram | None:
    pixels = photometric(picture).ravel()
    view = foveal_view(picture)
    columns, rows = min(view.columns, picture.columns), min(view.rows, picture.rows)
    fovea = photometric(reduce(picture, columns=columns, rows=rows)).ravel()
    low, high = min(pixels.min(), fovea.min()), max(pixels.max(), fovea.max())
    high = min(1.01 * float(high), _BRIGHTEST)
    if high <= _DARKEST:
        return None
    top = np.log(high)
    # Add one bin below the darkest luminance
    lit = low >= _DARKEST
    span = top - np.log(low if lit else _DARKEST)
    bottom = top - max(span * _BINS / (_BINS - 1) if lit else span, 1e-9)
    weight, total = np.zeros(_BINS), 0.0
    for samples, share in ((fovea, 1.0), (pixels, fovea.size / pixels.size)):
        inside = samples[(samples > np.exp(bottom)) & (samples < high)].astype(float)
        brightness = np.log(inside)
        place = (_BINS * (brightness - bottom) / (top - bottom)).astype(int)
        weight += share * np.bincount(np.minimum(place, _BINS - 1), minlength=_BINS)
        total += share * float(brightness.sum())
    if weight.sum() == 0:
        return None
    mean = total / weight.sum()
    if lit:
        weight[1] *= 0.5
        weight[0] += weight[1]
    return _Histogram(weight, np.linspace(bottom, top, _BINS + 1), float(mean))


def _shown(
    luminance: Float32[np.ndarray, "row column"],
    histogram: _Histogram,
    screen: Screen,
    *,
    sensitive: bool,
) -> Float[np.ndarray, "row column"]:
    # Displayed value of each luminance, relative to display white
    low, high = np.log(screen.black), np.log(screen.white)
    cumulative = None
    if np.ptp(histogram.borders) > high - low:
        cumulative = _cumulative(histogram, screen, sensitive=sensitive)
    if cumulative is None:
        # The display has the range of the scene: map linearly, mean to mid-luminance
        middle, mean = np.exp((low + high) / 2), np.exp(histogram.mean)
        factor = threshold(middle) / threshold(mean) if sensitive else middle / mean
        return np.asarray(luminance * (factor / screen.white))
    brightness = np.log(np.maximum(luminance, _DARKEST))
    place = np.interp(brightness, histogram.borders, cumulative)
    shown = np.exp(low + place * (high - low)) - screen.black
    return np.where(luminance >= _DARKEST, shown / (screen.white - screen.black), 0)


def _cumulative(
    histogram: _Histogram, screen: Screen, *, sensitive: bool
) -> Float[np.ndarray, " borders"] | None:
    # Cumulative histogram, truncated where the mapping would exaggerate contrast. As
    # truncation changes the mapping, iterate. None if nothing remains to compress
    range_shown = np.log(screen.contrast)
    scene = np.exp((histogram.borders[:-1] + histogram.borders[1:]) / 2)
    step = histogram.borders[1] - histogram.borders[0]
    weight = histogram.weight.copy()
    while True:
        total = weight.sum()
        if total <= histogram.weight.sum() * _TOLERANCE:
            return None
        borders: np.ndarray = np.append(0, np.cumsum(weight)) / total
        place = (borders[:-1] + borders[1:]) / 2
        shown = np.exp(np.log(screen.black) + place * range_shown)
        limit = threshold(shown) / threshold(scene) if sensitive else shown / scene
        # Eq. 7 of the paper: slope that preserves just noticeable differences
        ceiling = total * step * limit * scene / (shown * range_shown)
        cut = np.maximum(weight - ceiling, 0)
        if cut.sum() <= total * _TOLERANCE:
            return borders
        weight -= cut


def threshold(
    luminance: Float[np.ndarray, "*batch"] | float,
) -> Float[np.ndarray, "*batch"]:
    """Just noticeable luminance difference at an adaptation luminance [cd/m²].

    Source: J. Ferwerda, S. Pattanaik, P. Shirley, D. Greenberg, "A model of visual
    adaptation for realistic image synthesis", SIGGRAPH 96; fitted piecewise as in Ward
    Larson et al., table 1.

    >>> round(float(threshold(100.0)), 2)  # a Weber fraction of 1/18
    5.56
    """
    a = np.log10(np.maximum(np.asarray(luminance, dtype=float), 1e-30))
    with np.errstate(invalid="ignore"):
        pieces = [
            np.full_like(a, -2.86),
            np.maximum(0.405 * a + 1.6, 0) ** 2.18 - 2.86,
            a - 0.395,
            np.maximum(0.249 * a + 0.65, 0) ** 2.7 - 0.72,
        ]
    ends = [a < -3.94, a < -1.44, a < -0.0184, a < 1.9]
    return np.asarray(10.0 ** np.select(ends, pieces, a - 1.255))


def _with_colour_loss(picture: Picture) -> Float32[np.ndarray, "row column 3"]:
    luminance = photometric(picture)
    if luminance.min() >= _CONES_ONLY:
        return picture.rgb
    colour = np.clip((luminance - _RODS_ONLY) / (_CONES_ONLY - _RODS_ONLY), 0, 1)
    grey = picture.rgb @ np.array(_SCOTOPIC_WEIGHTS, dtype=np.float32)
    mixed = colour[..., None] * picture.rgb + ((1 - colour) * grey)[..., None]
    return np.asarray(mixed, dtype=np.float32)
