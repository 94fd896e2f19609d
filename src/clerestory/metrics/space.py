"""Space of a building: the results of its sensors, and the floor area of each.

All figures of a standard are evaluated per space, and for all spaces weighted by floor
area.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.metrics.replicates import errors_of
from clerestory.metrics.spatial_metrics import RoomShare

# Name of the union of all spaces
WHOLE = "all spaces"

# Names of the direct sun illuminance and its errors in the results of a run
DIRECT = {
    "illuminance": "direct_open",
    "standard_error": "direct_open_error",
    "error_components": "direct_open_components",
}


def direct_sun(data: xr.Dataset) -> xr.Dataset:
    """Direct sun illuminance and its errors, under the names of the illuminance."""
    known = {name: own for own, name in DIRECT.items() if name in data}
    return data[list(known)].rename(known)


@dataclass(frozen=True, eq=False)
class Space:
    """Results of one space, or of all spaces.

    Attributes
    ----------
    name : name of the space
    data : results of a run for its sensors, views, view grids and openings, see
        `Results.data`
    area : floor area represented by each sensor [m²]
    from_hour, to_hour : hours of the day that are evaluated by LM-83
    """

    name: str
    data: xr.Dataset
    area: Float[np.ndarray, " sensor"]
    from_hour: float = 8.0
    to_hour: float = 18.0

    @cached_property
    def hours(self) -> Bool[np.ndarray, " time"]:
        """Evaluated hours of LM-83."""
        return occupied_hours(
            self.data["time"].values, from_hour=self.from_hour, to_hour=self.to_hour
        )

    @property
    def step_hours(self) -> float:
        """Length of a time step [h]."""
        return float(self.data.attrs.get("step_minutes", 60)) / 60

    @cached_property
    def study(self) -> dict[str, Any]:
        """Keys and values of the study; empty if unknown."""
        return dict(json.loads(self.data.attrs.get("study", "{}")))

    @cached_property
    def sun(self) -> xr.Dataset | None:
        """Direct sun illuminance and its errors; None unless the sun is exact."""
        return direct_sun(self.data) if "sun_hours" in self.data else None

    def shares(
        self, metric: Any, hourly: xr.Dataset, hours: np.ndarray, **options: Any
    ) -> RoomShare:
        """Return a metric of `spatial_metrics` of this space, with its replicates."""
        found: RoomShare = metric(
            hourly["illuminance"],
            hours,
            area=self.area,
            **errors_of(hourly),
            **options,
        )
        return found


def spaces_of(data: xr.Dataset) -> tuple[Space, ...]:
    """Return the spaces of the results of a run; by default every grid is a space.

    Sensors without a space are left out.
    """
    owner = data["space" if "space" in data else "grid"].values.astype(str)
    names = [name for name in dict.fromkeys(owner.tolist()) if name]
    return tuple(_space(data, owner, [name], name) for name in names)


def whole_of(data: xr.Dataset, spaces: Sequence[Space]) -> Space:
    """Return all spaces as one, for figures weighted by floor area."""
    owner = data["space" if "space" in data else "grid"].values.astype(str)
    return _space(data, owner, [space.name for space in spaces], WHOLE)


def _space(
    data: xr.Dataset, owner: np.ndarray, names: Sequence[str], name: str
) -> Space:
    part = data.isel(sensor=np.flatnonzero(np.isin(owner, names)))
    for axis in ("view", "grid_view", "opening", "window"):
        if f"{axis}_space" in part:
            member = np.isin(part[f"{axis}_space"].values.astype(str), names)
            part = part.isel({axis: np.flatnonzero(member)})
    equal = np.ones(part.sizes["sensor"])
    area = part["floor_area"].values.astype(float) if "floor_area" in part else equal
    return Space(name, part, area)
