"""Sections of every report: plans, year, room, uncertainty, computation, glossary."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Int

from clerestory.metrics.climate_based_metrics import USEFUL_LIMITS_LUX
from clerestory.report.colour import ColourScale, illuminance_scale, percent_scale
from clerestory.report.colour_bar import colour_bar
from clerestory.report.content import ReportContent
from clerestory.report.embedded_data import picture
from clerestory.report.floor_plan import PlanFrame, plan, walls_definition
from clerestory.report.headline import target_words
from clerestory.report.heat_map import DARKEST_LUX, day_hour_grid, heat_map
from clerestory.report.markup import Markup, render
from clerestory.report.metric_maps import MetricMap, metric_maps
from clerestory.report.orientation import orientation
from clerestory.report.page_data import grid_frames, series_names
from clerestory.report.room_view import MOST_TRIANGLES
from clerestory.report.uncertain_value import Figure
from clerestory.report.uncertainty import LIT_LUX, error_histogram, error_rows

# Maximum number of rows of the sensor table, and metrics of vertical sensors
_MOST_ROWS = 500
_UPRIGHT = ("mean", "autonomy", "exceeded")

# Colours of the 3-D view, as in view.js
_KEYS = (
    ("#2f8f5b", "front of a window, and its normal: must face the room"),
    ("#d9772b", "back of a window: must face outdoors"),
    ("#6a3d9a", "up direction of the BSDF"),
    ("#b5367a", "sensors, coloured by their mean illuminance as in the plans"),
)


def plans_section(content: ReportContent) -> Markup:
    """Return the floor plans of each grid, one per metric."""
    return render(
        "plans.html",
        grids=[
            _plans(content, name, frame, members)
            for name, (frame, members) in grid_frames(content).items()
        ],
        sensor_table=_sensor_table(content),
    )


def _plans(
    content: ReportContent,
    name: str,
    frame: PlanFrame,
    members: Int[np.ndarray, " member"],
) -> dict[str, object]:
    drawings = []
    for metric, scale in _shown(content, frame.level):
        note = f"{metric.note}: {metric.mean(members)} on average"
        label = f"Plan of {name}: {metric.title}, {note}"
        drawing = plan(
            frame, metric, members, scale=scale, content=content, label=label
        )
        drawings.append(
            {
                "title": metric.title,
                "note": note,
                "drawing": drawing,
                "bar": colour_bar(scale),
            }
        )
    return {
        "name": name,
        "count": f"{len(members):,} sensor{'s' if len(members) > 1 else ''}",
        "height": f"{np.median(content.sensors.position[members, 2]):.2f}",
        "walls": walls_definition(frame),
        "plans": drawings,
    }


def _shown(content: ReportContent, level: bool) -> list[tuple[MetricMap, ColourScale]]:
    # Metrics defined for horizontal or vertical sensors, with their colour scales
    maps = metric_maps(content.metrics)
    lux = illuminance_scale(maps[0].values)
    return [
        (metric, lux if metric.unit == "lux" else percent_scale())
        for metric in maps
        if level or metric.key in _UPRIGHT
    ]


def _sensor_table(content: ReportContent) -> Markup:
    # Limited to the first 500 sensors
    sensors, maps = content.sensors, metric_maps(content.metrics)
    rows = []
    for k in range(min(len(sensors), _MOST_ROWS)):
        cells = [f"{x:.2f}" for x in sensors.position[k]]
        for metric in maps:
            figure = Figure(float(metric.values[k]), float(metric.errors[k]), "")
            cells.append(str(figure).strip() if figure.error else f"{figure.value:.1f}")
        rows.append((sensors.names[k], cells))
    titles = [m.title.replace("Useful illuminance:", "UDI") for m in maps]
    head = ["Sensor", "x [m]", "y [m]", "z [m]"]
    head += [f"{t} [{m.unit}]" for t, m in zip(titles, maps, strict=True)]
    return render("sensors.html", head=head, rows=rows, left=len(sensors) - len(rows))


def year_section(content: ReportContent) -> Markup:
    """Return the annual heat map and the list of selectable series."""
    grid = day_hour_grid(content.times)
    scale = illuminance_scale(content.illuminance, low=DARKEST_LUX)
    series = series_names(content)
    names = [name for name, _ in series]
    members = next(iter(content.sensors.by_grid().values()))
    lux = content.illuminance[members].mean(axis=0)
    return render(
        "year.html",
        darkest=f"{DARKEST_LUX:.0f}",
        gaps=bool(np.any(np.diff(grid.dates) > np.timedelta64(1, "D"))),
        names=names,
        carried=sum(sensor is not None for _, sensor in series),
        total=len(content.sensors),
        drawing=heat_map(
            grid,
            image=picture(grid.fill(lux), scale),
            occupied=content.occupied,
            label=f"{names[0]}: illuminance by day and hour",
        ),
        bar=colour_bar(scale),
    )


def room_section(content: ReportContent) -> Markup:
    """Return the 3-D view and a description of the window orientations."""
    rows = [orientation(window, content) for window in content.windows]
    faces = "; ".join(f"window {row.window} faces {row.room_side}" for row in rows)
    return render(
        "room.html",
        label=f"3-D view of the scene with {len(content.sensors)} sensors. {faces}",
        colours=_KEYS,
        left_out=len(content.room.corners) - MOST_TRIANGLES,
        windows=rows,
    )


def accuracy_section(content: ReportContent) -> Markup:
    """Return the distribution of the standard errors."""
    return render(
        "accuracy.html",
        least=f"{LIT_LUX:.0f}",
        histogram=error_histogram(content),
        rows=error_rows(content),
    )


def computation_section(content: ReportContent) -> Markup:
    """Return the parameters, versions and run times."""
    times = time_table(content.seconds) if content.seconds else ""
    return render("computation.html", tables=content.tables, times=times)


def time_table(seconds: Mapping[str, float]) -> Markup:
    """Return the run time of each phase with bars, longest first."""
    total = sum(seconds.values())
    rows = [
        (phase, duration(spent), 100 * spent / total if total > 0 else 0.0)
        for phase, spent in sorted(seconds.items(), key=lambda item: -item[1])
    ]
    return render("times.html", rows=rows, total=duration(total))


def duration(seconds: float) -> str:
    """Return a time span with its unit.

    >>> duration(0.0314), duration(12.34), duration(754)
    ('0.03 s', '12.3 s', '12 min 34 s')
    """
    if seconds < 1:
        return f"{seconds:.2f} s"
    if seconds < 120:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 120:
        return f"{minutes} min {rest} s"
    return f"{minutes // 60} h {minutes % 60} min"


def glossary_section(content: ReportContent) -> Markup:
    """Return the definitions of the terms."""
    return render(
        "glossary.html",
        schedule=content.schedule,
        target=target_words(content),
        limits=[f"{limit:,.0f}" for limit in USEFUL_LIMITS_LUX],
    )
