"""A day as a film: the pictures of all views side by side, step by step.

Frames are small JPEG pictures within the page; its script shows one after the other.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from clerestory.image.picture import Picture
from clerestory.report.colour import ColourScale
from clerestory.report.colour_bar import legend
from clerestory.report.embedded_data import jpeg
from clerestory.report.markup import Markup, element
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
    """What is told beneath the film: words and colour `#rrggbb` of each frame."""

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
    """Return the frames as plain values for JSON; `note` tells of a view in a step."""
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
    clock = str(times[steps[middle]].astype("datetime64[m]"))[11:]
    screens = [
        _screen(v, middle, note(v.view, int(steps[middle]))) for v in shown.views
    ]
    scales = [
        element("div", element("span", v.view, class_="note"), legend(v.scale))
        for v in shown.views
    ]
    play = element("button", "Play", type="button", id="film-play")
    slider = element(
        "input",
        type="range",
        id="film-slider",
        min=0,
        max=len(steps) - 1,
        value=middle,
        aria_label="Time of day",
    )
    looks = [
        element("option", words, value=value)
        for value, words in (("seen", "as seen"), ("luminance", "luminances"))
    ]
    look = element("select", *looks, id="film-look", aria_label="How frames are shown")
    bar = (play, element("output", clock, id="film-clock"), slider, look)
    return element(
        "section",
        element("h2", f"A day in pictures: {date_words(times[steps[0]])}"),
        element("p", f"{len(steps)} frames from {_span(times, steps)}.", class_="note"),
        element("div", *screens, class_="screens"),
        element("div", *bar, class_="bar film-bar"),
        element("div", *(_row(row) for row in rows), class_="course"),
        element("div", *scales, class_="scales", id="film-scales", hidden="hidden"),
        element("div", class_="sheet", id="film-sheet"),
        id="film",
    )


def _span(times: np.ndarray, steps: Int[np.ndarray, " frame"]) -> str:
    first, last = (str(times[steps[k]].astype("datetime64[m]"))[11:] for k in (0, -1))
    return f"{first} to {last}, local standard time"


def _screen(view: FilmView, frame: int, said: str) -> Markup:
    # Where the view has no picture of the frame, its first
    address = view.seen[frame] or next(a for a in view.seen if a)
    columns, rows = view.size
    image = element("img", src=address, alt=view.view, width=columns, height=rows)
    caption = element(
        "figcaption", element("b", view.view), element("span", said, class_="said")
    )
    return element("figure", caption, image, style=f"flex-grow:{columns / rows:.3f}")


def _row(row: Row) -> Markup:
    # Frames of the same words are one segment
    segments = []
    for (words, colour), group in groupby(zip(row.words, row.colours, strict=True)):
        length = len(list(group))
        ink = "#fff" if _dark(colour) else "#1b1f24"
        style = f"flex:{length};background:{colour};color:{ink}"
        segments.append(element("i", words, style=style, title=words))
    name = element("span", row.name, class_="label")
    return element("div", name, element("div", *segments, class_="segments"))


def _dark(colour: str) -> bool:
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return 0.3 * red + 0.6 * green + 0.1 * blue < 140
