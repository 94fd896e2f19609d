"""Animation of one day: pictures of all views side by side, a frame per time step.

Frames are small JPEG images embedded in the page and shown by the script film.js.
"""

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from clerestory.glare.dgp import DGP
from clerestory.image.colour_scale import ColourScale
from clerestory.report.colour import colour_bar, hexadecimal
from clerestory.report.content import ReportContent
from clerestory.report.embedded_data import jpeg
from clerestory.report.markup import render
from clerestory.report.period import date_words, evenly
from clerestory.report.section import Section
from clerestory.report.view_glare import COLOURS, view_glare
from clerestory.report.view_pictures import (
    ViewPictures,
    as_luminance,
    as_seen,
    exposures,
    luminance_scale,
    moment_notes,
    read_small,
    view_pictures,
)
from clerestory.report.window_states import window_states

# Smallest and largest number of frames of an animation
_FEWEST, _MOST = 6, 96

# Total length of data URLs [characters]; frame widths tried [pixels]; JPEG quality
_BUDGET = 6_000_000
_WIDTHS = (480, 400, 320, 256, 200, 160, 120)
_QUALITY = 78

# Colour in the glare row for frames in the dark
_DARK = "#eceef0"


class Frames(NamedTuple):
    """Frames of one view as data URLs; "" for time steps without a picture.

    `seen` are tone-mapped images, `luminance` false-colour images; `size` is in pixels.
    """

    view: str
    seen: list[str]
    luminance: list[str]
    size: tuple[int, int]
    scale: ColourScale


def film_section(content: ReportContent) -> Section:
    """Return the animation of one day with controls, showing the middle frame first.

    The section is empty if no day has six time steps with pictures.
    """
    pictures, times = view_pictures(content), content.times
    steps = film_steps(pictures, times, brightness=content.illuminance.mean(axis=0))
    if not len(steps):
        return Section()
    views, note = _frames(pictures, steps), moment_notes(content)
    middle = len(steps) // 2
    clock = [str(time)[11:] for time in times[steps].astype("datetime64[m]")]
    notes = {v.view: [note(v.view, step) for step in steps.tolist()] for v in views}
    body = render(
        "animation.html",
        date=date_words(times[steps[0]]),
        count=len(steps),
        clock=clock,
        middle=middle,
        views=[
            {
                "name": view.view,
                "note": notes[view.view][middle],
                # If the middle frame is empty, show the first picture of the view
                "address": view.seen[middle] or next(filter(None, view.seen)),
                "columns": view.size[0],
                "rows": view.size[1],
                "bar": colour_bar(view.scale),
            }
            for view in views
        ],
        rows=_rows(content, steps),
    )
    data = [
        {"seen": view.seen, "luminance": view.luminance, "notes": notes[view.view]}
        for view in views
    ]
    return Section(body, {"film": {"clock": clock, "views": data}})


def film_steps(
    views: Sequence[ViewPictures],
    times: np.ndarray,
    *,
    brightness: Float[np.ndarray, " time"],
) -> Int[np.ndarray, " frame"]:
    """Return the time steps with pictures on the day with the most pictures.

    If no day has six pictures, the result is empty. Ties go to the brightest day.
    """
    steps = np.unique([m.step for view in views for m in view.moments]).astype(int)
    if not len(steps):
        return steps
    days = times[steps].astype("datetime64[D]")
    dates, place, count = np.unique(days, return_inverse=True, return_counts=True)
    light = np.bincount(place, weights=brightness[steps])
    steps = steps[days == dates[np.lexsort((light, count))[-1]]]
    if len(steps) < _FEWEST:
        return np.zeros(0, dtype=int)
    return np.asarray(steps[evenly(len(steps), _MOST)])


def _frames(
    views: Sequence[ViewPictures], steps: Int[np.ndarray, " frame"]
) -> list[Frames]:
    # Frames of the largest width for which the data URLs fit the size limit
    shown: list[Frames] = []
    for width in _WIDTHS:
        shown = [
            _view_frames(view, steps, width)
            for view in views
            if {moment.step for moment in view.moments} & set(steps.tolist())
        ]
        if sum(len("".join([*v.seen, *v.luminance])) for v in shown) <= _BUDGET:
            break
    return shown


def _view_frames(
    view: ViewPictures, steps: Int[np.ndarray, " frame"], width: int
) -> Frames:
    files = {moment.step: moment.file for moment in view.moments}
    kept = [k for k, step in enumerate(steps.tolist()) if step in files]
    pictures = [read_small(files[int(steps[k])], width=width) for k in kept]
    scale = luminance_scale(pictures)
    seen, luminance = [""] * len(steps), [""] * len(steps)
    for k, picture, white in zip(kept, pictures, exposures(pictures), strict=True):
        seen[k] = jpeg(as_seen(picture, white), width=width, quality=_QUALITY)
        luminance[k] = jpeg(as_luminance(picture, scale), width=width, quality=_QUALITY)
    size = pictures[0].columns, pictures[0].rows
    return Frames(view.view, seen, luminance, size, scale)


def _rows(
    content: ReportContent, steps: Int[np.ndarray, " frame"]
) -> list[dict[str, Any]]:
    # Rows of coloured text below the frames: shades of each window, DGP of each view
    rows = []
    for each in window_states(content.data):
        shades = hexadecimal(each.colours())
        words = [(each.names[k], shades[k]) for k in each.state[steps].tolist()]
        rows.append({"name": each.window, "segments": list(_segments(words))})
    shades = hexadecimal(COLOURS)
    for glare in view_glare(content.data):
        kinds = DGP.category(glare.rated()[steps]).tolist()
        words = [
            (f"{dgp:.2f}", shades[kind]) if np.isfinite(dgp) else ("–", _DARK)
            for dgp, kind in zip(glare.dgp[steps].tolist(), kinds, strict=True)
        ]
        rows.append({"name": f"DGP {glare.view}", "segments": list(_segments(words))})
    return rows


def _segments(frames: Sequence[tuple[str, str]]) -> Iterator[dict[str, object]]:
    # Successive frames with equal text and colour form one segment
    for (words, colour), group in groupby(frames):
        yield {
            "words": words,
            "length": len(list(group)),
            "colour": colour,
            "ink": "#fff" if _dark(colour) else "#1b1f24",
        }


def _dark(colour: str) -> bool:
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return 0.3 * red + 0.6 * green + 0.1 * blue < 140
