"""Sankey diagram of the solar radiation on windows: its parts as ribbons.

The heights of ribbons are proportional to the energy of a year. Ribbons lead from the
radiation on the windows to what they reflect, absorb by layer, and transmit, and from
there to what the room keeps and returns.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr

from clerestory.report.markup import Markup, drawing, element
from clerestory.report.uncertain_value import number

_COLOURS = {
    "reflected": "#c9c4b8",
    "absorbed": "#e0926f",
    "transmitted": "#e3b341",
    "kept by the room": "#cf8f2e",
    "returned outdoors": "#c9c4b8",
}

# Size of the drawing, width of nodes, places of the columns, and gap between ribbons
_WIDTH, _HEIGHT, _NODE, _GAP, _TOP = 560.0, 190.0, 8.0, 14.0, 8.0
_COLUMNS = (0.0, 170.0, 345.0)


@dataclass(frozen=True)
class Flow:
    """Part of the radiation: name, energy [kWh], and colour."""

    name: str
    energy: float
    colour: str


def solar_flows(data: xr.Dataset) -> tuple[list[Flow], list[Flow]]:
    """Return the parts of the radiation on all windows, and of the transmitted."""
    parts = data["annual_window_solar"].sum("energy_window")
    kwh = dict(zip(parts["solar_part"].values.tolist(), parts.values, strict=True))
    found = {name: max(float(value), 0.0) for name, value in kwh.items()}
    rest = found["incident"] - found["transmitted"] - found["absorbed"]
    reflected = found.get("reflected", max(rest, 0.0))
    layers = {"absorbed": found["absorbed"]}
    if "annual_layer_solar" in data:
        values = data["annual_layer_solar"].sum("energy_window").values.tolist()
        layers = {
            f"absorbed by layer {number}": value
            for number, value in enumerate(values, 1)
            if value > 0
        }
    first = [Flow("reflected", reflected, _COLOURS["reflected"])]
    first += [Flow(name, value, _COLOURS["absorbed"]) for name, value in layers.items()]
    first += [Flow("transmitted", found["transmitted"], _COLOURS["transmitted"])]
    if "returned" not in found:
        return first, []
    kept = max(found["transmitted"] - found["returned"], 0.0)
    second = {"kept by the room": kept, "returned outdoors": found["returned"]}
    return first, [Flow(name, v, _COLOURS[name]) for name, v in second.items()]


def solar_words(data: xr.Dataset) -> str:
    """Return a sentence with the shares of the radiation."""
    first, second = solar_flows(data)
    whole = float(data["annual_window_solar"].sel(solar_part="incident").sum())
    parts = [
        f"{100 * flow.energy / max(whole, 1e-9):.0f} % {flow.name}"
        for flow in [*first, *second]
    ]
    return (
        f"Solar radiation on the windows in the year: {number(whole)} kWh;"
        f" {', '.join(parts)}."
    )


def solar_drawing(data: xr.Dataset) -> Markup:
    """Return the Sankey diagram of the radiation on all windows."""
    first, second = solar_flows(data)
    whole = sum(flow.energy for flow in first)
    size = _HEIGHT - _GAP * len(first)
    scale = size / max(whole, 1e-9)
    marks = [_node(_COLUMNS[0], _TOP, whole * scale, "#e3b341")]
    begin, top = _TOP, _TOP
    for flow in first:
        tall = flow.energy * scale
        divided = flow.name == "transmitted" and bool(second)
        marks += _ribbon(
            _COLUMNS[0], _COLUMNS[1], (begin, top), tall, flow, divided=divided
        )
        if flow.name == "transmitted":
            start = end = top
            for part in second:
                marks += _ribbon(
                    _COLUMNS[1], _COLUMNS[2], (start, end), part.energy * scale, part
                )
                start += part.energy * scale
                end += part.energy * scale + _GAP
        begin, top = begin + tall, top + tall + _GAP
    words = solar_words(data)
    return drawing(words, *marks, width=_WIDTH, height=_TOP + _HEIGHT + 12)


def _node(x: float, top: float, tall: float, colour: str) -> Markup:
    place = {"x": f"{x:.1f}", "y": f"{top:.1f}"}
    size = {"width": f"{_NODE:.1f}", "height": f"{max(tall, 0.5):.1f}"}
    return element("rect", fill=colour, **place, **size)


def _ribbon(
    left: float,
    right: float,
    tops: tuple[float, float],
    tall: float,
    flow: Flow,
    *,
    divided: bool = False,
) -> list[Markup]:
    # Ribbon between two columns, its node at the right, and its label beside it, or
    # before it if the node is divided further
    x0, x1 = left + _NODE, right
    middle = (x0 + x1) / 2
    (a, b), tall = tops, max(tall, 0.5)
    path = (
        f"M{x0:.1f},{a:.1f}C{middle:.1f},{a:.1f} {middle:.1f},{b:.1f} {x1:.1f},{b:.1f}"
        f"V{b + tall:.1f}C{middle:.1f},{b + tall:.1f} {middle:.1f},{a + tall:.1f}"
        f" {x0:.1f},{a + tall:.1f}Z"
    )
    title = element("title", f"{flow.name}: {number(flow.energy)} kWh")
    text = f"{flow.name}, {number(flow.energy)} kWh"
    place = {"y": f"{b + np.clip(tall / 2, 3, 60) + 4:.1f}"}
    if divided:
        place |= {"x": f"{x1 - 4:.1f}", "text_anchor": "end"}
    else:
        place |= {"x": f"{x1 + _NODE + 4:.1f}"}
    return [
        element("path", title, d=path, fill=flow.colour, fill_opacity=0.6),
        _node(x1, b, tall, flow.colour),
        element("text", text, **place),
    ]
