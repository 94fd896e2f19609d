"""Periods and durations in words."""

import numpy as np
from jaxtyping import Bool

from clerestory.report.heat_map import day_hour_grid


def step_minutes(times: np.ndarray) -> float:
    """Return the length of a time step [min]."""
    return 24 * 60 / day_hour_grid(times).bins


def hours_in(times: np.ndarray, counted: Bool[np.ndarray, " time"]) -> float:
    """Return the duration of the counted time steps [h]."""
    return float(np.count_nonzero(counted)) * step_minutes(times) / 60


def period_words(times: np.ndarray) -> str:
    """Return the period of the time steps in words.

    >>> hours = np.arange(8760) * np.timedelta64(1, "h")
    >>> year = np.datetime64("2023-01-01T00:30") + hours
    >>> period_words(year)
    '1 January to 31 December, 8,760 steps of 60 minutes'
    """
    days = np.unique(np.asarray(times).astype("datetime64[D]"))
    first, last = _date(days[0]), _date(days[-1])
    span = first if len(days) == 1 else f"{first} to {last}"
    if len(days) <= (days[-1] - days[0]).astype(int):
        span = f"{len(days):,} days from {span}"
    steps = f"{len(times):,} step" + ("s" if len(times) > 1 else "")
    return f"{span}, {steps} of {step_minutes(times):g} minutes"


def moment_words(moment: np.datetime64) -> str:
    """Return date and time in words, without the year.

    >>> moment_words(np.datetime64("2023-09-21T12:30"))
    '21 September 12:30'
    """
    clock = str(moment.astype("datetime64[m]"))[11:]
    return f"{date_words(moment)} {clock}"


def date_words(moment: np.datetime64) -> str:
    """Return the date in words, without the year.

    >>> date_words(np.datetime64("2023-09-21T12:30"))
    '21 September'
    """
    return _date(moment.astype("datetime64[D]"))


def _date(day: np.datetime64) -> str:
    date = day.astype(object)
    return f"{date.day} {date:%B}"
