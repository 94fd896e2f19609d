"""Selection of time steps of the weather: a range of days, or one moment."""

import re

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
    """Return the weather of the step that contains a local standard time "MM-DD HH:MM".

    A time step with its centre at 11:30 is the hour from 11:00 to 12:00.
    """
    valid = re.fullmatch(r"\d\d-\d\d[ T]\d\d:\d\d", moment)
    require(valid, f"time {moment!r}; a time MM-DD HH:MM expected")
    half = weather.step_minutes * 30
    for year in np.unique(weather.times.astype("datetime64[Y]")):
        try:
            wanted = np.datetime64(f"{year}-{moment.replace(' ', 'T')}", "s")
        except ValueError:
            continue
        distance = (weather.times - wanted).astype(float)
        inside = np.flatnonzero((-half < distance) & (distance <= half))
        if len(inside):
            return weather.select(inside[:1])
    first, last = weather.times[[0, -1]].astype("datetime64[m]")
    raise InputError(
        f"no weather at {moment}; a time from {first} to {last} expected",
        file=weather.source or None,
    )
