"""Weather files of Radiance and Daysim (.wea).

Hours mark the centres of time steps, at which the solar position is computed. In the
file, longitude and time zone are in degrees, positive west.
"""

from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.files import read_text
from clerestory.sky.irradiance_decomposition import Irradiance, split_irradiance
from clerestory.sky.measured_weather import (
    Measurement,
    Quantity,
    weather_of,
    weather_of_components,
)
from clerestory.sky.solar_position import sun_at
from clerestory.sky.table_cells import DataRows, numbers
from clerestory.sky.time_steps import calendar_times, typical_step
from clerestory.sky.weather import Site, Weather

_COLUMNS = (
    "month",
    "day",
    "hour",
    "direct normal irradiance",
    "diffuse horizontal irradiance",
)

# Codes of weather_data_file_units, the quantity in the last two columns
_DIRECT_NORMAL, _DIRECT_HORIZONTAL, _ILLUMINANCE = 1, 2, 3

_KEYS = (
    "place",
    "latitude",
    "longitude",
    "time_zone",
    "site_elevation",
    "weather_data_file_units",
)


def read_wea(path: str | Path) -> Weather:
    """Return the weather in a WEA file, dated 2023 (2024 if it has a 29 February)."""
    lines = read_text(path).splitlines()
    site, units = _header(lines)
    rows = DataRows.below(len(_KEYS), (text.split() for text in lines), file=path)
    month, day, hour, direct, diffuse = (
        rows.column(i, name, may_miss=i > 2) for i, name in enumerate(_COLUMNS)
    )
    times = calendar_times(month, day, hour, rows=rows)
    if units == _ILLUMINANCE:
        series: dict[Quantity, np.ndarray] = {
            "direct_illuminance": direct,
            "diffuse_illuminance": diffuse,
        }
        return weather_of(Measurement(site, times, typical_step(times), series, rows))
    parts = Irradiance(direct, diffuse)
    if units == _DIRECT_HORIZONTAL:
        parts = split_irradiance(
            times,
            sun_at(site, times),
            {"global_horizontal": direct + diffuse, "diffuse_horizontal": diffuse},
        )
    return weather_of_components(site, times, rows, parts)


def _header(lines: list[str]) -> tuple[Site, float]:
    values = {}
    place = ""
    for line, key in enumerate(_KEYS, start=1):
        cells = lines[line - 1].split(maxsplit=1) if line <= len(lines) else []
        found = repr(cells[0]) if cells else "an empty line"
        require(
            cells and cells[0] == key,
            f"{found} in the header; the key {key!r} expected",
            line=line,
        )
        if key == "place":
            place = cells[1].strip() if len(cells) > 1 else ""
        else:
            (values[key],) = numbers(cells, {key: 1}, line)
    units = values["weather_data_file_units"]
    require(
        units in (_DIRECT_NORMAL, _DIRECT_HORIZONTAL, _ILLUMINANCE),
        f"weather_data_file_units {units:g}; 1 (direct normal irradiance), 2 (direct"
        " horizontal irradiance) or 3 (illuminance) expected",
        line=len(_KEYS),
    )
    east, offset = -values["longitude"], -values["time_zone"] / 15
    site = Site(values["latitude"], east, offset, values["site_elevation"], place)
    return site, units
