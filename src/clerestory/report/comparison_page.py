"""HTML page that compares simulations with measurements: tables, figures, notes."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure

from clerestory.comparison.comparison_output import (
    comparison_notes,
    shares_table,
    statistics_table,
)
from clerestory.comparison.series import ILLUMINANCE, group_of, quantity_of
from clerestory.comparison.series_comparison import Comparison
from clerestory.escaping import file_stem
from clerestory.files import make_folder, replace_file, write_text
from clerestory.metrics.agreement import LIMITS
from clerestory.report.comparison_plots import (
    days_figure,
    scan_figure,
    scatter_figure,
    time_figure,
)
from clerestory.report.embedded_data import figure_png, image_address
from clerestory.report.markup import Markup, render
from clerestory.report.page_assets import asset, content_policy
from clerestory.report.period import evenly

PAGE_FILE = "comparison.html"
_MOST_SERIES = 9


class Drawing(NamedTuple):
    """Figure of a comparison: file name without extension, caption and PNG data."""

    name: str
    words: str
    png: bytes


def comparison_drawings(
    comparisons: Sequence[Comparison],
    places: dict[str, Float[np.ndarray, " 3"]] | None = None,
) -> list[Drawing]:
    """Return all figures of a comparison, scatter plots first.

    `places` are the positions [m] of the sensors by name, required for maps of grids.
    """
    kinds = dict.fromkeys(kind for c in comparisons for kind in c.table())
    drawings = []
    for quantity in dict.fromkeys(quantity for _, quantity in kinds):
        figure = scatter_figure(comparisons, quantity)
        if figure is not None:
            words = f"Every pair of {quantity}; bands of 10 and 20 %"
            drawings.append(_drawing(f"scatter_{quantity}", words, figure))
    for group, quantity in kinds:
        figure = time_figure(comparisons, group, quantity)
        drawings.append(
            _drawing(f"time_{group}_{quantity}", f"{group} over time", figure)
        )
        if quantity == ILLUMINANCE and places:
            drawings += _maps(comparisons, group, places)
    for name in _shown_series(comparisons):
        figure = days_figure(comparisons, name)
        drawings.append(_drawing(f"days_{name}", f"Days of {name}", figure))
    return drawings


def write_comparison(
    folder: str | Path,
    comparisons: Sequence[Comparison],
    *,
    title: str,
    places: dict[str, Float[np.ndarray, " 3"]] | None = None,
) -> Path:
    """Write the figures and the page into a folder; return the path of the page."""
    folder = make_folder(folder)
    drawings = comparison_drawings(comparisons, places)
    for drawing in drawings:
        with replace_file(folder / f"{drawing.name}.png") as stream:
            stream.write(drawing.png)
    write_text(folder / PAGE_FILE, _page(comparisons, drawings, title))
    return folder / PAGE_FILE


def _maps(
    comparisons: Sequence[Comparison], group: str, places: dict[str, np.ndarray]
) -> list[Drawing]:
    found = []
    for number, comparison in enumerate(comparisons):
        if not all(name in places for name in comparison.pairs.names):
            continue
        figure = scan_figure(comparison, group, places)
        if figure is not None:
            words = f"{group} at some moments: measured, {comparison.name}, deviation"
            found.append(_drawing(f"maps_{group}_{number + 1}", words, figure))
    return found


def _shown_series(comparisons: Sequence[Comparison]) -> list[str]:
    # All series if nine or fewer; otherwise some of each sensor group and quantity
    names = list(dict.fromkeys(name for c in comparisons for name in c.series()))
    if len(names) <= _MOST_SERIES:
        return names
    kinds = dict.fromkeys((group_of(n), quantity_of(n)) for n in names)
    share = max(1, _MOST_SERIES // len(kinds))
    shown = []
    for kind in kinds:
        own = [n for n in names if (group_of(n), quantity_of(n)) == kind]
        shown += [own[i] for i in evenly(len(own), share)]
    return shown[: 2 * _MOST_SERIES]


def _drawing(name: str, words: str, figure: Figure) -> Drawing:
    return Drawing(file_stem(name), words, figure_png(figure, dpi=110))


def _page(
    comparisons: Sequence[Comparison], drawings: Sequence[Drawing], title: str
) -> str:
    return render(
        "comparison.html",
        policy=content_policy(""),
        title=title,
        style=Markup(asset("style.css")),
        limits=", ".join(f"{100 * limit:g}" for limit in LIMITS),
        shares=shares_table(comparisons),
        comparisons=[(each.name, comparison_notes(each)) for each in comparisons],
        drawings=[
            {"name": d.name, "words": d.words, "address": image_address(d.png)}
            for d in drawings
        ],
        statistics=statistics_table(comparisons),
    )
