"""Weather of one place: direct and diffuse irradiance at each time step.

Times are local standard time at the centre of the step, for which the solar position is
computed. The months of a typical year are from different years, so dates are set to one
fixed year: 2023, or 2024 if the data include 29 February.
"""

from dataclasses import dataclass, replace

import numpy as np

from clerestory.argument_types import checked_fields
from clerestory.array_types import Series
from clerestory.brief_repr import brief
from clerestory.checks import not_negative, positive, require, same_length, within

TYPICAL_YEAR = 2023
TYPICAL_LEAP_YEAR = 2024


# Longest time step [min]
_DAY = 1440


@dataclass(frozen=True)
class Site:
    """Location of a weather station or a simulation.

    Attributes
    ----------
    latitude_deg, longitude_deg : latitude, positive north, and longitude, positive east
        [°]
    utc_offset_hours : local standard time minus UTC [h]
    elevation : elevation above sea level [m]
    place : name of the location
    """

    latitude_deg: float
    longitude_deg: float
    utc_offset_hours: float
    elevation: float = 0.0
    place: str = ""

    def __post_init__(self) -> None:
        within(self.latitude_deg, "latitude", least=-90, most=90, unit="degrees")
        within(self.longitude_deg, "longitude", least=-180, most=180, unit="degrees")
        within(self.utc_offset_hours, "UTC offset", least=-14, most=14, unit="h")
        within(self.elevation, "elevation", least=-500, most=9000, unit="m")


@dataclass(frozen=True, eq=False)
class Illuminance:
    """Measured direct normal and diffuse horizontal illuminance over time [lux]."""

    direct_normal: Series
    diffuse_horizontal: Series

    __repr__ = brief


@checked_fields
@dataclass(frozen=True, eq=False)
class Weather:
    """Direct and diffuse irradiance over time at one place.

    Attributes
    ----------
    place : name of the place
    latitude_deg, longitude_deg : latitude, positive north, and longitude, positive east
        [°]
    elevation : elevation above sea level [m]
    utc_offset_hours : local standard time minus UTC [h]
    times : centres of the time steps, local standard time
    step_minutes : length of a time step [min]
    direct_normal : direct normal irradiance, DNI [W/m²]
    diffuse_horizontal : diffuse horizontal irradiance, DHI [W/m²]
    dew_point_c : dew point [°C], NaN where unknown; None if unknown at all steps
    illuminance : measured illuminance; None if it is computed from the irradiance
    source : name of the weather file
    notes : corrections, with the number of corrected values

    Raises
    ------
    InputError : a coordinate is out of range, arrays differ in length, times do not
        increase, or irradiance or illuminance is negative or not finite
    """

    place: str
    latitude_deg: float
    longitude_deg: float
    elevation: float
    utc_offset_hours: float
    times: np.ndarray
    step_minutes: float
    direct_normal: Series
    diffuse_horizontal: Series
    dew_point_c: Series | None = None
    illuminance: Illuminance | None = None
    source: str = ""
    notes: tuple[str, ...] = ()

    __repr__ = brief

    def __post_init__(self) -> None:
        _ = self.site
        for light, kind, unit in (
            (self, "irradiance", "W/m²"),
            (self.illuminance, "illuminance", "lux"),
        ):
            if light is not None:
                for values, component in (
                    (light.direct_normal, "direct normal"),
                    (light.diffuse_horizontal, "diffuse horizontal"),
                ):
                    name = f"{component} {kind}"
                    same_length(values, self.times, f"values of {name}", "time steps")
                    not_negative(values, name, unit=unit)
        if self.dew_point_c is not None:
            same_length(self.dew_point_c, self.times, "dew points", "time steps")
        require(len(self), "weather without time steps; at least one expected")
        positive(self.step_minutes, "length of a time step", unit="minutes")
        require(
            self.step_minutes <= _DAY,
            f"length of a time step is {self.step_minutes:g} minutes; at most {_DAY}"
            " expected",
        )
        late = np.diff(self.times, prepend=self.times[:1] - 1) <= np.timedelta64(0)
        require(
            not np.any(late),
            f"times do not increase at {self.times[np.argmax(late)]}; increasing times"
            " expected",
        )

    def __len__(self) -> int:
        return len(self.times)

    @property
    def site(self) -> Site:
        """Location and time zone."""
        return Site(
            self.latitude_deg,
            self.longitude_deg,
            self.utc_offset_hours,
            self.elevation,
            self.place,
        )

    def select(self, steps: slice | np.ndarray) -> "Weather":
        """Return some of the time steps, by slice or boolean mask."""
        dew_point, lux = self.dew_point_c, self.illuminance
        return replace(
            self,
            times=self.times[steps],
            direct_normal=self.direct_normal[steps],
            diffuse_horizontal=self.diffuse_horizontal[steps],
            dew_point_c=None if dew_point is None else dew_point[steps],
            illuminance=lux
            and Illuminance(lux.direct_normal[steps], lux.diffuse_horizontal[steps]),
        )
