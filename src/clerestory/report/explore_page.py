"""Interactive page of a run: maps at any moment and over any hours, in the browser.

The page is one offline file with hourly values in it. What exceeds its size is left
out and served beside the page instead, by `report.result_server`.
"""

import base64
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from clerestory.files import write_text
from clerestory.image.colour_scale import ColourScale
from clerestory.report.colour import illuminance_scale, percent_scale
from clerestory.report.content_from_results import from_results
from clerestory.report.explore_data import OPERATED, VIEWS, ExploreData, Plan
from clerestory.report.explore_pictures import Frames, embedded_frames
from clerestory.report.floor_plan import plan_drawing, walls_definition
from clerestory.report.hourly_codes import LEVELS, STEP
from clerestory.report.markup import Markup, element, join, render
from clerestory.report.page_assets import asset, render_page
from clerestory.study.results import Results

EXPLORE_FILE = "explore.html"

# Size of hourly values in the page as text, and of the pictures [bytes]; with scripts,
# places of sensors and times the page stays below 12 MB
MOST_BYTES = 10_000_000
_PICTURE_BYTES = 3_000_000

_SCRIPTS = (
    *("plan.js", "explore_values.js", "explore_plan.js", "explore_files.js"),
    *("explore_glare.js", "explore_controls.js", "explore.js"),
)

_LEFT_OUT = (
    "{} left out, as the file would exceed 12 MB; `clerestory view RESULTS` shows them."
)


def write_explorer(
    results: Results, path: str | Path, *, pictures: str | Path | None = None
) -> None:
    """Write the interactive page of a run as one offline HTML file of up to 12 MB.

    `pictures` is the folder of the run's pictures; without it no pictures are shown.
    """
    write_text(path, offline_page(results, pictures=pictures))


def offline_page(results: Results, *, pictures: str | Path | None = None) -> str:
    """Return the interactive page of a run with all its values, as HTML."""
    notes = []
    count = most = results.data.sizes["sensor"]
    while True:
        data = ExploreData(from_results(results.thinned(most), pictures=pictures))
        parts = {OPERATED: data.illuminance_part()}
        excess = _text_size(parts) / MOST_BYTES
        if excess <= 1:
            break
        most = int(len(data.order) / (1.05 * excess))
    if len(data.order) < count:
        notes.append(
            f"{len(data.order):,} of {count:,} sensors are shown, evenly spread, as the"
            " file would exceed 12 MB; `clerestory view RESULTS` shows more."
        )
    glare = {name: content() for name, content in data.glare_parts()}
    states = _state_parts(data, MOST_BYTES - _text_size(parts | glare))
    if _text_size(parts | glare) > MOST_BYTES:
        notes.append(_LEFT_OUT.format("The hours of glare are"))
        glare = {}
    if data.has_states and not states:
        glare = {k: v for k, v in glare.items() if not k.startswith(f"{VIEWS}-")}
        notes.append(_LEFT_OUT.format("The hours of each shade state are"))
    parts |= glare | states
    room = min(_PICTURE_BYTES, MOST_BYTES + 1_000_000 - _text_size(parts))
    frames = embedded_frames(data.content, most=room)
    return explore_page(data, parts=parts, pictures=frames, notes=notes)


def _state_parts(data: ExploreData, room: int) -> dict[str, bytes]:
    # All parts of windows in their states, or none
    found: dict[str, bytes] = {}
    for name, content in data.state_parts():
        found[name] = content()
        if _text_size(found) > room:
            return {}
    return found


def _text_size(parts: Mapping[str, bytes]) -> int:
    # Size in base64
    return sum(4 * -(-len(content) // 3) for content in parts.values())


def explore_page(
    data: ExploreData,
    *,
    parts: Mapping[str, bytes | None],
    pictures: Sequence[Frames],
    notes: Sequence[str] = (),
) -> str:
    """Return the page as HTML; parts whose content is None are served beside it."""
    content, facts = data.content, data.facts()
    states = data.has_states and any(name.startswith("state-") for name in parts)
    if "views" not in parts:
        facts["views"] = []
    if not any(name.startswith("view-grid") for name in parts):
        facts["view_plans"] = []
    facts |= {"colours": _colours(), "pictures": [f.facts() for f in pictures]}
    facts["glare_states"] = states and f"{VIEWS}-0" in parts
    windows = facts["windows"]
    most = max((len(window["states"]) for window in windows), default=0)
    body = render(
        "explore.html",
        **{name: facts[name] for name in ("title", "plans", "view_plans", "views")},
        place=content.place,
        method=content.method,
        windows=windows,
        states=states,
        glare_states=facts["glare_states"],
        most=most,
        names=[_state_words(windows, state) for state in range(most)],
        rule=any("irradiance" in window for window in windows) and most > 1,
        pictures=facts["pictures"],
        days=content.grid.days,
        day=_middle_day(data),
        bins=content.grid.bins,
        target=f"{data.target_lux:g}",
        step=STEP,
        codes=f"{LEVELS:,}",
        exact=", ".join(f"{limit:,.0f}" for limit in facts["exact"]),
        notes=notes,
        definitions=join(*_drawings(data)),
        parts=join(*_embedded(parts)),
    )
    return render_page(
        title=f"{content.title} · interactive results",
        style=asset("style.css") + asset("explore.css"),
        body=body,
        data=facts,
        scripts=_SCRIPTS,
        served=None in parts.values(),
    )


def _state_words(windows: Sequence[Mapping[str, Any]], state: int) -> str:
    # Names of a state of all windows that have it
    names = [w["states"][state] for w in windows if len(w["states"]) > max(state, 1)]
    return ", ".join(dict.fromkeys(names)) or f"state {state + 1}"


def _middle_day(data: ExploreData) -> int:
    # The day with the most light
    lux = data.content.illuminance.mean(axis=0, dtype=float)
    return int(np.argmax(np.nan_to_num(data.content.grid.fill(lux)).sum(axis=0)))


def _colours() -> dict[str, list[list[int]]]:
    lux = illuminance_scale(np.array([10.0, 30_000.0]))
    difference = ColourScale(-1, 1, (-1.0, 1.0), palette="RdBu", steps=128)
    scales = {"lux": lux, "percent": percent_scale(), "difference": difference}
    return {name: scale.table().tolist() for name, scale in scales.items()}


def _drawings(data: ExploreData) -> Iterator[Markup]:
    # Walls, windows, scale and north of each plan, as templates that scripts copy
    plans: tuple[Plan, ...] = (*data.plans, *data.view_plans)
    yield element("style", Markup(asset("plan.css")), id="plan-style", media="not all")
    for plan in plans:
        yield walls_definition(plan.frame)
        drawing = plan_drawing(
            plan.frame, data.content, plan.name, Markup(""), Markup("")
        )
        yield element("template", drawing, id=f"{plan.frame.identifier}-drawing")


def _embedded(parts: Mapping[str, bytes | None]) -> Iterator[Markup]:
    for name, content in parts.items():
        if content is not None:
            text = Markup(base64.b64encode(content).decode())
            yield element("script", text, type="text/plain", id=f"part-{name}")
