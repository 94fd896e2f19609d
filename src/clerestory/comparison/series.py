"""Time series of measured or simulated quantities.

Series are named like results: `desks.3` is the illuminance of the third sensor of the
grid "desks", `eye.dgp` the daylight glare probability of the view "eye". The text after
the last dot is the quantity if it is a key of `UNITS`; otherwise the quantity is
illuminance.
"""

from dataclasses import dataclass, replace
from math import nan
from pathlib import Path
from typing import final

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import distinct, has_shape, require
from clerestory.errors import InputError, located
from clerestory.glare.indices import INDICES
from clerestory.study.results import read_results

ILLUMINANCE = "illuminance"
GLARE = tuple(index.name for index in INDICES)
# Unit of each quantity that may follow the last dot of a name
UNITS = {
    ILLUMINANCE: "lux",
    **{index.name: index.unit.removeprefix("1") for index in INDICES},
    "luminance": "cd/m²",
}


def quantity_of(name: str) -> str:
    """Return the quantity of a series from its name.

    >>> quantity_of("desks.3"), quantity_of("eye.dgp")
    ('illuminance', 'dgp')
    """
    last = name.rpartition(".")[2].lower()
    return last if last in UNITS else ILLUMINANCE


def group_of(name: str) -> str:
    """Return the name of the grid or view of a series.

    >>> group_of("desks.3"), group_of("eye.dgp"), group_of("Ev")
    ('desks', 'eye', 'Ev')
    """
    group, _, last = name.rpartition(".")
    return group if group and (last.isdigit() or last.lower() in UNITS) else name


@final
@dataclass(frozen=True, eq=False)
class Series:
    """Time series of several quantities at the same times.

    Attributes
    ----------
    names : names of the series
    times : centres of the time steps, local standard time, increasing
    values : values of each series, in the unit of the quantity; NaN if missing
    step_minutes : length of a time step [min]; 0 for instantaneous values
    utc_offset_hours : local standard time minus UTC [h]
    error : standard errors of the values; None if unknown
    position : position of the sensor of each series [m]; NaN if unknown
    source : file name of the series
    """

    names: tuple[str, ...]
    times: np.ndarray
    values: Float[np.ndarray, "series time"]
    step_minutes: float
    utc_offset_hours: float
    error: Float[np.ndarray, "series time"] | None = None
    position: Float[np.ndarray, "series 3"] | None = None
    source: str = ""

    __repr__ = brief

    def __post_init__(self) -> None:
        with located(file=self.source):
            distinct(self.names, "series")
            shape = len(self.names), len(self.times)
            has_shape(self.values, shape, "array of series over time")
            increasing = np.all(np.diff(self.times) > np.timedelta64(0))
            require(increasing, "times do not increase; increasing times expected")

    def on_clock(self, utc_offset_hours: float) -> "Series":
        """Return the series with times converted to another UTC offset [h]."""
        ahead = round((utc_offset_hours - self.utc_offset_hours) * 3600)
        times = self.times + np.timedelta64(ahead, "s")
        return replace(self, times=times, utc_offset_hours=utc_offset_hours)

    def shifted(self, minutes: float) -> "Series":
        """Return the series with the given minutes added to the times."""
        later = np.timedelta64(round(minutes * 60), "s")
        return replace(self, times=self.times + later)

    def select(self, names: list[str]) -> "Series":
        """Return the series with the given names, in this order."""
        rows = [self.names.index(name) for name in names]
        return replace(
            self,
            names=tuple(names),
            values=self.values[rows],
            error=None if self.error is None else self.error[rows],
            position=None if self.position is None else self.position[rows],
        )


def simulated_series(path: str | Path) -> Series:
    """Return the series of a run, given its folder or its `results.nc`.

    The series of sensors have the names of the sensors; the series of views are
    `VIEW.dgp`, `VIEW.dgi` … and `VIEW.illuminance`, the vertical illuminance at the eye
    [lux].

    Raises
    ------
    InputError : the file contains no results, or no UTC offset (older versions)
    """
    data = read_results(path).data
    if "utc_offset_hours" not in data.attrs:
        raise InputError("results without UTC offset; run the study again", file=path)
    hourly = data[["illuminance", "standard_error"]].transpose("sensor", "time")
    views = _views(data)

    # Standard errors and positions of views are unknown
    error, position = (
        np.pad(
            each.values.astype(float), ((0, len(views)), (0, 0)), constant_values=nan
        )
        for each in (hourly["standard_error"], data["position"])
    )
    return Series(
        (*map(str, data["sensor"].values), *views),
        data["time"].values.astype("datetime64[s]"),
        np.vstack([hourly["illuminance"].values, *views.values()]).astype(float),
        float(data.attrs["step_minutes"]),
        float(data.attrs["utc_offset_hours"]),
        error,
        position,
        str(path),
    )


def _views(data: xr.Dataset) -> dict[str, np.ndarray]:
    return {
        f"{view}.{kind}": data[f"glare_{kind}"].sel(view=view).values
        for view in (data["view"].values if "view" in data.dims else ())
        for kind in (*GLARE, "illuminance")
        if f"glare_{kind}" in data
    }
