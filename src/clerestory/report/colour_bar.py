"""Colour bar of a false-colour drawing, with ticks and unit."""

import numpy as np

from clerestory.report.colour import ColourScale
from clerestory.report.embedded_data import png
from clerestory.report.markup import Markup, element


def colour_bar(scale: ColourScale) -> Markup:
    """Return the colour bar of a scale as an SVG element."""
    table = scale.table()[None]
    opaque = np.full((*table.shape[:2], 1), 255, dtype=np.uint8)
    ticks = [
        element("text", f"{tick:,.0f}", x=f"{20 + 280 * float(x):.1f}", y=25)
        for tick, x in zip(
            scale.ticks(), scale.fraction(np.array(scale.ticks())), strict=True
        )
    ]
    bar = element(
        "image",
        href=png(np.concatenate([table, opaque], axis=2)),
        x=20,
        y=2,
        width=280,
        height=8,
        preserveAspectRatio="none",
    )
    sign = element("text", scale.unit, x=304, y=11, class_="unit")
    return element(
        "svg",
        bar,
        *ticks,
        sign,
        viewBox="0 0 340 30",
        class_="legend",
        aria_hidden="true",
    )
