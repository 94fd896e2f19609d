"""Predicted glare sensation vote (PGSV) of a window."""

import math

from clerestory.checks import require


def contrast_pgsv(*, window: float, window_solid_angle: float, average: float) -> float:
    """PGSV due to the contrast between a window and its surround.

    `window` is the mean luminance of the window, `average` that of the field of view of
    2π sr [cd/m²].

    Reference: Tokura, M., Iwata, T. and Shukuya, M. (1996): Experimental study on
    discomfort glare caused by windows. Journal of Architecture, Planning and
    Environmental Engineering 489. Iwata, T. and Tokura, M. (1998): Examination of the
    limitations of predicted glare sensation vote (PGSV). Lighting Research and
    Technology 30(2).

    >>> round(contrast_pgsv(window=3e3, window_solid_angle=0.5, average=600), 2)
    0.92
    """
    rest = surround_luminance(
        window=window, window_solid_angle=window_solid_angle, average=average
    )
    size = math.log10(window_solid_angle)
    return (
        3.2 * math.log10(window)
        - 0.64 * size
        + (0.79 * size - 0.61) * math.log10(rest)
        - 8.2
    )


def surround_luminance(
    *, window: float, window_solid_angle: float, average: float
) -> float:
    """Mean luminance of the field of view outside of a window [cd/m²]."""
    sphere = 2 * math.pi
    total = sphere * average
    rest = (total - window * window_solid_angle) / (sphere - window_solid_angle)
    require(
        rest > 0,
        f"the window of {window:g} cd/m² accounts for all light in the field of view;"
        f" a window luminance below {total / window_solid_angle:g} cd/m² expected",
    )
    return rest


def saturation_pgsv(illuminance: float) -> float:
    """PGSV due to saturation, from the vertical illuminance at the eye [lux].

    The formula applies to windows that fill the field of view.

    >>> round(saturation_pgsv(5000.0), 2)
    1.76
    """
    return 3.3 - 3.87 / (1 + math.pow(illuminance / math.pi / 1250, 1.7))


def pgsv(
    *,
    window: float,
    window_solid_angle: float,
    average: float,
    illuminance: float,
    task: float,
) -> float:
    """PGSV due to contrast or due to saturation.

    The contrast formula applies if the ratio of window to surround luminance exceeds
    the ratio of mean luminance Ev/π to the luminance of the task [cd/m²].

    >>> window = {"window": 3000.0, "window_solid_angle": 0.5, "average": 600.0}
    >>> round(pgsv(**window, illuminance=1900.0, task=200.0), 2)
    0.92
    """
    seen = {"window": window, "window_solid_angle": window_solid_angle}
    rest = surround_luminance(**seen, average=average)
    if window / rest > illuminance / (math.pi * task):
        return contrast_pgsv(**seen, average=average)
    return saturation_pgsv(illuminance)
