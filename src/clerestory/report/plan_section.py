"""Floor plans of the metrics of each grid, and the table of the sensors."""

from typing import Any

import numpy as np
from jaxtyping import Int

from clerestory.report.colour import colour_bar, illuminance_scale, percent_scale
from clerestory.report.compliance_maps import compliance_maps
from clerestory.report.content import ReportContent
from clerestory.report.floor_plan import PlanFrame, plan, plan_frame, walls_definition
from clerestory.report.markup import Markup, render
from clerestory.report.metric_maps import MELANOPIC_KEYS, metric_maps
from clerestory.report.section import Section
from clerestory.report.uncertain_value import Figure

# Maximum number of rows of the sensor table; metrics drawn for vertical sensors
_MOST_ROWS = 500
_UPRIGHT = ("mean", "autonomy", "exceeded", *MELANOPIC_KEYS)


def plans_section(content: ReportContent) -> Section:
    """Return the floor plans of each grid, one per metric."""
    grids, frames = [], {}
    for number, (name, members) in enumerate(content.sensors.by_grid().items()):
        frame = plan_frame(content, members, identifier=f"plan-{number}")
        grids.append(_plans(content, name, frame, members))
        frames[frame.identifier] = _grid_data(frame, members)
    maps = (*metric_maps(content.metrics), *compliance_maps(content).values())
    metrics = {
        metric.key: {
            "texts": [
                f"{metric.title}: {Figure(float(v), float(e), metric.unit)}"
                for v, e in zip(metric.values, metric.errors, strict=True)
            ]
        }
        for metric in maps
    }
    return Section(
        render(
            "plans.html",
            grids=grids,
            windows=bool(content.windows),
            sensor_table=_sensor_table(content),
        ),
        {"grids": frames, "metrics": metrics},
    )


def _plans(
    content: ReportContent,
    name: str,
    frame: PlanFrame,
    members: Int[np.ndarray, " member"],
) -> dict[str, object]:
    maps = metric_maps(content.metrics)
    lux = illuminance_scale(maps[0].values)
    plans = []
    for metric in maps:
        if not frame.level and metric.key not in _UPRIGHT:
            continue
        scale = lux if metric.unit == "lux" else percent_scale()
        note = f"{metric.note}: {metric.mean(members)} on average"
        label = f"Plan of {name}: {metric.title}, {note}"
        shown = plan(frame, metric, members, scale=scale, content=content, label=label)
        words = {"title": metric.title, "note": note}
        plans.append({**words, "drawing": shown, "bar": colour_bar(scale)})
    return {
        "name": name,
        "count": f"{len(members):,} sensor{'s' if len(members) > 1 else ''}",
        "height": f"{np.median(content.sensors.position[members, 2]):.2f}",
        "walls": walls_definition(frame),
        "plans": plans,
    }


def _grid_data(frame: PlanFrame, members: Int[np.ndarray, " member"]) -> dict[str, Any]:
    # Sensors in drawing coordinates; distance within which the pointer selects one
    place, cells = frame.place(frame.points), frame.place(frame.cells)
    reach = float(np.linalg.norm(cells - place[:, None], axis=2).max())
    x, y = place.round(1).T.tolist()
    return {
        "sensors": members.tolist(),
        "x": x,
        "y": y,
        "reach": round(1.05 * reach, 1),
    }


def _sensor_table(content: ReportContent) -> Markup:
    # Positions and metrics of the first 500 sensors
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
