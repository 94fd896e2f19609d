"""Head of the report: title, key figures with uncertainty, and warnings."""

import numpy as np
from jaxtyping import Int

from clerestory.glare.comfort_classes import glare_autonomy
from clerestory.metrics.climate_based_metrics import USEFUL_LIMITS_LUX
from clerestory.report.compliance_section import verdict_rows
from clerestory.report.content import ReportContent
from clerestory.report.embedded_data import image_address
from clerestory.report.knowledge_section import knowledge_error
from clerestory.report.markup import Markup, render
from clerestory.report.metric_maps import MetricMap, metric_maps, useful_share
from clerestory.report.orientation import orientation
from clerestory.report.period import period_words
from clerestory.report.uncertain_value import Figure
from clerestory.report.uncertainty import error_words
from clerestory.report.view_glare import view_glare

Members = Int[np.ndarray, " member"]

_TITLES = ("Mean illuminance", "Daylight autonomy", "Useful illuminance", "Too bright")
_METHODS = {
    "2-phase": "Two-phase method: daylight coefficients",
    "3-phase": "Three-phase method: view, transmission, daylight and sky matrices",
    "4-phase": "Four-phase method: with façade matrices of the exterior shades",
    "5-phase": "Five-phase method: the direct sun at its true position",
    "6-phase": "Six-phase method: façade matrices, the direct sun at its true position",
}


def headline(content: ReportContent) -> Markup:
    """Return the title, the key figures of the first grid, and their uncertainty."""
    maps = {metric.key: metric for metric in metric_maps(content.metrics)}
    block = content.title_block
    return render(
        "headline.html",
        title=content.title,
        block=block,
        logo=image_address(block.logo) if block.logo else "",
        method=_METHODS.get(content.method, content.method),
        places=" · ".join(filter(None, (content.place, period_words(content.times)))),
        lead=_lead(content, maps),
        warnings=_warnings(content),
        selection=content.selection,
        figures=_key_figures(content, maps),
        errors=error_words(content),
        titles=_TITLES,
        standards=verdict_rows(content),
        grids=[
            (name, (f"{len(members):,}", *_grid_figures(content, maps, members)))
            for name, members in content.sensors.by_grid().items()
        ],
    )


def _lead(content: ReportContent, maps: dict[str, MetricMap]) -> str:
    # The result of the first grid in one or two sentences
    grid, members = next(iter(content.sensors.by_grid().items()))
    who = f"the {len(members):,} sensors of “{grid}” receive"
    if len(members) == 1:
        who = f"the sensor “{content.sensors.names[members[0]]}” receives"
    schedule = content.schedule[:1].upper() + content.schedule[1:]
    return (
        f"{schedule}, {who} {maps['mean'].mean(members)} on average."
        f" Daylight alone gives {target_words(content)} or more in"
        f" {maps['autonomy'].mean(members)} of these"
        f" {content.grid.hours(content.occupied):,.0f} hours."
        f"{_glare_words(content)}"
    )


def _glare_words(content: ReportContent) -> str:
    # Sentence on the view in which glare is most often disturbing
    views, use = view_glare(content.data), content.occupied
    if not views:
        return ""
    worst = min(views, key=lambda view: glare_autonomy(view.rated()[use]))
    share = 100 * (1 - float(glare_autonomy(worst.rated()[use])))
    alone = len(views) == 1
    where = f"At “{worst.view}”" if alone else f"In the worst view, “{worst.view}”,"
    return f" {where} glare is disturbing in {share:.1f} % of them."


def target_words(content: ReportContent) -> str:
    """Return the target illuminance of daylight autonomy, such as "300 lux"."""
    return f"{float(content.metrics.attrs.get('target_lux', 300)):,.0f} lux"


def _warnings(content: ReportContent) -> list[str]:
    # Wrong window orientations, then warnings of the run
    problems = [
        f"Window “{row.window}”: {row.problem}"
        for row in (orientation(window, content) for window in content.windows)
        if row.problem
    ]
    return [*problems, *dict.fromkeys(content.warnings)]


def _grid_figures(
    content: ReportContent, maps: dict[str, MetricMap], members: Members
) -> list[Figure]:
    # Mean of each metric over a grid, in the order of `_TITLES`
    mean, autonomy, exceeded = (
        maps[key].mean(members) for key in ("mean", "autonomy", "exceeded")
    )
    return [mean, autonomy, useful_share(content.metrics, members), exceeded]


def _key_figures(
    content: ReportContent, maps: dict[str, MetricMap]
) -> list[tuple[str, str, str, str, str]]:
    # For each key figure of the first grid: title, value, unit with error of the
    # simulation, note, error of what is not known
    members = next(iter(content.sensors.by_grid().values()))
    low, _, high = (f"{limit:,.0f}" for limit in USEFUL_LIMITS_LUX)
    notes = (
        maps["mean"].note,
        maps["autonomy"].note,
        f"hours from {low} to {high} lux",
        f"hours with {high} lux or more",
    )
    words = [
        str(figure).partition(" ") for figure in _grid_figures(content, maps, members)
    ]
    known = [knowledge_error(content.data, k) for k in range(len(_TITLES))]
    return [
        (title, value, unit, note, more)
        for title, (value, _, unit), note, more in zip(
            _TITLES, words, notes, known, strict=True
        )
    ]
