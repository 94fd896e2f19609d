"""HTML page that compares the variants of a study, or several finished runs.

Tables of the figures of merit with the differences from the first run, a plot of light
against glare and lighting energy, and plans of all runs on one colour scale.
"""

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import numpy as np

import clerestory
from clerestory.files import write_text
from clerestory.report.colour import (
    colour_bar,
    hexadecimal,
    percent_scale,
    value_colours,
)
from clerestory.report.compliance_words import verdict_words
from clerestory.report.embedded_data import image_address
from clerestory.report.markdown import markdown
from clerestory.report.markup import Markup, drawing, element, render
from clerestory.report.page_assets import asset, content_policy
from clerestory.report.pareto_plot import Objectives, objectives, pareto_plot
from clerestory.report.uncertain_value import Figure
from clerestory.scene.sensor_cells import sensor_cells
from clerestory.study.title_block import TitleBlock
from clerestory.study.variant_figures import (
    RunFigures,
    VariantFigure,
    common_keys,
    figure_rows,
)

VARIANTS_FILE = "report.html"

# Largest number of cells in all plans together
_MOST_CELLS = 40_000

# Width of a plan in drawing units
_WIDTH = 200.0

# Multiple of the standard error from which a difference is significant
_SIGNIFICANT = 2.0


class Cell(NamedTuple):
    """Value of a figure, its difference from the first run, and their tooltip."""

    value: str
    difference: str
    doubtful: bool


class FigureTable(NamedTuple):
    """Table of some figures of all runs, a row per run."""

    title: str
    heads: list[tuple[str, str]]
    rows: list[list[Cell]]


class Plans(NamedTuple):
    """Plans of one grid in all runs: name of each run, mean, and SVG."""

    grid: str
    plans: list[tuple[str, str, Markup]]


def write_variants_page(
    path: str | Path,
    runs: Sequence[RunFigures],
    *,
    title: str,
    title_block: TitleBlock | None = None,
    goals: Objectives | None = None,
) -> None:
    """Write the page that compares several runs; see `variants_page`."""
    page = variants_page(runs, title=title, title_block=title_block, goals=goals)
    write_text(path, page)


def variants_page(
    runs: Sequence[RunFigures],
    *,
    title: str,
    title_block: TitleBlock | None = None,
    goals: Objectives | None = None,
) -> str:
    """Return the page that compares several runs, as HTML.

    `goals` are plotted against each other; by default light against glare and energy.
    """
    shown, block = goals or objectives(runs), title_block or TitleBlock()
    return render(
        "variants.html",
        version=clerestory.__version__,
        policy=content_policy(""),
        title=title,
        block=block,
        logo=image_address(block.logo) if block.logo else "",
        notes=markdown(block.notes) if block.notes.strip() else "",
        style=Markup(asset("style.css")),
        runs=[(run.name, run.settings) for run in runs],
        axes=list(dict.fromkeys(axis for run in runs for axis in run.settings)),
        standards=verdict_table(runs),
        tables=figure_tables(runs),
        pareto=pareto_plot(runs, shown) if shown else "",
        efficient=shown.efficient().tolist() if shown else [False] * len(runs),
        with_glare=bool(shown and shown.across[0].aspect == "glare"),
        with_goals=goals is not None,
        plans=grid_plans(runs),
        scale=colour_bar(percent_scale()),
    )


def verdict_table(
    runs: Sequence[RunFigures],
) -> tuple[list[tuple[str, str]], list[list[str]]]:
    """Return standards and criteria, and the verdicts of each run on all its spaces."""
    heads = list(dict.fromkeys(key for run in runs for key in run.verdicts))
    words = [
        [
            verdict_words(run.verdicts[key]) if key in run.verdicts else ""
            for key in heads
        ]
        for run in runs
    ]
    return heads, words


def figure_tables(runs: Sequence[RunFigures]) -> list[FigureTable]:
    """Return a table for each grid, and one for glare and one for lighting energy."""
    columns = [(key, figure_rows(runs, key)) for key in common_keys(runs)]
    found = []
    for title, group in groupby(columns, lambda column: _table_title(column[1][0][0])):
        own = list(group)
        single = title not in ("Glare", "Energy")
        heads = [
            (name, row[0][0].unit if single else f"{place}, {row[0][0].unit}")
            for (name, place), row in own
        ]
        cells = [[_cell(row[number]) for _, row in own] for number in range(len(runs))]
        found.append(FigureTable(title, heads, cells))
    return found


def _table_title(figure: VariantFigure) -> str:
    if figure.aspect == "glare":
        return "Glare"
    if figure.aspect == "sun":
        return f"{figure.place}: direct sun"
    return "Energy" if figure.aspect == "energy" else figure.place


def _cell(pair: tuple[VariantFigure, VariantFigure]) -> Cell:
    own, change = (_plain(figure) for figure in pair)
    sign = "+" if pair[1].value > 0 else ""
    doubtful = abs(pair[1].value) < _SIGNIFICANT * pair[1].error
    return Cell(own, sign + change.replace("-", "−"), doubtful)


def _plain(figure: VariantFigure) -> str:
    return str(Figure(figure.value, figure.error, "%")).removesuffix(" %")


def grid_plans(runs: Sequence[RunFigures]) -> list[Plans]:
    """Return plans of the daylight autonomy of each grid that every run has."""
    cells = sum(run.sensors.sizes.get("sensor", 0) for run in runs)
    if not cells or cells > _MOST_CELLS:
        return []
    names = [dict.fromkeys(run.sensors["grid"].values.tolist()) for run in runs]
    common = [grid for grid in names[0] if all(grid in other for other in names)]
    found = []
    for grid in common:
        plans = [(run.name, *_plan(run, grid)) for run in runs]
        if all(plan for _, _, plan in plans):
            found.append(Plans(str(grid), plans))
    return found


def _plan(run: RunFigures, grid: str) -> tuple[str, Markup]:
    # Mean, and cells of the sensors that face up; nothing for other grids
    data = run.sensors
    members = np.flatnonzero(data["grid"].values == grid)
    part = data.isel(sensor=members)
    if (np.abs(part["direction"].values[:, 2]) < 0.9).any():
        return "", Markup("")
    share = 100 * part["daylight_autonomy"].values
    corners = sensor_cells(part["position"].values[:, :2])
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    scale = _WIDTH / max(float(high[0] - low[0]), 1e-6)
    flipped = np.stack([corners[..., 0] - low[0], high[1] - corners[..., 1]], axis=-1)
    cells = [
        element("path", d=_outline(scale * own), fill=colour, stroke=colour)
        for own, colour in zip(
            flipped, hexadecimal(value_colours(percent_scale(), share)), strict=True
        )
    ]
    mean = f"{share.mean():.1f} %"
    plan = drawing(
        f"{run.name}: {mean}",
        *cells,
        width=_WIDTH,
        height=scale * float(high[1] - low[1]),
        class_="plan",
    )
    return mean, plan


def _outline(corners: np.ndarray) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in corners) + "Z"
