"""Annual heat maps: days from left to right, hours of the day upwards.

Each cell shows the mean of its time steps. Time steps may be shorter than an hour, days
may be missing, and several years are superposed.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.report.markup import Markup, element, join

_WIDTH, _HEIGHT = 1000, 240
_LEFT, _TOP, _RIGHT, _BOTTOM = 46, 8, 12, 26
_SHORTEST_MINUTES = 5

# Fraction of days with data below which the gaps between days are left out
_SPARSE = 0.3

# Lower limit of the colour scale [lux]
DARKEST_LUX = 10.0


@dataclass(frozen=True, eq=False)
class DayHourGrid:
    """Cells of a day × hour image.

    Attributes
    ----------
    dates : date of each column
    bins : number of cells per day
    cell : index of the cell of each time step; cells are ordered by day
    """

    dates: np.ndarray
    bins: int
    cell: Int[np.ndarray, " time"]

    @property
    def days(self) -> int:
        """Number of columns."""
        return len(self.dates)

    def fill(self, values: Float[np.ndarray, " time"]) -> Float[np.ndarray, "bin day"]:
        """Mean of the values in each cell, NaN without values; hour 0 first."""
        size = self.days * self.bins
        count = np.bincount(self.cell, minlength=size)
        total = np.bincount(self.cell, weights=values, minlength=size)
        with np.errstate(invalid="ignore"):
            return (total / count).reshape(self.days, self.bins).T


def day_hour_grid(times: np.ndarray) -> DayHourGrid:
    """Return the grid of cells for the given middles of time steps.

    Examples
    --------
    >>> hours = np.arange(8760) * np.timedelta64(1, "h")
    >>> year = np.datetime64("2023-01-01T00:30") + hours
    >>> grid = day_hour_grid(year)
    >>> grid.days, grid.bins, int(grid.cell[25])
    (365, 24, 25)
    """
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
    # Superpose years in one leap year, which contains all dates
    if (day.max() - day.min()).astype(int) <= 366:
        return day
    month = day.astype("datetime64[M]")
    within = (day - month.astype("datetime64[D]")).astype(int)
    folded = np.datetime64("2024-01") + month.astype(int) % 12
    return np.asarray(folded.astype("datetime64[D]") + within)


def _step_minutes(times: np.ndarray) -> float:
    # The median interval within a day is the time step
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
    """Return the heat map: axes around an image given as a data URL."""
    picture = element(
        "image",
        href=image,
        x=_LEFT,
        y=_TOP,
        width=_WIDTH,
        height=_HEIGHT,
        preserveAspectRatio="none",
        class_="pixels",
    )
    ground = element(
        "rect", x=_LEFT, y=_TOP, width=_WIDTH, height=_HEIGHT, class_="no-data"
    )
    return element(
        "svg",
        element("title", label),
        ground,
        picture,
        _schedule(grid, occupied),
        _hours(),
        _days(grid),
        viewBox=f"0 0 {_LEFT + _WIDTH + _RIGHT} {_TOP + _HEIGHT + _BOTTOM}",
        role="img",
        aria_label=label,
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
        marks.append(element("path", d=f"M{_LEFT - 4},{y:.1f}h4"))
        text = element("text", f"{hour:02d}:00", x=_LEFT - 8, y=f"{y + 4:.1f}")
        marks.append(text)
    return element("g", *marks, class_="axis hours")


def _schedule(grid: DayHourGrid, occupied: Bool[np.ndarray, " time"]) -> Markup:
    # Lines where occupied hours begin or end on most days
    share = grid.fill(occupied.astype(float))
    known = np.isfinite(share)
    usual = np.where(known, share, 0).sum(axis=1) > 0.5 * known.sum(axis=1)
    edges = np.flatnonzero(np.diff(usual.astype(int))) + 1
    lines = (
        element(
            "path", d=f"M{_LEFT},{_TOP + _HEIGHT * (1 - e / grid.bins):.1f}h{_WIDTH}"
        )
        for e in edges.tolist()
    )
    return element("g", *lines, class_="schedule")


def _days(grid: DayHourGrid) -> Markup:
    # Mark the months of a long period, or several days of a short one
    month = grid.dates.astype("datetime64[M]")
    if grid.days > 62 and grid.dates[-1] - grid.dates[0] < np.timedelta64(
        grid.days, "D"
    ):
        of_month = (grid.dates - month.astype("datetime64[D]")).astype(int)
        marked = np.flatnonzero(of_month == 0)
        names = [f"{m:%b}" for m in month[marked].astype(object)]
        middles = marked + 15.0
    else:
        marked = np.arange(0, grid.days, max(1, grid.days // 8))
        names = [f"{d.day} {d:%b}" for d in grid.dates[marked].astype(object)]
        middles = marked + 0.5
    marks = []
    for start, middle, name in zip(marked, middles, names, strict=True):
        if middle > grid.days:
            continue
        x, centre = (_LEFT + _WIDTH * d / grid.days for d in (start, middle))
        marks.append(element("path", d=f"M{x:.1f},{_TOP + _HEIGHT}v5"))
        text = element("text", name, x=f"{centre:.1f}", y=_TOP + _HEIGHT + 18)
        marks.append(text)
    return join(element("g", *marks, class_="axis days"))
