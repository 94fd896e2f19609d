"""Exposure to sunlight according to EN 17037: hours of sun at each opening."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.metrics.en17037 import LEVELS, SUN_HOURS, sunlight_level
from clerestory.report.markup import Markup, element, join, render
from clerestory.report.period import date_words

# Layout: margins and width of the axis, height of a bar, gap below a bar [px]
_LEFT, _RIGHT, _WIDTH = 190, 24, 640
_TOP, _BAR, _GAP = 6, 16, 8
_MORNING, _EVENING = 5, 21
_SUN, _LINE = "#f0b429", "#c9ced6"


@dataclass(frozen=True, eq=False)
class Sunlight:
    """Sunlit times of the openings of a room on one day.

    Attributes
    ----------
    moments : middles of equal time steps of the day
    openings : names of the openings
    reached : whether the sun reaches the reference point, over (opening, moment)
    hours : hours of sun of each opening [h]
    room_hours : hours in which at least one opening has sun [h]
    lowest_sun_deg : minimum solar altitude [°]
    """

    moments: np.ndarray
    openings: tuple[str, ...]
    reached: Bool[np.ndarray, "opening moment"]
    hours: Float[np.ndarray, " opening"]
    room_hours: float
    lowest_sun_deg: float


def sunlight_of(data: xr.Dataset) -> Sunlight | None:
    """Return the exposure to sunlight in results, or None if not computed."""
    if "sun_reaches" not in data:
        return None
    return Sunlight(
        data["moment"].values,
        tuple(map(str, data["opening"].values)),
        np.asarray(data["sun_reaches"].values, dtype=bool),
        np.asarray(data["hours_of_sun"].values, dtype=float),
        float(data["room_hours_of_sun"]),
        float(data["sun_reaches"].attrs["lowest_sun_deg"]),
    )


def sunlight_section(sunlight: Sunlight | None) -> Markup:
    """Return a bar of sunlit times per opening, and the EN 17037 level of the room."""
    if sunlight is None:
        return Markup("")
    limits = ", ".join(
        f"{hours:g} h {level}"
        for hours, level in zip(SUN_HOURS, LEVELS[1:], strict=True)
    )
    return render(
        "sunlight.html",
        lowest=f"{sunlight.lowest_sun_deg:g}",
        limits=limits,
        text=sunlight_words(sunlight),
        drawing=_drawing(sunlight),
    )


def sunlight_words(sunlight: Sunlight) -> str:
    """Return the exposure level of the room in words."""
    level = LEVELS[sunlight_level(sunlight.room_hours)]
    achieved = "no level" if level == "none" else f"level {level}"
    return (
        f"On {date_words(sunlight.moments[0])} the sun reaches the room for"
        f" {clock(sunlight.room_hours)}: {achieved} of EN 17037."
    )


def clock(hours: float) -> str:
    """Return a duration in hours and minutes.

    >>> clock(3.75), clock(0.0)
    ('3 h 45 min', '0 h 00 min')
    """
    minutes = round(60 * hours)
    return f"{minutes // 60} h {minutes % 60:02d} min"


def _drawing(sunlight: Sunlight) -> Markup:
    foot = _TOP + len(sunlight.openings) * (_BAR + _GAP)
    marks = []
    for hour in range(_MORNING, _EVENING + 1):
        x = f"{_across(hour):.1f}"
        marks.append(
            element("path", d=f"M{x},{_TOP}V{foot}", stroke=_LINE, stroke_width=0.6)
        )
        if hour % 3 == 0:
            marks.append(
                element(
                    "text", f"{hour:02d}:00", x=x, y=foot + 14, text_anchor="middle"
                )
            )
    rows = [_bar(sunlight, number) for number in range(len(sunlight.openings))]
    return element(
        "svg",
        element("title", "Hours of sun of each opening"),
        *marks,
        *rows,
        viewBox=f"0 0 {_LEFT + _WIDTH + _RIGHT} {foot + 20}",
        role="img",
        aria_label=sunlight_words(sunlight),
    )


def _bar(sunlight: Sunlight, number: int) -> Markup:
    top = _TOP + number * (_BAR + _GAP)
    label = f"{sunlight.openings[number]}, {clock(sunlight.hours[number])}"
    text = element("text", label, x=0, y=top + 12)
    step = 24 / sunlight.reached.shape[1]
    edges = np.diff(np.pad(sunlight.reached[number].astype(int), 1))
    spans = zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True)
    bars = [
        element(
            "rect",
            element("title", f"{_time(first * step)} to {_time(last * step)}"),
            x=f"{_across(first * step):.1f}",
            y=top,
            width=f"{_across(last * step) - _across(first * step):.1f}",
            height=_BAR,
            fill=_SUN,
        )
        for first, last in spans
    ]
    return join(text, *bars)


def _across(hour: float) -> float:
    inside = min(max(hour, _MORNING), _EVENING)
    return _LEFT + _WIDTH * (inside - _MORNING) / (_EVENING - _MORNING)


def _time(hour: float) -> str:
    minutes = round(60 * hour)
    return f"{minutes // 60:02d}:{minutes % 60:02d}"
