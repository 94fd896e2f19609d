"""Uncertainty of the results: standard errors of all hourly illuminances."""

from itertools import pairwise

import numpy as np
from jaxtyping import Float

from clerestory.report.content import ReportContent
from clerestory.report.markup import Markup, drawing, element

# Illuminance above which relative errors are evaluated [lux]
LIT_LUX = 10.0
_BANDS = (10.0, 100.0, 300.0, 1000.0, 3000.0, np.inf)
_WIDTH, _HEIGHT, _LEFT, _FOOT = 480, 150, 40, 42
_BARS = 32


def error_words(content: ReportContent) -> str:
    """Return a sentence on the relative standard errors of hourly illuminance."""
    errors = _relative_errors(content)
    if not errors.size:
        return f"No sensor receives more than {LIT_LUX:.0f} lux in any time step."
    if not errors.any():
        return "The results have no statistical error: nothing in them was sampled."
    middle, most = (f"{float(np.quantile(errors, q)):.2g}" for q in (0.5, 0.95))
    return (
        "The illuminance of every hour has a standard error: half of them are below"
        f" {middle} %, 95 % below {most} %."
    )


def error_histogram(content: ReportContent) -> Markup:
    """Return the distribution of the relative standard errors as a bar chart."""
    errors = _relative_errors(content)
    if not errors.size or not errors.any():
        return element("p", error_words(content), class_="note")
    high = 1.25 * float(np.quantile(errors, 0.99))
    share, _ = np.histogram(np.minimum(errors, high), bins=_BARS, range=(0, high))
    share = 100 * share / errors.size
    label = f"Distribution of the relative standard errors. {error_words(content)}"
    width = _WIDTH / _BARS
    bars = [
        element(
            "rect",
            x=f"{_LEFT + k * width + 0.5:.1f}",
            y=f"{10 + _HEIGHT * (1 - s / share.max()):.1f}",
            width=f"{width - 1:.1f}",
            height=f"{_HEIGHT * s / share.max():.1f}",
        )
        for k, s in enumerate(share.tolist())
    ]
    median = _LEFT + _WIDTH * min(float(np.median(errors)) / high, 1)
    return drawing(
        label,
        element("g", *bars, class_="bars"),
        element("path", d=f"M{_LEFT},{10 + _HEIGHT}h{_WIDTH}", class_="base"),
        *_ticks(high),
        element("path", d=f"M{median:.1f},4v{_HEIGHT + 6}", class_="median"),
        element("text", "median", x=f"{median + 5:.1f}", y=14, class_="start"),
        element(
            "text",
            f"relative standard error of the hours above {LIT_LUX:.0f} lux [%];"
            " the last bar holds all beyond",
            x=_LEFT + _WIDTH / 2,
            y=_HEIGHT + _FOOT,
        ),
        width=_LEFT + _WIDTH + 20,
        height=_HEIGHT + _FOOT + 8,
        class_="histogram",
    )


def error_rows(content: ReportContent) -> list[tuple[str, list[str]]]:
    """Return number, median and 95th percentile of errors by range of illuminance."""
    rows = []
    for low, high in pairwise(_BANDS):
        relative = _relative_errors(content, low, high)
        if relative.size:
            known = np.isfinite(high)
            name = f"{low:,.0f}–{high:,.0f}" if known else f"over {low:,.0f}"
            shares = [f"{float(np.quantile(relative, q)):.2g} %" for q in (0.5, 0.95)]
            rows.append((f"{name} lux", [f"{relative.size:,}", *shares]))
    return rows


def _relative_errors(
    content: ReportContent, low: float = LIT_LUX, high: float = np.inf
) -> Float[np.ndarray, " value"]:
    # Relative standard errors [%] of illuminances above `low`, up to `high` [lux]
    lux = content.illuminance
    within = (lux > low) & (lux <= high)
    return np.asarray(100 * content.standard_error[within] / lux[within])


def _ticks(high: float) -> list[Markup]:
    step = 10.0 ** np.floor(np.log10(high))
    step *= next(m for m in (0.1, 0.2, 0.5, 1, 2, 5) if high / (m * step) <= 7)
    return [
        element(
            "text", f"{x:.3g}", x=f"{_LEFT + _WIDTH * x / high:.1f}", y=_HEIGHT + 26
        )
        for x in np.arange(0, high, step).tolist()
    ]
