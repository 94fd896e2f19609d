"""Drawings of the total uncertainty: ranges of the figures, and their causes."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from clerestory.report.markup import Markup, drawing, element

_WIDTH, _LEFT, _ROW = 960.0, 250.0, 30.0


def intervals(data: xr.Dataset) -> Markup:
    """Return the ranges of 90 and 50 % of the draws of each figure in %."""
    chosen = [
        k
        for k in range(data.sizes["known_figure"])
        if str(data["known_figure_unit"].values[k]) == "%"
    ]
    marks, high = [], 24.0 + _ROW * len(chosen)
    for share in range(0, 101, 20):
        x = _across(share)
        line = f"M{x:.1f},18V{high:.0f}"
        marks.append(element("path", d=line, stroke="#d9dde2"))
        marks.append(element("text", f"{share} %", x=x, y=12, text_anchor="middle"))
    words = []
    for row, k in enumerate(chosen):
        draws = data["known_figure_draws"].values[k]
        ends = np.quantile(draws, [0.05, 0.25, 0.75, 0.95]).tolist()
        value = float(data["known_figure_value"].values[k])
        y = 24 + _ROW * (row + 0.5)
        name = f"{data['known_figure_name'].values[k]}"
        place = f"{data['known_figure_place'].values[k]}"
        marks += [
            *_label(name, place, y),
            _bar(ends[0], ends[3], y, 3, "#7d9db9"),
            _bar(ends[1], ends[2], y, 11, "#7d9db9"),
            element("circle", cx=f"{_across(value):.1f}", cy=y, r=4.5, fill="#b3261e"),
        ]
        words.append(
            f"{name} of {place}: {value:.1f} %, {ends[0]:.1f} to {ends[3]:.1f}"
        )
    label = "Ranges of the figures. " + "; ".join(words)
    return drawing(label, *marks, width=_WIDTH, height=high + 6)


def _label(name: str, place: str, y: float) -> list[Markup]:
    return [
        element("text", _short(name), x=0, y=f"{y - 1:.0f}"),
        element("text", _short(place), x=0, y=f"{y + 11:.0f}", fill="#8a939d"),
    ]


def _short(words: str, most: int = 42) -> str:
    return words if len(words) <= most else f"{words[: most - 1]}…"


def _across(share: float) -> float:
    return _LEFT + (_WIDTH - _LEFT - 18) * min(max(share, 0), 100) / 100


def _bar(low: float, high: float, y: float, tall: float, colour: str) -> Markup:
    x = _across(low)
    width = max(_across(high) - x, 1.0)
    place = {"x": f"{x:.1f}", "y": f"{y - tall / 2:.1f}"}
    return element("rect", width=f"{width:.1f}", height=tall, fill=colour, **place)


def shares(data: xr.Dataset, names: Sequence[str], colours: Sequence[str]) -> Markup:
    """Return stacked bars of the shares of the variance, for each figure."""
    marks, words = [], []
    count = data.sizes["known_figure"]
    for k in range(count):
        y = _ROW * (k + 0.5) + 4
        shown = np.clip(data["total_index"].values[k], 0, None)
        whole = shown.sum()
        label = str(data["known_figure_name"].values[k])
        marks += _label(label, str(data["known_figure_place"].values[k]), y)
        at = 0.0
        for name, colour, share in zip(names, colours, shown.tolist(), strict=True):
            if whole <= 0 or share <= 0:
                continue
            part = 100 * share / whole
            own = _bar(at, at + part, y, 16, colour)
            marks.append(
                element("g", element("title", f"{name}: {100 * share:.0f} %"), own)
            )
            at += part
        told = zip(names, shown.tolist(), strict=True)
        words.append(
            f"{label}: " + ", ".join(f"{name} {100 * x:.0f} %" for name, x in told)
        )
    text = "Causes of the uncertainty. " + "; ".join(words)
    return drawing(text, *marks, width=_WIDTH, height=_ROW * count + 8)
