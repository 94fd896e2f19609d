"""Selection of time steps of the weather: a range of days, or one moment."""

import re
from contextlib import suppress
from dataclasses import replace

import numpy as np

from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.sky.weather import Weather


def select_days(
    weather: Weather, *, first: str = "01-01", last: str = "12-31"
) -> Weather:
    """Return the weather from day `first` to day `last`, "MM-DD", both included.

    If `last` is before `first`, the range includes 1 January.
    """
    for day in (first, last):
        valid = re.fullmatch(r"(0[1-9]|1[0-2])-(0[1-9]|[12]\d|3[01])", day)
        require(valid, f"day {day!r}; MM-DD expected")
    days = np.array([str(day)[5:10] for day in weather.times.astype("datetime64[D]")])
    after, before = days >= first, days <= last
    chosen = after & before if first <= last else after | before
    require(
        chosen.any(),
        f"no weather from {first} to {last}; days from {days[0]} to {days[-1]}"
        " expected",
        file=weather.source or None,
    )
    return weather.select(chosen)


def select_moment(weather: Weather, moment: str) -> Weather:
    """Return the weather at a local standard time "MM-DD HH:MM".

    The irradiance is that of the time step which contains the time, as in
    `step_containing`; the position of the sun is that at the time itself.
    """
    valid = re.fullmatch(r"\d\d-\d\d[ T]\d\d:\d\d", moment)
    require(valid, f"time {moment!r}; a time MM-DD HH:MM expected")
    for year in np.unique(weather.times.astype("datetime64[Y]")):
        with suppress(ValueError):
            wanted = np.datetime64(f"{year}-{moment.replace(' ', 'T')}", "s")
            step = step_containing(weather, wanted)
            if step is not None:
                note = f"irradiance of the {weather.step_minutes:g}-minute step"
                note += f" centred at {weather.times[step][0].astype('datetime64[m]')}"
                chosen = replace(weather, notes=(*weather.notes, note)).select(step)
                return replace(chosen, times=np.array([wanted]))
    first, last = weather.times[[0, -1]].astype("datetime64[m]")
    raise InputError(
        f"no weather at {moment}; a time from {first} to {last} expected",
        file=weather.source or None,
    )


def step_containing(weather: Weather, moment: np.datetime64) -> slice | None:
    """Return the time step that contains a moment, as a slice; None if there is none.

    A step includes its start and excludes its end: with centres at 11:30 and 12:30, the
    time 12:00 belongs to the second step.
    """
    half = np.timedelta64(round(weather.step_minutes * 30), "s")
    step = int(np.searchsorted(weather.times - half, moment, side="right")) - 1
    inside = step >= 0 and moment < weather.times[step] + half
    return slice(step, step + 1) if inside else None
