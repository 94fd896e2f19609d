"""Weather of a study: read or generated, and reduced to the simulated time steps."""

from dataclasses import replace

import numpy as np

from clerestory.errors import InputError
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.sky.clear_sky import clear_sky_weather
from clerestory.sky.quality_checks import warn_of_clock
from clerestory.sky.station_file import read_with
from clerestory.sky.weather import Site, Weather
from clerestory.sky.weather_formats import read_weather
from clerestory.sky.weather_selection import select_days
from clerestory.study.config import Study
from clerestory.study.config_tables import ClearSkyTable, WeatherTable


def study_weather(study: Study) -> Weather:
    """Return the weather of the simulated time steps."""
    table = study.weather
    weather = select_days(
        _whole(table), first=table.first_day or "01-01", last=table.last_day or "12-31"
    )
    step = weather.step_minutes * table.every
    weather = replace(weather.select(_chosen(weather, table)), step_minutes=step)
    start, end = study.schedule.from_hour, study.schedule.to_hour
    if not occupied_hours(weather.times, from_hour=start, to_hour=end).any():
        raise InputError(
            f"no time step lies between {start:g} and {end:g} h, the study's schedule;"
            " at least one expected",
            file=table.file,
        )
    return weather


def _whole(table: WeatherTable) -> Weather:
    if table.clear_sky is not None:
        return _clear(table.clear_sky)
    if table.file is None:
        raise InputError("no weather; a file or a clear sky expected")
    if table.measured is None:
        weather = read_weather(table.file)
    else:
        weather = read_with(table.file, table.measured)
    warn_of_clock(weather)
    return weather


def _clear(table: ClearSkyTable) -> Weather:
    site = Site(
        table.latitude_deg,
        table.longitude_deg,
        table.utc_offset_hours,
        table.elevation,
        table.place,
    )
    return clear_sky_weather(
        site, turbidity=table.turbidity, step_minutes=table.step_minutes
    )


def _chosen(weather: Weather, table: WeatherTable) -> np.ndarray:
    # Indices of the steps within the hours, at the given moments, every n-th of them
    steps = occupied_hours(
        weather.times, from_hour=table.from_hour, to_hour=table.to_hour
    )
    if table.moments:
        stamps = np.datetime_as_string(weather.times, unit="m").tolist()
        named = np.array([stamp[5:] in table.moments for stamp in stamps])
        missing = set(table.moments) - {stamp[5:] for stamp in stamps}
        if missing:
            raise InputError(
                f"no step at {min(missing)}; the middle of a step, such as"
                f" {stamps[len(stamps) // 2][5:]}, expected",
                file=table.file,
            )
        steps &= named
    numbers = np.flatnonzero(steps)[:: table.every]
    if len(numbers) == 0:
        raise InputError(
            f"no time step lies between {table.from_hour:g} and {table.to_hour:g} h;"
            " at least one expected",
            file=table.file,
        )
    return numbers
