"""Report section on view grids: plans, a year of DGP, and the highest DGP."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from jaxtyping import Float, Int, UInt8

from clerestory.glare.comfort_classes import LIMITS
from clerestory.glare.view_grid_metrics import disturbed_positions, disturbed_views
from clerestory.image.colour_scale import ColourScale
from clerestory.report.class_map import DayMap, keys
from clerestory.report.colour import colour_bar, value_colours
from clerestory.report.content import ReportContent
from clerestory.report.embedded_data import packed
from clerestory.report.floor_plan import walls_definition
from clerestory.report.markup import Markup, render
from clerestory.report.period import moment_words
from clerestory.report.picture_strip import picture_figures
from clerestory.report.rosette_plan import Rosettes, rosette_plan, rosettes
from clerestory.report.section import Section
from clerestory.report.view_glare import COLOURS, class_words, dgp_steps, shades
from clerestory.report.view_grid_content import (
    GridYear,
    direction_words,
    grid_years,
    percent,
    uncertain_dgp,
)
from clerestory.report.view_pictures import Moment, ViewPictures
from clerestory.report.window_states import table_name
from clerestory.study.view_grid_results import picture_stems

# Levels of the scale of shares, the highest of which is above most values [%]
_SCALES = ((0.0, 1.0, 2.0, 5.0), (0.0, 5.0, 10.0, 20.0), (0.0, 10.0, 25.0, 50.0))
_WHOLE = (0.0, 20.0, 40.0, 60.0, 80.0, 100.0)


def view_grids_section(content: ReportContent) -> Section:
    """Return the annual glare of each view grid; empty without view grids."""
    years = grid_years(content.data)
    if not years:
        return Section()
    shown = [_grid(content, year, number) for number, year in enumerate(years)]
    body = render(
        "view_grids.html",
        grids=[words for words, _ in shown],
        classes=keys(class_words(), COLOURS),
        limits=[f"{limit:.2f}" for limit in LIMITS],
    )
    data = {
        "grids": [data for _, data in shown],
        "colours": shades(np.arange(101) / 100).tolist(),
    }
    return Section(body, {"rosettes": data})


def _grid(
    content: ReportContent, year: GridYear, number: int
) -> tuple[dict[str, Any], dict[str, Any]]:
    # What the template and what the scripts show of a view grid
    name = f"view-grid-{number}"
    heights = np.round(year.position[:, 2], 3)
    levels, plans = [], []
    for level, height in enumerate(np.unique(heights).tolist()):
        members = np.flatnonzero(heights == height)
        places, plan = year.position[members], f"{name}-plan-{level}"
        drawn = rosettes(content, places, year.azimuth, identifier=plan)
        levels.append(drawn.data() | {"members": members.tolist(), "plan": plan})
        plans += _plans(content, year, drawn, members)
    drawing, cells = _year(content, year, identifier=f"{name}-year")
    words = _words(content, year) | {
        "identifier": name,
        "plans": plans,
        "map": drawing,
        "shares": _share_rows(year),
        "states": _state_rows(content, year),
    }
    count, directions = year.shape
    data = {
        "identifier": name,
        "levels": levels,
        "worst": year.worst,
        "directions": directions,
        "codes": packed(cells),
        "texts": [year.words(k, m) for k in range(count) for m in range(directions)],
    }
    return words, data


def _words(content: ReportContent, year: GridYear) -> dict[str, Any]:
    # Names and sentences of a view grid
    at, towards = year.worst
    looks = [direction_words(x, north=content.north) for x in year.azimuth.tolist()]
    place = year.place_words(at)
    return {
        "name": year.name,
        "count": f"{year.total:,} positions × {len(looks)} directions",
        "left_out": year.total - len(year.number),
        "text": _grid_words(year),
        "positions": [year.place_words(k) for k in range(len(year.number))],
        "directions": looks,
        "chosen": (at, towards),
        "view": f"Position {place}, {looks[towards]}: {year.words(at, towards)}",
        "worst": _worst_moment(content, year),
    }


def _year(
    content: ReportContent, year: GridYear, *, identifier: str
) -> tuple[Markup, UInt8[np.ndarray, "view cell"]]:
    # Annual map of the worst view, and the cells of the maps of all views
    level = np.arange(101) / 100
    texts = tuple(f"DGP {x:.2f}" for x in level)
    maps = [
        DayMap(
            identifier, "Glare by day and hour", dgp_steps(dgp), texts, shades(level)
        )
        for dgp in year.dgp.reshape(-1, year.dgp.shape[-1])
    ]
    worst = maps[year.worst[0] * year.shape[1] + year.worst[1]]
    drawing = worst.drawing(content.grid, occupied=content.occupied)
    return drawing, np.stack([one.cells(content.grid) for one in maps])


def _plans(
    content: ReportContent,
    year: GridYear,
    drawn: Rosettes,
    members: Int[np.ndarray, " member"],
) -> list[dict[str, object]]:
    # Plans of positions at one height: DGP exceeded in 5 %, hours of disturbing glare
    height = f"{year.position[members[0], 2]:.2f}"
    share = 100 * year.share[members, :, 1]
    scale = _share_scale(100 * year.share[..., 1])
    found: list[dict[str, object]] = []
    for title, note, colours, bar in (
        (
            "DGP exceeded in 5 % of the occupied hours",
            f"eyes at {height} m; colours as in the year below",
            shades(year.exceeded[members].clip(0, 1).ravel()),
            "",
        ),
        (
            f"Occupied hours with DGP above {LIMITS[1]:.2f}",
            f"disturbing glare; eyes at {height} m",
            value_colours(scale, share.ravel()),
            colour_bar(scale),
        ),
    ):
        shape = len(members), len(year.azimuth), 3
        label = f"Plan of view grid {year.name}: {title}, {note}"
        drawing = rosette_plan(drawn, colours.reshape(shape), content, label=label)
        walls = "" if found else walls_definition(drawn.frame)
        words = {"title": title, "note": note, "walls": walls}
        found.append({**words, "drawing": drawing, "bar": bar})
    return found


def _share_scale(share: Float[np.ndarray, "position direction"]) -> ColourScale:
    top = float(share.max())
    levels = next((levels for levels in _SCALES if levels[-1] >= top), _WHOLE)
    return ColourScale(
        0, levels[-1], levels, "%", palette="YlOrRd", ends=(0.0, 1.0), steps=128
    )


def _grid_words(year: GridYear) -> str:
    views, positions = year.disturbed
    return (
        f"Glare is disturbing (DGP above {LIMITS[1]:.2f}) in more than 5 % of the"
        f" occupied hours in {percent(*views)} of the views, and in at least one view"
        f" of {percent(*positions)} of the positions."
    )


def _share_rows(year: GridYear) -> list[tuple[str, list[str]]]:
    # Shares of the occupied hours above each limit: mean of all views, and worst view
    worst = year.worst
    mean = year.share.mean(axis=(0, 1))
    rows = [("Mean of all views", [f"{100 * x:.1f} %" for x in mean.tolist()])]
    pairs = zip(year.share[worst], year.share_error[worst], strict=True)
    rows.append(("Worst view", [percent(x, e) for x, e in pairs]))
    for _, cells in rows:
        cells.append("")
    rows[0][1][-1] = f"{year.exceeded.mean():.2f}"
    rows[1][1][-1] = uncertain_dgp(
        float(year.exceeded[worst]), float(year.exceeded_error[worst])
    )
    return rows


def _state_rows(content: ReportContent, year: GridYear) -> list[tuple[str, list[str]]]:
    # Disturbed views and positions, and worst view, as operated and in each state
    if not len(year.by_state):
        return []
    place = np.repeat(np.arange(year.shape[0]), year.shape[1])
    names = ["As operated", *_state_names(content.data, len(year.by_state))]
    rows = []
    for name, dgp in zip(names, (year.exceeded, *year.by_state), strict=True):
        flat, none = dgp.ravel(), np.zeros(dgp.size)
        shares = (
            measure(flat, none, position=place).value
            for measure in (disturbed_views, disturbed_positions)
        )
        cells = [f"{100 * share:.1f} %" for share in shares]
        rows.append((name, [*cells, f"{flat.mean():.2f}", f"{flat.max():.2f}"]))
    return rows


def _state_names(data: xr.Dataset, count: int) -> list[str]:
    # Names that the windows have for each state
    if "state_name" not in data:
        return [f"State {k}" for k in range(count)]
    table = data["state_name"].values[:, :count].T.tolist()
    return [
        " / ".join(dict.fromkeys(filter(None, names))) or f"State {k}"
        for k, names in enumerate(table)
    ]


def _worst_moment(content: ReportContent, year: GridYear) -> dict[str, object]:
    # The worst moment in the occupied time: in words, and its picture if there is one
    words: dict[str, object] = {"text": "", "figures": (), "bar": ""}
    worst = year.worst_moment
    if worst is None:
        return words
    moment = content.times[worst.step]
    looks = direction_words(worst.azimuth, north=content.north)
    words["text"] = (
        f"The highest DGP in occupied hours, {uncertain_dgp(worst.dgp, worst.error)},"
        f" occurs on {moment_words(moment)} at position {worst.place}, {looks}."
    )
    file = _picture_file(content, year.name, moment)
    if file is None:
        return words
    view = ViewPictures(year.name, (Moment(worst.step, file),))
    return words | picture_figures(view, 1, content.times, lambda _view, _step: "")


def _picture_file(
    content: ReportContent, grid: str, moment: np.datetime64
) -> Path | None:
    if content.picture_folder is None:
        return None
    study = json.loads(content.data.attrs.get("study", "{}"))
    views = [table_name(table) for table in study.get("view", [])]
    grids = [str(table.get("name")) for table in study.get("view_grid", [])]
    stem = picture_stems(views, grids).get(grid)
    stamp = str(moment.astype("datetime64[m]"))[5:].replace(":", "")
    file = content.picture_folder / f"{stem}_{stamp}.hdr"
    return file if stem and file.is_file() else None
