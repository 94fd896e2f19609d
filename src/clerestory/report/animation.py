"""Animation of one day: the pictures of all views side by side, by time step.

Frames are small JPEG images embedded in the page and shown by its script.
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

# Smallest and largest number of frames of an animation
_FEWEST, _MOST = 6, 96

# Maximum size of all frames [characters], frame widths tried [pixels], JPEG quality
_BUDGET = 6_000_000
_WIDTHS = (480, 400, 320, 256, 200, 160, 120)
_QUALITY = 78


@dataclass(frozen=True, eq=False)
class FilmView:
    """Frames of one view.

    Attributes
    ----------
    view : name of the view
    seen, luminance : data URLs of the tone-mapped and false-colour frames; empty for
        time steps without picture
    size : width and height of the frames [pixels]
    scale : colour scale of the luminance
    """

    view: str
    seen: tuple[str, ...]
    luminance: tuple[str, ...]
    size: tuple[int, int]
    scale: ColourScale


@dataclass(frozen=True, eq=False)
class Film:
    """Animation of one day.

    Attributes
    ----------
    steps : index of the time step of each frame
    views : frames of each view, at least one
    """

    steps: Int[np.ndarray, " frame"]
    views: tuple[FilmView, ...]


@dataclass(frozen=True)
class Row:
    """Row of text below the frames, with a colour `#rrggbb` per frame."""

    name: str
    words: tuple[str, ...]
    colours: tuple[str, ...]


def film(
    views: Sequence[ViewPictures],
    times: np.ndarray,
    *,
    brightness: Float[np.ndarray, " time"],
) -> Film | None:
    """Return the animation of the day with most pictures; None if fewer than six.

    Among days with equal numbers of pictures, the brightest day is chosen.
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
    """Return the time steps of the frames, all on one day; empty if too few."""
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
    """Return the frames as JSON values; `note` describes a view at a time step."""
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
    """Return the section with the animation and its controls, at the middle frame."""
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
                # The first picture of the view if this frame has none
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
    # Successive frames with equal text form one segment
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
