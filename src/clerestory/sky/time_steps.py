"""Dates, lengths and centres of the time steps of weather files."""

from typing import Literal

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError
from clerestory.sky.table_cells import DataRows
from clerestory.sky.weather import TYPICAL_LEAP_YEAR, TYPICAL_YEAR

StandsFor = Literal["start", "centre", "end"]

# Offset from the time in the file to the centre of the step, in step lengths
_SHIFTS = {"start": 0.5, "centre": 0.0, "end": -0.5}

_DAYS = (31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)


def calendar_times(
    month: Float[np.ndarray, " time"],
    day: Float[np.ndarray, " time"],
    hour: Float[np.ndarray, " time"],
    *,
    rows: DataRows,
) -> np.ndarray:
    """Return times from month, day and decimal hour, to the second.

    The year is 2023, or 2024 if the data include 29 February. Times within 2 s of a
    whole minute are rounded to that minute, since files contain 0.167 for 1/6.
    """
    calendar = np.array(_DAYS)
    whole = (month == np.floor(month)) & (day == np.floor(day))
    known = whole & (month >= 1) & (month <= 12) & (day >= 1)
    known[known] = day[known] <= calendar[month[known].astype(int) - 1]
    if not np.all(known):
        i = int(np.argmin(known))
        raise InputError(
            f"month {month[i]:g}, day {day[i]:g}; a date of the calendar expected",
            file=rows.file,
            line=int(rows.lines[i]),
        )
    inside = (hour >= 0) & (hour <= 24)
    if not np.all(inside):
        i = int(np.argmin(inside))
        raise InputError(
            f"hour {hour[i]:g}; 0 to 24 expected",
            file=rows.file,
            line=int(rows.lines[i]),
        )

    # Dates in the fixed year
    leap = np.any((month == 2) & (day == 29))
    year = TYPICAL_LEAP_YEAR if leap else TYPICAL_YEAR
    first = np.datetime64(f"{year}-01", "M") + (month.astype(int) - 1)
    date = first.astype("datetime64[D]") + (day.astype(int) - 1)

    # Add the hours, and correct for rounding in the file
    seconds = np.round(hour * 3600)
    minute = 60 * np.round(seconds / 60)
    seconds = np.where(np.abs(seconds - minute) <= 2, minute, seconds).astype(int)
    times = date.astype("datetime64[s]") + seconds
    require_increasing(times, rows=rows)
    return np.asarray(times)


def require_increasing(times: np.ndarray, *, rows: DataRows) -> None:
    """Raise `InputError` at the first row whose time does not increase."""
    late = np.diff(times) <= np.timedelta64(0)
    if np.any(late):
        i = int(np.argmax(late)) + 1
        raise InputError(
            f"time goes back from {times[i - 1]} to {times[i]}; increasing times"
            " expected",
            file=rows.file,
            line=int(rows.lines[i]),
        )


def typical_step(times: np.ndarray) -> float:
    """Return the shortest interval between times [min]; 60 for a single time.

    Intervals within 5 s of a whole minute are rounded to that minute, since files
    contain hours with three decimals: 0.042, 0.125, 0.208 for steps of five minutes.
    """
    if len(times) < 2:
        return 60.0
    step = float(np.min(np.diff(times)) / np.timedelta64(1, "m"))
    whole = round(step)
    return float(whole) if whole and abs(step - whole) <= 5 / 60 else step


def centres(
    times: np.ndarray, step_minutes: float, stands_for: StandsFor
) -> np.ndarray:
    """Return the centres of steps from times at their start, centre or end."""
    if stands_for not in _SHIFTS:
        raise InputError(
            f"times stand for {stands_for!r}; 'start', 'centre' or 'end' expected"
        )
    seconds = round(_SHIFTS[stands_for] * step_minutes * 60)
    return np.asarray(times + np.timedelta64(seconds, "s"))
