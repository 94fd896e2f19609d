"""Weather files of Radiance and Daysim (.wea).

Hours are the moments at which the sun is evaluated. Longitude and time zone
are west-positive degrees and end here.
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.sky.gap_filling import repaired_weather
from clerestory.sky.irradiance_decomposition import Irradiance, split_irradiance
from clerestory.sky.measured_weather import Measurement, Quantity, weather_of
from clerestory.sky.solar_position import sun_position
from clerestory.sky.table_cells import column, number
from clerestory.sky.time_steps import moments, typical_step
from clerestory.sky.weather import Site, Weather

_COLUMNS = (
    "month",
    "day",
    "hour",
    "direct normal irradiance",
    "diffuse horizontal irradiance",
)

# Values of weather_data_file_units
_DIRECT_IS_NORMAL = 1
_DIRECT_IS_LEVEL = 2
_ILLUMINANCE = 3

_KEYS = (
    "place",
    "latitude",
    "longitude",
    "time_zone",
    "site_elevation",
    "weather_data_file_units",
)


def read_wea(path: str | Path) -> Weather:
    """Return the weather of a WEA file, in the year 2023 (2024 with a 29 February).

    Raises
    ------
    InputError : the header is incomplete, the units are unknown (1, direct normal
        and diffuse irradiance; 2, direct horizontal; 3, illuminance), or a row is
        wrong
    """
    lines = read_text(path).splitlines()
    site, units = _site(lines, path)

    # Split the data rows
    numbers = [i for i, text in enumerate(lines) if i >= len(_KEYS) and text.strip()]
    if not numbers:
        raise InputError("no data rows after the header", file=path, line=len(lines))
    rows = [lines[i].split() for i in numbers]
    at = np.array(numbers) + 1
    month, day, hour, direct, diffuse = (
        column(rows, index, name=name, file=path, lines=at, may_miss=index > 2)
        for index, name in enumerate(_COLUMNS)
    )
    times = moments(month, day, hour, file=path, lines=at)
    if units == _ILLUMINANCE:
        series: dict[Quantity, np.ndarray] = {
            "direct_illuminance": direct,
            "diffuse_illuminance": diffuse,
        }
        return weather_of(
            Measurement(site, times, typical_step(times), series, path, at)
        )
    parts = Irradiance(direct, diffuse)
    if units == _DIRECT_IS_LEVEL:
        parts = _from_level(direct, diffuse, site, times)
    return repaired_weather(
        site,
        times,
        direct_normal=parts.direct_normal,
        diffuse_horizontal=parts.diffuse_horizontal,
        step_minutes=typical_step(times),
        file=path,
        lines=at,
        notes=parts.notes,
    )


def _from_level(
    direct: Float[np.ndarray, " time"],
    diffuse: Float[np.ndarray, " time"],
    site: Site,
    times: np.ndarray,
) -> Irradiance:
    sun = sun_position(
        times,
        latitude_deg=site.latitude_deg,
        longitude_deg=site.longitude_deg,
        utc_offset_hours=site.utc_offset_hours,
        elevation=site.elevation,
    )
    return split_irradiance(
        times, sun, global_horizontal=direct + diffuse, diffuse_horizontal=diffuse
    )


def _site(lines: list[str], path: str | Path) -> tuple[Site, float]:
    values = {}
    place = ""
    for i, key in enumerate(_KEYS):
        cells = lines[i].split(maxsplit=1) if i < len(lines) else []
        if not cells or cells[0] != key:
            found = cells[0] if cells else "nothing"
            raise InputError(
                f"{found!r} in the header; {key!r} expected", file=path, line=i + 1
            )
        if key == "place":
            place = cells[1].strip() if len(cells) > 1 else ""
        else:
            values[key] = number(cells, 1, name=key, file=path, line=i + 1)
    units = values["weather_data_file_units"]
    if units not in (_DIRECT_IS_NORMAL, _DIRECT_IS_LEVEL, _ILLUMINANCE):
        raise InputError(
            f"weather_data_file_units {units:g}; 1, 2 or 3 expected: direct irradiance"
            " normal to the sun, horizontal, or illuminance",
            file=path,
            line=len(_KEYS),
        )
    site = Site(
        latitude_deg=values["latitude"],
        longitude_deg=-values["longitude"],
        utc_offset_hours=-values["time_zone"] / 15,
        elevation=values["site_elevation"],
        place=place,
    )
    return site, units
