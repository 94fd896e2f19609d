"""Results of a run for viewers of VTK: room, windows and metrics of the sensors."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from clerestory.image.colour_scale import ColourScale
from clerestory.report.colour import illuminance_scale, percent_scale
from clerestory.report.content import ReportContent
from clerestory.report.content_from_results import from_results
from clerestory.report.metric_maps import MetricMap, metric_maps
from clerestory.scene.sensor_cells import sensor_faces
from clerestory.study.results import Results
from clerestory.study.vtkjs import Surfaces, pane_surfaces, room_surfaces, write_vtkjs


def write_vtkjs_results(results: Results, path: str | Path) -> None:
    """Write the room, the windows and the metrics of all sensors as a .vtkjs file.

    The metrics are those of the maps of the report. Each grid is a dataset that is
    coloured by daylight autonomy, until another metric is chosen in the viewer.

    Raises
    ------
    OutputError : the file cannot be written
    """
    content = from_results(results, most_sensors=results.data.sizes["sensor"])
    maps = metric_maps(content.metrics)
    ordered = sorted(maps, key=lambda each: each.key != "autonomy")
    shown = {f"{each.title} [{each.unit}]": each for each in ordered}
    windows = [
        pane_surfaces(f"window {each.name}", each.corners) for each in content.windows
    ]
    room = content.room
    materials = content.data.get("triangle_material")
    names = ["room"] * len(room.corners) if materials is None else materials.values
    walls = room_surfaces(room.corners, room.colour, [str(name) for name in names])
    scales = {name: _scale(metric) for name, metric in shown.items()}
    surfaces = [*_grids(content, shown), *windows, *walls]
    write_vtkjs(path, surfaces, scales=scales)


def _grids(
    content: ReportContent, shown: Mapping[str, MetricMap]
) -> Iterator[Surfaces]:
    sensors = content.sensors
    for name, members in sensors.by_grid().items():
        corners = sensor_faces(sensors.position[members], sensors.direction[members])
        values = {key: metric.values[members] for key, metric in shown.items()}
        yield Surfaces(f"grid {name}", corners, values=values)


def _scale(metric: MetricMap) -> ColourScale:
    return percent_scale() if metric.unit == "%" else illuminance_scale(metric.values)
