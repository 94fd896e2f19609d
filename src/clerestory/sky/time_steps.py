"""Moments of the calendar as files write them, in the fixed year of a typical year."""

from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError
from clerestory.sky.weather import TYPICAL_LEAP_YEAR, TYPICAL_YEAR

StandsFor = Literal["start", "centre", "end"]

# Steps from the moment that a time stands for to the centre
_SHIFTS = {"start": 0.5, "centre": 0.0, "end": -0.5}

_DAYS = (31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)


def moments(
    month: Float[np.ndarray, " time"],
    day: Float[np.ndarray, " time"],
    hour: Float[np.ndarray, " time"],
    *,
    file: str | Path,
    lines: np.ndarray,
) -> np.ndarray:
    """Return the moments `hour` hours after the start of the given days, to the second.

    The year is 2023, or 2024 where a 29 February occurs. Hours within 2 s of
    a whole minute are taken as that minute, since files write 0.167 for 1/6.

    Raises
    ------
    InputError : a date that is not in the calendar, an hour outside a day, or
        time that does not grow
    """
    calendar = np.array(_DAYS)
    whole = (month == np.floor(month)) & (day == np.floor(day))
    known = whole & (month >= 1) & (month <= 12) & (day >= 1)
    known[known] = day[known] <= calendar[month[known].astype(int) - 1]
    if not np.all(known):
        i = int(np.argmin(known))
        raise InputError(
            f"month {month[i]:g}, day {day[i]:g}; a date of the calendar expected",
            file=file,
            line=int(lines[i]),
        )
    inside = (hour >= 0) & (hour <= 24)
    if not np.all(inside):
        i = int(np.argmin(inside))
        raise InputError(
            f"hour {hour[i]:g}; 0 to 24 expected", file=file, line=int(lines[i])
        )

    # Build the dates in the fixed year
    leap = np.any((month == 2) & (day == 29))
    year = TYPICAL_LEAP_YEAR if leap else TYPICAL_YEAR
    first = np.datetime64(f"{year}-01", "M") + (month.astype(int) - 1)
    date = first.astype("datetime64[D]") + (day.astype(int) - 1)

    # Add the hours, on the minute if they are meant to be
    seconds = np.round(hour * 3600)
    minute = 60 * np.round(seconds / 60)
    seconds = np.where(np.abs(seconds - minute) <= 2, minute, seconds).astype(int)
    times = date.astype("datetime64[s]") + seconds
    require_growth(times, file=file, lines=lines)
    return np.asarray(times)


def require_growth(times: np.ndarray, *, file: str | Path, lines: np.ndarray) -> None:
    """Refuse moments that do not grow, naming the first line to blame."""
    late = np.diff(times) <= np.timedelta64(0)
    if np.any(late):
        i = int(np.argmax(late)) + 1
        raise InputError(
            f"time goes back from {times[i - 1]} to {times[i]}; growing times expected",
            file=file,
            line=int(lines[i]),
        )


def typical_step(times: np.ndarray) -> float:
    """Return the shortest step between moments [min]; 60 for a single one.

    Steps within 5 s of a whole minute are taken as that, since files round hours
    to three digits: 0.042, 0.125, 0.208 for every five minutes.
    """
    if len(times) < 2:
        return 60.0
    step = float(np.min(np.diff(times)) / np.timedelta64(1, "m"))
    whole = round(step)
    return float(whole) if whole and abs(step - whole) <= 5 / 60 else step


def centres(
    times: np.ndarray, step_minutes: float, stands_for: StandsFor
) -> np.ndarray:
    """Return the centres of steps whose times stand for their start, centre or end.

    Raises
    ------
    InputError : another moment
    """
    if stands_for not in _SHIFTS:
        raise InputError(
            f"times stand for {stands_for!r}; 'start', 'centre' or 'end' expected"
        )
    seconds = round(_SHIFTS[stands_for] * step_minutes * 60)
    return np.asarray(times + np.timedelta64(seconds, "s"))
