"""Exposure to sunlight according to EN 17037: hours of sun at each opening."""

import numpy as np
import xarray as xr
from jaxtyping import Bool

from clerestory.metrics.en17037 import LEVELS, SUN_HOURS, sunlight_level
from clerestory.report.content import ReportContent
from clerestory.report.markup import Markup, drawing, element, render
from clerestory.report.period import date_words
from clerestory.report.section import Section

# Layout: margins and width of the axis, height of a bar, gap below a bar [px]
_LEFT, _RIGHT, _WIDTH = 190, 24, 640
_TOP, _BAR, _GAP = 6, 16, 8
_MORNING, _EVENING = 5, 21
_SUN, _LINE = "#f0b429", "#c9ced6"


def sunlight_section(content: ReportContent) -> Section:
    """Return sunlit times per opening, and the EN 17037 level of the room.

    The section is empty if exposure to sunlight was not computed.
    """
    data = content.data
    if "sun_reaches" not in data:
        return Section()
    limits = (
        f"{h:g} h {level}" for h, level in zip(SUN_HOURS, LEVELS[1:], strict=True)
    )
    return Section(
        render(
            "sunlight.html",
            lowest=f"{float(data['sun_reaches'].attrs['lowest_sun_deg']):g}",
            limits=", ".join(limits),
            text=_words(data),
            drawing=_drawing(data),
        )
    )


def _words(data: xr.Dataset) -> str:
    hours = float(data["room_hours_of_sun"])
    level = LEVELS[sunlight_level(hours)]
    achieved = "no level" if level == "none" else f"level {level}"
    return (
        f"On {date_words(data['moment'].values[0])} the sun reaches the room for"
        f" {clock(hours)}: {achieved} of EN 17037."
    )


def clock(hours: float) -> str:
    """Return a duration in hours and minutes.

    >>> clock(3.75), clock(0.0)
    ('3 h 45 min', '0 h 00 min')
    """
    minutes = round(60 * hours)
    return f"{minutes // 60} h {minutes % 60:02d} min"


def _drawing(data: xr.Dataset) -> Markup:
    # One row of bars per opening, above an axis of hours
    foot = _TOP + data.sizes["opening"] * (_BAR + _GAP)
    marks = []
    for hour in range(_MORNING, _EVENING + 1):
        x = f"{_across(hour):.1f}"
        line = f"M{x},{_TOP}V{foot}"
        marks.append(element("path", d=line, stroke=_LINE, stroke_width=0.6))
        if hour % 3 == 0:
            place = {"x": x, "y": foot + 14, "text_anchor": "middle"}
            marks.append(element("text", f"{hour:02d}:00", **place))
    names = data["opening"].values.tolist()
    reached = data["sun_reaches"].transpose("opening", "moment").values.astype(bool)
    for number, (name, row) in enumerate(zip(names, reached, strict=True)):
        label = f"{name}, {clock(float(data['hours_of_sun'][number]))}"
        marks += _bars(label, row, top=_TOP + number * (_BAR + _GAP))
    size = {"width": _LEFT + _WIDTH + _RIGHT, "height": foot + 20}
    return drawing(_words(data), *marks, **size)


def _bars(
    label: str, reached: Bool[np.ndarray, " moment"], *, top: int
) -> list[Markup]:
    # Label of an opening, and a bar for each period with sun
    hours = np.flatnonzero(np.diff(np.pad(reached.astype(int), 1))) * 24 / len(reached)
    return [
        element("text", label, x=0, y=top + 12),
        *(
            element(
                "rect",
                element("title", f"{_time(first)} to {_time(last)}"),
                x=f"{_across(first):.1f}",
                y=top,
                width=f"{_across(last) - _across(first):.1f}",
                height=_BAR,
                fill=_SUN,
            )
            for first, last in hours.reshape(-1, 2).tolist()
        ),
    ]


def _across(hour: float) -> float:
    inside = min(max(hour, _MORNING), _EVENING)
    return _LEFT + _WIDTH * (inside - _MORNING) / (_EVENING - _MORNING)


def _time(hour: float) -> str:
    minutes = round(60 * hour)
    return f"{minutes // 60:02d}:{minutes % 60:02d}"
