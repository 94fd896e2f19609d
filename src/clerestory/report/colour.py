"""Colour scales of report drawings, with perceptually uniform palettes."""

import math

import numpy as np
from jaxtyping import Float, UInt8

from clerestory.image.colour_scale import ColourScale
from clerestory.report.embedded_data import png
from clerestory.report.markup import Markup, element

# Ratio of largest to smallest value above which only powers of ten are labelled
_WIDE = 2000


def percent_scale() -> ColourScale:
    """Return the scale of percentages from 0 to 100."""
    levels = (0.0, 20.0, 40.0, 60.0, 80.0, 100.0)
    return ColourScale(
        0, 100, levels, "%", palette="viridis", ends=(0.04, 0.98), steps=128
    )


def logarithmic_scale(low: float, high: float, unit: str) -> ColourScale:
    """Return a logarithmic scale with labels at 1 and 3 times powers of ten."""
    decades = 10.0 ** np.arange(math.floor(math.log10(low)), 7)
    levels = np.outer(decades, (1,) if high / low > _WIDE else (1, 3)).ravel()
    levels = levels[(levels >= low * (1 - 1e-9)) & (levels <= high * (1 + 1e-9))]
    return ColourScale(
        low, high, tuple(levels.tolist()), unit, True, "inferno", (0.04, 0.98), 128
    )


def illuminance_scale(
    illuminance: Float[np.ndarray, "*batch"], *, low: float | None = None
) -> ColourScale:
    """Return a logarithmic scale up to the 99.5th percentile of the illuminance.

    The scale starts at `low` [lux], by default at a round value below the minimum, but
    not below 10 lux. The scale spans at least one decade.

    Examples
    --------
    >>> scale = illuminance_scale(np.array([120.0, 480.0, 5200.0]))
    >>> scale.smallest, scale.largest, scale.levels
    (100.0, 10000.0, (100.0, 300.0, 1000.0, 3000.0, 10000.0))
    """
    steps = [float(m * 10**decade) for decade in range(1, 6) for m in (1, 3)]
    if low is None:
        low = max([x for x in steps if x <= illuminance.min()], default=steps[0])
    top = max(float(np.quantile(illuminance, 0.995)), 10 * low)
    high = next((x for x in steps if x >= top), max(steps[-1], 10 * low))
    return logarithmic_scale(low, high, "lux")


def value_colours(
    scale: ColourScale, values: Float[np.ndarray, "*batch"]
) -> UInt8[np.ndarray, "*batch 3"]:
    """Colour (sRGB) of each value on a scale."""
    return scale.colours(scale.place(values))


def hexadecimal(colours: UInt8[np.ndarray, "colour 3"]) -> list[str]:
    """Return sRGB colours as text `#rrggbb`."""
    return ["#{:02x}{:02x}{:02x}".format(*rgb) for rgb in colours.tolist()]


def colour_bar(scale: ColourScale) -> Markup:
    """Return the colour bar of a scale, with labels and unit, as an SVG element."""
    places = scale.place(np.array(scale.levels)).tolist()
    bar = element(
        "image",
        href=png(scale.table()[None]),
        x=20,
        y=2,
        width=280,
        height=8,
        preserveAspectRatio="none",
    )
    return element(
        "svg",
        bar,
        *(
            element("text", f"{level:,.0f}", x=f"{20 + 280 * place:.1f}", y=25)
            for level, place in zip(scale.levels, places, strict=True)
        ),
        element("text", scale.unit, x=304, y=11, class_="unit"),
        viewBox="0 0 340 30",
        class_="legend",
        aria_hidden="true",
    )
