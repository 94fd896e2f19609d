"""Data for the scripts of a page: sensors, metrics, hourly series and scene.

Hourly series are the largest part of a page. The mean of each grid is always included,
and as many evenly spaced sensors as the size limit allows.
"""

from functools import partial
from typing import Any

import numpy as np
from jaxtyping import Int

from clerestory.report.animation import film_data
from clerestory.report.annual_sections import day_maps, moment_note
from clerestory.report.class_map import day_map_data
from clerestory.report.colour import illuminance_scale
from clerestory.report.content import ReportContent
from clerestory.report.embedded_data import code_step, illuminance_codes, packed
from clerestory.report.equation_terms import equation_data
from clerestory.report.floor_plan import PlanFrame, plan_frame
from clerestory.report.heat_map import DARKEST_LUX, day_hour_grid
from clerestory.report.metric_maps import metric_maps
from clerestory.report.room_view import room_view
from clerestory.report.uncertain_value import Figure

# Maximum number of hourly values on a page: about 3 MB after compression
_MOST_VALUES = 1_500_000


def page_data(content: ReportContent) -> dict[str, Any]:
    """Return the data of the page as JSON values."""
    maps = metric_maps(content.metrics)
    mean_scale = illuminance_scale(maps[0].values)
    metrics = {
        metric.key: {
            "texts": [
                f"{metric.title}: {Figure(float(v), float(e), metric.unit)}"
                for v, e in zip(metric.values, metric.errors, strict=True)
            ]
        }
        for metric in maps
    }
    return {
        "names": list(content.sensors.names),
        "grids": {
            frame.identifier: _grid_data(frame, members)
            for frame, members in grid_frames(content).values()
        },
        "metrics": metrics,
        "year": _year_data(content),
        "maps": {
            shown.identifier: day_map_data(shown, content.times)
            for shown in day_maps(content)
        },
        "film": _film_data(content),
        "terms": _terms_data(content),
        "view": room_view(content, means=maps[0].values, scale=mean_scale),
    }


def grid_frames(
    content: ReportContent,
) -> dict[str, tuple[PlanFrame, Int[np.ndarray, " member"]]]:
    """Return the plan frame and the sensors of each grid, by name of the grid."""
    return {
        name: (plan_frame(content, members, identifier=f"plan-{k}"), members)
        for k, (name, members) in enumerate(content.sensors.by_grid().items())
    }


def series_names(content: ReportContent) -> list[tuple[str, int | None]]:
    """Return names of hourly series with their sensor index, None for grid means."""
    names: list[tuple[str, int | None]] = [
        (f"Mean of {grid} ({len(members):,} sensors)", None)
        for grid, members in content.sensors.by_grid().items()
    ]
    count = min(len(content.sensors), max(1, _MOST_VALUES // len(content.times)))
    chosen = np.unique(
        np.linspace(0, len(content.sensors) - 1, count).round().astype(int)
    )
    return names + [(content.sensors.names[k], int(k)) for k in chosen]


def _grid_data(frame: PlanFrame, members: Int[np.ndarray, " member"]) -> dict[str, Any]:
    place = frame.place(frame.points)
    cells = frame.place(frame.cells)
    reach = float(np.linalg.norm(cells - place[:, None], axis=2).max())
    return {
        "sensors": members.tolist(),
        "x": place[:, 0].round(1).tolist(),
        "y": place[:, 1].round(1).tolist(),
        "reach": round(1.05 * reach, 1),
    }


def _film_data(content: ReportContent) -> dict[str, Any] | None:
    if content.film is None:
        return None
    return film_data(content.film, content.times, note=partial(moment_note, content))


def _terms_data(content: ReportContent) -> dict[str, Any] | None:
    if content.terms is None:
        return None
    return equation_data(content.terms, content.sensors, content.times)


def _year_data(content: ReportContent) -> dict[str, Any]:
    grid = day_hour_grid(content.times)
    scale = illuminance_scale(content.illuminance, low=DARKEST_LUX)
    means = iter(content.sensors.by_grid().values())
    series = []
    for name, sensor in series_names(content):
        lux = (
            content.illuminance[next(means)].mean(axis=0)
            if sensor is None
            else content.illuminance[sensor]
        )
        codes = packed(illuminance_codes(lux))
        series.append({"name": name, "sensor": sensor, "codes": codes})
    return {
        "dates": grid.dates.astype(int).tolist(),
        "bins": grid.bins,
        "cell": packed(grid.cell.astype(np.uint32)),
        "code_step": code_step(),
        "low": scale.low,
        "high": scale.high,
        "colours": scale.table().tolist(),
        "series": series,
    }
