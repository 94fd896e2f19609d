"""Periods and dates in words, and evenly spaced selections."""

import numpy as np

from clerestory.report.heat_map import day_hour_grid


def period_words(times: np.ndarray) -> str:
    """Return the period of the time steps in words.

    >>> hours = np.arange(8760) * np.timedelta64(1, "h")
    >>> year = np.datetime64("2023-01-01T00:30") + hours
    >>> period_words(year)
    '1 January to 31 December, 8,760 steps of 60 minutes'
    """
    days = np.unique(np.asarray(times).astype("datetime64[D]"))
    first, last = date_words(days[0]), date_words(days[-1])
    span = first if len(days) == 1 else f"{first} to {last}"
    if len(days) <= (days[-1] - days[0]).astype(int):
        span = f"{len(days):,} days from {span}"
    steps = f"{len(times):,} step" + ("s" if len(times) > 1 else "")
    return f"{span}, {steps} of {day_hour_grid(times).step_minutes:g} minutes"


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
    date = moment.astype("datetime64[D]").astype(object)
    return f"{date.day} {date:%B}"


def evenly(count: int, most: int) -> list[int]:
    """Return at most `most` evenly spaced indices of a sequence of `count` items.

    >>> evenly(9, 3), evenly(2, 3)
    ([0, 4, 8], [0, 1])
    """
    places = np.linspace(0, count - 1, min(count, most)).round().astype(int)
    return list(dict.fromkeys(places.tolist()))
