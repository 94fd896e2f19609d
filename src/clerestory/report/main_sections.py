"""The figures of the page with their words: plans, the year, the room."""

import numpy as np

from clerestory.report.colour import ColourScale, illuminance_scale, percent_scale
from clerestory.report.colour_bar import legend
from clerestory.report.content import ReportContent
from clerestory.report.embedded_data import picture
from clerestory.report.fact_tables import sensor_table
from clerestory.report.floor_plan import plan, walls_definition
from clerestory.report.heat_map import DARKEST_LUX, day_hour_grid, heat_map
from clerestory.report.markup import Markup, element
from clerestory.report.metric_maps import MetricMap, metric_maps
from clerestory.report.orientation import orientation, orientation_table
from clerestory.report.page_data import grid_frames, series_names
from clerestory.report.room_view import MOST_TRIANGLES

# What eyes and other upright sensors are judged by
_UPRIGHT = ("mean", "autonomy", "exceeded")

# The colours of the 3-D view, as in view.js
_KEYS = (
    ("#2f8f5b", "front of a window, and its normal: must face the room"),
    ("#d9772b", "back of a window: must face outdoors"),
    ("#6a3d9a", "up direction of the BSDF"),
    ("#b5367a", "sensors, coloured by their mean illuminance as in the plans"),
)


def plans_section(content: ReportContent) -> Markup:
    """Return the plans of every grid, one for each metric."""
    intro = (
        "Each sensor’s share of the plan takes the colour of its value. Walls are cut"
        " at the height of the sensors; windows are blue, dashed where they lie"
        " overhead, and a green arrow shows their front, which must point into the"
        " room. Point at a sensor for its value; choose one to see its year below."
    )
    blocks = [
        element("h2", "Where the light falls"),
        element("p", intro, class_="note"),
    ]
    for name, (frame, members) in grid_frames(content).items():
        height = float(np.median(content.sensors.position[members, 2]))
        count = f"{len(members):,} sensor{'s' if len(members) > 1 else ''}"
        blocks.append(element("h3", f"{name} · {count} at {height:.2f} m"))
        blocks.append(walls_definition(frame))
        figures = []
        for metric, scale in _shown(content, frame.level):
            mean = metric.mean(members)
            drawing = plan(
                frame,
                metric,
                members,
                scale=scale,
                content=content,
                label=f"Plan of {name}: {metric.title}, {metric.note},"
                f" {mean} on average",
            )
            note = f"{metric.note}: {mean} on average"
            caption = element("figcaption", element("b", metric.title), note)
            figures.append(element("figure", caption, drawing, legend(scale)))
        blocks.append(element("div", *figures, class_="plans"))
    blocks.append(sensor_table(content.sensors, metric_maps(content.metrics)))
    return element("section", *blocks, id="plans")


def _shown(content: ReportContent, level: bool) -> list[tuple[MetricMap, ColourScale]]:
    # The metrics that fit the way the sensors face, each with its colours
    maps = metric_maps(content.metrics)
    lux = illuminance_scale(maps[0].values)
    return [
        (metric, lux if metric.unit == "lux" else percent_scale())
        for metric in maps
        if level or metric.key in _UPRIGHT
    ]


def year_section(content: ReportContent) -> Markup:
    """Return the picture of the year, with the list of series to choose from."""
    grid = day_hour_grid(content.times)
    scale = illuminance_scale(content.illuminance, low=DARKEST_LUX)
    names = [name for name, _ in series_names(content)]
    members = next(iter(content.sensors.by_grid().values()))
    lux = content.illuminance[members].mean(axis=0)
    options = (element("option", name, value=k) for k, name in enumerate(names))
    intro = (
        "Illuminance for every day, from left to right, and every hour, from bottom to"
        " top, in local standard time. The darkest colour is"
        f" {DARKEST_LUX:.0f} lux or less; the dashed lines enclose the occupied hours."
    )
    if np.any(np.diff(grid.dates) > np.timedelta64(1, "D")):
        intro += " Days without data are left out."
    drawing = heat_map(
        grid,
        image=picture(grid.fill(lux), scale),
        occupied=content.occupied,
        label=f"{names[0]}: illuminance by day and hour",
    )
    chooser = (
        element("label", "Show", for_="series"),
        element("select", *options, id="series"),
    )
    return element(
        "section",
        element("h2", "Through the year"),
        element("p", intro, class_="note"),
        element("div", *chooser, _carried(content), class_="chooser"),
        element("div", drawing, class_="year-scroll"),
        legend(scale),
        id="year",
    )


def _carried(content: ReportContent) -> Markup:
    # Say so where the page could not hold the hours of every sensor
    carried = sum(sensor is not None for _, sensor in series_names(content))
    if carried == len(content.sensors):
        return Markup("")
    text = f"with {carried:,} of the {len(content.sensors):,} sensors, evenly chosen"
    return element("span", text, class_="note")


def room_section(content: ReportContent) -> Markup:
    """Return the 3-D view and the orientation of the windows in words."""
    rows = [orientation(window, content) for window in content.windows]
    faces = "; ".join(f"window {row.window} faces {row.room_side}" for row in rows)
    label = f"3-D view of the scene with {len(content.sensors)} sensors. {faces}"
    stage = element(
        "div",
        element("canvas", role="img", aria_label=label, tabindex=0),
        element("noscript", element("p", "The 3-D view needs JavaScript.")),
        class_="stage",
        id="stage",
    )
    keys = (
        element("li", element("i", style=f"background:{colour}"), text)
        for colour, text in _KEYS
    )
    intro = (
        "Drag to turn, or use the arrow keys. A window turned the wrong way round is"
        " the commonest mistake in studies with BSDFs: seen from the room, it must be"
        " green."
    )
    left_out = len(content.room.corners) - MOST_TRIANGLES
    if left_out > 0:
        intro += f" The {left_out:,} smallest triangles of the scene are not drawn."
    table = Markup("")
    if rows:
        table = element("div", orientation_table(rows), class_="wide")
    return element(
        "section",
        element("h2", "The room, and which way its windows face"),
        element("p", intro, class_="note"),
        element("div", stage, _view_controls(), class_="view"),
        element("ul", *keys, class_="keys"),
        table,
        id="room",
    )


def _view_controls() -> Markup:
    looks = (
        ("inside", "From inside"),
        ("outside", "From outside"),
        ("above", "From above"),
    )
    buttons = [
        element("button", text, type="button", data_look=look) for look, text in looks
    ]
    for text, factor, label in (("+", 1.25, "Zoom in"), ("−", 0.8, "Zoom out")):
        button = element(
            "button", text, type="button", data_zoom=factor, aria_label=label
        )
        buttons.append(button)
    box = element("input", type="checkbox", id="cutaway", checked="checked")
    choice = element("label", box, "cut away what stands in front")
    return element("div", *buttons, choice, class_="bar")
