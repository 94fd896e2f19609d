"""Dates, lengths and centres of the time steps of weather files."""

from typing import Literal

import numpy as np

from clerestory.array_types import Series
from clerestory.checks import one_of
from clerestory.sky.table_cells import DataRows
from clerestory.sky.weather import TYPICAL_LEAP_YEAR, TYPICAL_YEAR

StandsFor = Literal["start", "centre", "end"]

# Offset from the time in the file to the centre of the time step [time steps]
_SHIFTS = {"start": 0.5, "centre": 0.0, "end": -0.5}

_DAYS = np.array([31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31])


def calendar_times(
    month: Series, day: Series, hour: Series, *, rows: DataRows
) -> np.ndarray:
    """Return times from month, day and decimal hour, to the second.

    The year is 2023, or 2024 if the data include 29 February. Times within 2 s of a
    whole minute are rounded to that minute, since files contain 0.167 for 1/6.
    """
    known = np.isin(month, range(1, 13)) & (day == np.floor(day)) & (day >= 1)
    known &= day <= _DAYS[np.clip(month, 1, 12).astype(int) - 1]
    rows.require(
        known,
        lambda i: (
            f"month {month[i]:g}, day {day[i]:g}; a date of the calendar expected"
        ),
    )
    rows.require(
        (hour >= 0) & (hour <= 24), lambda i: f"hour {hour[i]:g}; 0 to 24 expected"
    )

    # Dates in the year 2023 or 2024
    year = TYPICAL_LEAP_YEAR if np.any((month == 2) & (day == 29)) else TYPICAL_YEAR
    first = np.datetime64(f"{year}-01", "M") + (month.astype(int) - 1)
    date = first.astype("datetime64[D]") + (day.astype(int) - 1)

    # Add the hours; round times within 2 s of a whole minute
    seconds = np.round(hour * 3600)
    minute = 60 * np.round(seconds / 60)
    seconds = np.where(np.abs(seconds - minute) <= 2, minute, seconds).astype(int)
    times = np.asarray(date.astype("datetime64[s]") + seconds)
    _require_increasing(times, rows)
    return times


def step_centres(
    times: np.ndarray, stands_for: StandsFor, *, rows: DataRows
) -> tuple[np.ndarray, float]:
    """Return centres and length [min] of steps from their starts, centres or ends."""
    one_of(stands_for, "stands_for", choices=_SHIFTS)
    _require_increasing(times, rows)
    step = typical_step(times)
    seconds = round(_SHIFTS[stands_for] * step * 60)
    return np.asarray(times + np.timedelta64(seconds, "s")), step


def _require_increasing(times: np.ndarray, rows: DataRows) -> None:
    rows.require(
        np.diff(times, prepend=times[:1] - 1) > np.timedelta64(0),
        lambda i: f"time {times[i]} follows {times[i - 1]}; increasing times expected",
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
