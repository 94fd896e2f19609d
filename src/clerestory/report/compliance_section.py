"""Sections of a report on compliance: one for each standard, and their summary."""

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Int

from clerestory.metrics.compliance import Assessment
from clerestory.metrics.standards import STANDARDS
from clerestory.report.colour import colour_bar
from clerestory.report.compliance_maps import compliance_maps, map_keys, map_scale
from clerestory.report.compliance_words import (
    grouped_requirements,
    quantity_words,
    verdict_words,
)
from clerestory.report.content import ReportContent
from clerestory.report.floor_plan import plan, plan_frame
from clerestory.report.markup import Markup, render
from clerestory.report.section import Section
from clerestory.study.compliance_table import assessments_of


class StandardSection(NamedTuple):
    """Section on one standard, with its HTML identifier and title in the contents."""

    identifier: str
    title: str
    section: Section


def compliance_sections(content: ReportContent) -> list[StandardSection]:
    """Return a section for each assessed standard; empty without [compliance]."""
    found = assessments_of(content.data)
    drawn: dict[str, str] = {}
    return [
        StandardSection(
            _identifier(name),
            name,
            Section(_body(content, [a for a in found if a.standard == name], drawn)),
        )
        for name in dict.fromkeys(one.standard for one in found)
    ]


def verdict_rows(content: ReportContent) -> list[tuple[str, str, list[str]]]:
    """Return address, standard, and criterion with verdict, of all spaces together."""
    rows: dict[str, Assessment] = {}
    for one in assessments_of(content.data):
        rows[one.standard] = one  # all spaces together come last
    return [
        (
            f"#{_identifier(name)}",
            name,
            [f"{v.criterion}: {verdict_words(v)}" for v in one.verdicts],
        )
        for name, one in rows.items()
    ]


def _identifier(name: str) -> str:
    return "standard-" + re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def _body(
    content: ReportContent, found: Sequence[Assessment], drawn: dict[str, str]
) -> Markup:
    # Body of one section; `drawn` is the standard whose section shows each map
    name = found[0].standard
    known = STANDARDS.get(name)
    lines = [
        (line, ", ".join(spaces) if len(spaces) < _spaces(found) else "all spaces")
        for line, spaces in grouped_requirements(found)
    ]
    counts = {
        status: sum(line.status == status for line, _ in lines)
        for status in ("not fulfilled", "not known", "fulfilled")
    }
    return render(
        "compliance.html",
        identifier=_identifier(name),
        title=known.title if known else name,
        criteria=[_criterion(found, k) for k in range(len(found[0].verdicts))],
        plans=_plans(content, name, drawn),
        elsewhere=_elsewhere(content, name, drawn),
        lines=lines,
        counts=counts,
    )


def _spaces(found: Sequence[Assessment]) -> int:
    return sum(bool(one.requirements) for one in found)


def _criterion(found: Sequence[Assessment], number: int) -> dict[str, object]:
    # Verdict of the last assessment, of all spaces, and a row for each
    last = found[-1].verdicts[number]
    heads = next(
        (v.quantities for v in (a.verdicts[number] for a in found) if v.quantities), ()
    )
    rows = []
    for one in found:
        verdict = one.verdicts[number]
        cells = {q.name: quantity_words(q) for q in verdict.quantities}
        shown = [cells.get(q.name, "") for q in heads]
        rows.append((one.space, [f"{one.area:.1f}", *shown, verdict_words(verdict)]))
    titles = [f"{q.name} ({q.limits})" if q.limits else q.name for q in heads]
    return {
        "name": last.criterion,
        "words": verdict_words(last),
        "head": ["Space", "Floor area [m²]", *titles, "Verdict"],
        "rows": rows,
    }


def _elsewhere(
    content: ReportContent, name: str, drawn: dict[str, str]
) -> list[tuple[str, str, list[str]]]:
    # Address and standard of the sections that show maps of a standard, and the maps
    maps, found = compliance_maps(content), dict[str, list[str]]()
    for key in map_keys(name):
        if drawn.get(key, name) != name:
            found.setdefault(drawn[key], []).append(maps[key].title)
    return [(_identifier(other), other, titles) for other, titles in found.items()]


def _plans(
    content: ReportContent, name: str, drawn: dict[str, str]
) -> list[dict[str, object]]:
    # Plans of the maps of a standard for each grid, unless an earlier section has them;
    # walls are those of the first plans
    maps = compliance_maps(content)
    for key in map_keys(name):
        if key in maps:
            drawn.setdefault(key, name)
    shown = [maps[key] for key in map_keys(name) if drawn.get(key) == name]
    grids: list[dict[str, object]] = []
    for number, (grid, members) in enumerate(content.sensors.by_grid().items()):
        frame = plan_frame(content, members, identifier=f"plan-{number}")
        if not frame.level:
            continue
        figures = []
        for metric in shown:
            scale = map_scale(metric)
            label = f"Plan of {grid}: {metric.title}, {metric.note}"
            figure = plan(
                frame, metric, members, scale=scale, content=content, label=label
            )
            words = {"title": metric.title, "note": metric.note}
            figures.append({**words, "drawing": figure, "bar": colour_bar(scale)})
        grids.append({"name": _grid_words(content, grid, members), "plans": figures})
    return grids if shown else []


def _grid_words(
    content: ReportContent, grid: str, members: Int[np.ndarray, " member"]
) -> str:
    # Name of a grid, after that of its space
    spaces = set(content.data["space"].values[members].tolist())
    return " · ".join(dict.fromkeys([*(spaces if len(spaces) == 1 else ()), grid]))
