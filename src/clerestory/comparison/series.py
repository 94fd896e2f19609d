"""Time series of measured or simulated quantities.

The names of series are those of results: `desks.3` is the illuminance of the third
sensor of the grid "desks", `eye.dgp` the daylight glare probability of the view "eye".
The quantity of a series is the part of the name after the last dot if this is a key of
`UNITS`, otherwise illuminance.
"""

from dataclasses import dataclass, replace
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError
from clerestory.glare.indices import INDICES

ILLUMINANCE = "illuminance"
GLARE = tuple(index.name for index in INDICES)
# Unit of each quantity that may be the last part of a name
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
    times : centres of the steps, local standard time, increasing
    values : values of each series, in the unit of the quantity; NaN if missing
    step_minutes : length of a step [min]; 0 for instantaneous values
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

    def __post_init__(self) -> None:
        twice = next((n for n in self.names if self.names.count(n) > 1), None)
        if twice is not None:
            raise InputError(f'two series "{twice}"; one expected', file=self.source)
        if self.values.shape != (len(self.names), len(self.times)):
            raise InputError(
                f"values of shape {self.values.shape}; ({len(self.names)} series,"
                f" {len(self.times)} steps) expected",
                file=self.source,
            )
        if np.any(np.diff(self.times) <= np.timedelta64(0)):
            raise InputError(
                "times do not increase; increasing times expected", file=self.source
            )

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
