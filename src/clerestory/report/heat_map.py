"""Annual heat maps: days from left to right, hours of the day upwards.

Each cell shows the mean over the time steps in it. Time steps may be shorter than an
hour, days may be missing, and several years are superposed.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.report.markup import Markup, drawing, element

_WIDTH, _HEIGHT = 1000, 240
_LEFT, _TOP, _RIGHT, _BOTTOM = 46, 8, 12, 26
_SHORTEST_MINUTES = 5

# If a smaller fraction of days has data, days without data are left out
_SPARSE = 0.3

# Number of days above which the axis marks months instead of days
_LONG = 62

# Lower limit of the colour scale [lux]
DARKEST_LUX = 10.0


@dataclass(frozen=True, eq=False)
class DayHourGrid:
    """Cells of an annual heat map: a column of `bins` cells for each day.

    `dates` are the days of the columns. `cell` is the cell index of each time step,
    counted upwards within a day, and day by day.
    """

    dates: np.ndarray
    bins: int
    cell: Int[np.ndarray, " time"]

    @property
    def days(self) -> int:
        """Number of days, one per column."""
        return len(self.dates)

    @property
    def step_minutes(self) -> float:
        """Length of a time step [min]."""
        return 24 * 60 / self.bins

    def hours(self, counted: Bool[np.ndarray, " time"]) -> float:
        """Total duration [h] of the time steps at which `counted` is true."""
        return float(np.count_nonzero(counted)) * self.step_minutes / 60

    def fill(self, values: Float[np.ndarray, " time"]) -> Float[np.ndarray, "bin day"]:
        """Mean value in each cell, NaN for a cell without values; midnight in row 0."""
        size = self.days * self.bins
        count = np.bincount(self.cell, minlength=size)
        total = np.bincount(self.cell, weights=values, minlength=size)
        with np.errstate(invalid="ignore"):
            return (total / count).reshape(self.days, self.bins).T

    def day_marks(self) -> list[tuple[int, float, str]]:
        """Start, middle and name of axis marks: months, or days of a short period.

        Start and middle are column numbers of the heat map.
        """
        month = self.dates.astype("datetime64[M]")
        dense = self.dates[-1] - self.dates[0] < np.timedelta64(self.days, "D")
        if self.days > _LONG and dense:
            marked = np.flatnonzero(self.dates == month.astype("datetime64[D]"))
            names = [f"{m:%b}" for m in month[marked].astype(object)]
        else:
            marked = np.arange(0, self.days, max(1, self.days // 8))
            names = [f"{d.day} {d:%b}" for d in self.dates[marked].astype(object)]
        half = 15.0 if dense and self.days > _LONG else 0.5
        return [(k, k + half, n) for k, n in zip(marked.tolist(), names, strict=True)]


def day_hour_grid(times: np.ndarray) -> DayHourGrid:
    """Return the heat-map cells of time steps, given by their middles."""
    times = np.asarray(times).astype("datetime64[s]")
    day = _folded(times.astype("datetime64[D]"))
    bins = round(24 * 60 / _step_minutes(times))

    # Draw a few scattered days side by side; otherwise include days without data
    dates = np.unique(day)
    span = int((dates[-1] - dates[0]).astype(int)) + 1
    if len(dates) > _SPARSE * span:
        dates = dates[0] + np.arange(span)
    second = (times - times.astype("datetime64[D]")).astype(int)
    within_day = np.minimum(second * bins // 86400, bins - 1)
    return DayHourGrid(dates, bins, np.searchsorted(dates, day) * bins + within_day)


def _folded(day: np.ndarray) -> np.ndarray:
    # Map all years to one leap year, which contains every date
    if (day.max() - day.min()).astype(int) <= 366:
        return day
    month = day.astype("datetime64[M]")
    within = (day - month.astype("datetime64[D]")).astype(int)
    folded = np.datetime64("2024-01") + month.astype(int) % 12
    return np.asarray(folded.astype("datetime64[D]") + within)


def _step_minutes(times: np.ndarray) -> float:
    # Time step [min]: median interval between times, ignoring gaps of two hours or more
    gaps = np.diff(np.unique(times)).astype(int) / 60
    gaps = gaps[gaps < 120]
    minutes = float(np.median(gaps)) if len(gaps) else 60.0
    return min(60.0, max(float(_SHORTEST_MINUTES), minutes))


def heat_map(
    grid: DayHourGrid,
    *,
    image: str,
    occupied: Bool[np.ndarray, " time"],
    label: str,
    identifier: str = "heat-map",
) -> Markup:
    """Return a heat map: an image, given as a data URL, with axes."""
    area = {"x": _LEFT, "y": _TOP, "width": _WIDTH, "height": _HEIGHT}
    stretched = {"preserveAspectRatio": "none", "class_": "pixels"}
    return drawing(
        label,
        element("rect", **area, class_="no-data"),
        element("image", href=image, **area, **stretched),
        _schedule(grid, occupied),
        _hours(),
        _days(grid),
        width=_LEFT + _WIDTH + _RIGHT,
        height=_TOP + _HEIGHT + _BOTTOM,
        class_="heat-map",
        id=identifier,
        data_left=_LEFT,
        data_top=_TOP,
        data_width=_WIDTH,
        data_height=_HEIGHT,
    )


def _hours() -> Markup:
    marks = []
    for hour in range(0, 25, 6):
        y = _TOP + _HEIGHT * (1 - hour / 24)
        label = element("text", f"{hour:02d}:00", x=_LEFT - 8, y=f"{y + 4:.1f}")
        marks += [element("path", d=f"M{_LEFT - 4},{y:.1f}h4"), label]
    return element("g", *marks, class_="axis hours")


def _schedule(grid: DayHourGrid, occupied: Bool[np.ndarray, " time"]) -> Markup:
    # Lines where occupied hours begin or end on most days
    share = grid.fill(occupied.astype(float))
    known = np.isfinite(share)
    usual = np.where(known, share, 0).sum(axis=1) > 0.5 * known.sum(axis=1)
    lines = (
        element(
            "path", d=f"M{_LEFT},{_TOP + _HEIGHT * (1 - e / grid.bins):.1f}h{_WIDTH}"
        )
        for e in (np.flatnonzero(np.diff(usual.astype(int))) + 1).tolist()
    )
    return element("g", *lines, class_="schedule")


def _days(grid: DayHourGrid) -> Markup:
    marks = []
    for start, middle, name in grid.day_marks():
        if middle <= grid.days:
            x, centre = (_LEFT + _WIDTH * d / grid.days for d in (start, middle))
            label = element("text", name, x=f"{centre:.1f}", y=_TOP + _HEIGHT + 18)
            marks += [element("path", d=f"M{x:.1f},{_TOP + _HEIGHT}v5"), label]
    return element("g", *marks, class_="axis days")
