"""Animation of a day: the pictures of all views side by side, step by step.

Frames are small JPEG pictures within the page; its script shows one after the other.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from clerestory.image.picture import Picture
from clerestory.report.colour import ColourScale
from clerestory.report.colour_bar import colour_bar
from clerestory.report.embedded_data import jpeg
from clerestory.report.markup import Markup, render
from clerestory.report.period import date_words
from clerestory.report.view_pictures import (
    ViewPictures,
    as_luminance,
    as_seen,
    exposures,
    luminance_scale,
    read_small,
)

# A film has as many frames at least, and no more than these
_FEWEST, _MOST = 6, 96

# Characters of frames that a page carries, their widths tried, and their quality
_BUDGET = 6_000_000
_WIDTHS = (480, 400, 320, 256, 200, 160, 120)
_QUALITY = 78


@dataclass(frozen=True, eq=False)
class FilmView:
    """The frames of one view.

    Attributes
    ----------
    view : its name
    seen, luminance : data address of each frame; empty where there is no picture
    size : columns and rows
    scale : of the luminances
    """

    view: str
    seen: tuple[str, ...]
    luminance: tuple[str, ...]
    size: tuple[int, int]
    scale: ColourScale


@dataclass(frozen=True, eq=False)
class Film:
    """A day of pictures.

    Attributes
    ----------
    steps : number of the time step of each frame
    views : one or more
    """

    steps: Int[np.ndarray, " frame"]
    views: tuple[FilmView, ...]


@dataclass(frozen=True)
class Row:
    """A row below the frames: text and colour `#rrggbb` of each frame."""

    name: str
    words: tuple[str, ...]
    colours: tuple[str, ...]


def film(
    views: Sequence[ViewPictures],
    times: np.ndarray,
    *,
    brightness: Float[np.ndarray, " time"],
) -> Film | None:
    """Return the day with the most pictures as a film, if six steps have one.

    Of days with as many pictures the brightest is taken.
    """
    steps = film_steps(views, times, brightness=brightness)
    if not len(steps):
        return None
    for width in _WIDTHS:
        shown = tuple(
            _view_frames(view, steps, width)
            for view in views
            if {m.step for m in view.moments} & set(steps.tolist())
        )
        size = sum(len(a) for v in shown for a in (*v.seen, *v.luminance))
        if size <= _BUDGET:
            break
    return Film(steps, shown)


def film_steps(
    views: Sequence[ViewPictures],
    times: np.ndarray,
    *,
    brightness: Float[np.ndarray, " time"],
) -> Int[np.ndarray, " frame"]:
    """Return the steps of the frames: those of one day, none for too few."""
    steps = np.unique([m.step for view in views for m in view.moments]).astype(int)
    if not len(steps):
        return steps
    days = times[steps].astype("datetime64[D]")
    dates, place, count = np.unique(days, return_inverse=True, return_counts=True)
    light = np.bincount(place, weights=brightness[steps])
    best = dates[np.lexsort((light, count))[-1]]
    steps = steps[days == best]
    if len(steps) < _FEWEST:
        return np.zeros(0, dtype=int)
    places = np.linspace(0, len(steps) - 1, min(len(steps), _MOST)).round().astype(int)
    return np.asarray(steps[places])


def _view_frames(
    view: ViewPictures, steps: Int[np.ndarray, " frame"], width: int
) -> FilmView:
    files = {moment.step: moment.file for moment in view.moments}
    kept = [k for k, step in enumerate(steps.tolist()) if step in files]
    pictures = [read_small(files[int(steps[k])], width=width) for k in kept]
    scale = luminance_scale(pictures)
    seen, luminance = [""] * len(steps), [""] * len(steps)
    for k, picture, white in zip(kept, pictures, exposures(pictures), strict=True):
        seen[k] = jpeg(as_seen(picture, white), width=width, quality=_QUALITY)
        luminance[k] = jpeg(as_luminance(picture, scale), width=width, quality=_QUALITY)
    return FilmView(view.view, tuple(seen), tuple(luminance), _size(pictures[0]), scale)


def _size(picture: Picture) -> tuple[int, int]:
    return picture.columns, picture.rows


def film_data(
    shown: Film, times: np.ndarray, *, note: Callable[[str, int], str]
) -> dict[str, Any]:
    """Return the frames as plain values for JSON; `note` describes a time step."""
    clock = [str(t)[11:16] for t in times[shown.steps].astype("datetime64[m]")]
    return {
        "clock": clock,
        "views": [
            {
                "seen": list(view.seen),
                "luminance": list(view.luminance),
                "notes": [note(view.view, step) for step in shown.steps.tolist()],
            }
            for view in shown.views
        ],
    }


def film_section(
    shown: Film | None,
    times: np.ndarray,
    *,
    note: Callable[[str, int], str],
    rows: Sequence[Row] = (),
) -> Markup:
    """Return the screens of a film with its controls, at its middle frame."""
    if shown is None:
        return Markup("")
    steps = shown.steps
    middle = len(steps) // 2
    clock = [str(times[step].astype("datetime64[m]"))[11:] for step in steps]
    views = []
    for view in shown.views:
        columns, height = view.size
        views.append(
            {
                "name": view.view,
                "note": note(view.view, int(steps[middle])),
                # Without a picture of the frame, the first of the view
                "address": view.seen[middle] or next(a for a in view.seen if a),
                "columns": columns,
                "rows": height,
                "bar": colour_bar(view.scale),
            }
        )
    return render(
        "animation.html",
        date=date_words(times[steps[0]]),
        count=len(steps),
        first=clock[0],
        last=clock[-1],
        clock=clock[middle],
        middle=middle,
        views=views,
        rows=[{"name": row.name, "segments": list(_segments(row))} for row in rows],
    )


def _segments(row: Row) -> Iterator[dict[str, object]]:
    # Frames with the same words are one segment
    for (words, colour), group in groupby(zip(row.words, row.colours, strict=True)):
        yield {
            "words": words,
            "length": len(list(group)),
            "colour": colour,
            "ink": "#fff" if _dark(colour) else "#1b1f24",
        }


def _dark(colour: str) -> bool:
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return 0.3 * red + 0.6 * green + 0.1 * blue < 140
