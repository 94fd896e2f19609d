"""Exposure to sunlight according to EN 17037, for the openings of a study."""

import numpy as np
import xarray as xr

from clerestory.metrics.en17037 import hours_of_sun, reference_point
from clerestory.phases.unscattered_light import sun_visible
from clerestory.radiance.window_reader import read_windows
from clerestory.scene.scaling import scaled
from clerestory.scene.window import Window
from clerestory.sky.solar_position import SunPosition, sun_at
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs
from clerestory.study.weather_tables import SunlightTable

_STEP_MINUTES = 1


def sunlight(study: Study, inputs: Inputs) -> xr.Dataset:
    """Return the hours of sunlight of each opening.

    The dataset is empty without table [sunlight], unless EN 17037 is assessed.
    """
    table, windows = study.sunlight, openings(study, inputs)
    if table is None and study.assesses("EN 17037"):
        table = SunlightTable()
    if table is None or not windows:
        return xr.Dataset()
    names, points = _openings(table, windows)
    moments, sun = _day(study, table, inputs)
    lowest = {"lowest_sun_deg": table.lowest_sun_deg}
    high = sun.altitude >= np.radians(table.lowest_sun_deg)
    reached = np.zeros((len(points), len(moments)), dtype=bool)
    # Computed on this machine; with a cluster, `device` is for cluster workers
    device = "auto" if study.trace.cluster else study.trace.device
    directions = sun.directions()[high]
    inwards = np.array([w.frame.normal for w in windows for _ in w.polygons])
    seen = sun_visible(inputs.scene, points, directions, device=device)
    reached[:, high] = seen & (inwards @ directions.T < 0)
    each, room = hours_of_sun(reached, step_minutes=_STEP_MINUTES)
    return xr.Dataset(
        {
            "sun_reaches": (("opening", "moment"), reached, lowest),
            "sun_point": (("opening", "xyz"), points, {"units": "m"}),
            "opening_normal": (("opening", "xyz"), inwards),
            "hours_of_sun": ("opening", each, {"units": "h"}),
            "room_hours_of_sun": ((), room, {"units": "h"}),
        },
        coords={"opening": names, "moment": moments},
    )


def openings(study: Study, inputs: Inputs) -> tuple[Window, ...]:
    """Return the openings of a study: its windows, or those of a file of [sunlight]."""
    table = study.sunlight
    if table is not None and table.file is not None:
        return scaled(tuple(read_windows(table.file)), study.scene.metres)
    return tuple(group.inner for group in inputs.groups)


def _openings(
    table: SunlightTable, windows: tuple[Window, ...]
) -> tuple[list[str], np.ndarray]:
    # Names and reference points of openings; each window polygon is one opening
    names, points = [], []
    for window in windows:
        several = len(window.polygons) > 1
        for number, polygon in enumerate(window.polygons, start=1):
            names.append(f"{window.name}.{number}" if several else window.name)
            vertices, normal = polygon.vertices, window.frame.normal
            points.append(
                reference_point(vertices, normal, floor=table.floor, depth=table.depth)
            )
    return names, np.array(points)


def _day(
    study: Study, table: SunlightTable, inputs: Inputs
) -> tuple[np.ndarray, SunPosition]:
    # Centres of all minutes of the day, and sun positions in scene coordinates
    year = str(inputs.weather.times[0])[:4]
    half = 30 * _STEP_MINUTES
    seconds = np.arange(half, 86400, 2 * half).astype("timedelta64[s]")
    moments = np.datetime64(f"{year}-{table.day}", "s") + seconds
    sun = sun_at(inputs.weather.site, moments)
    turned = sun.azimuth - np.radians(study.sky.rotation_deg)
    return moments.astype("datetime64[ns]"), SunPosition(sun.altitude, turned)
