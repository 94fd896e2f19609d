"""Weather of one place: direct and diffuse irradiance at each time step.

Times are local standard time at the centre of the step, for which the solar position is
computed. The months of a typical year are from different years, so dates are set to one
fixed year: 2023, or 2024 if the data include 29 February.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError

TYPICAL_YEAR = 2023
TYPICAL_LEAP_YEAR = 2024


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
        limits = {
            "latitude": (self.latitude_deg, 90.0),
            "longitude": (self.longitude_deg, 180.0),
            "UTC offset": (self.utc_offset_hours, 14.0),
        }
        for name, (value, limit) in limits.items():
            if not abs(value) <= limit:
                raise InputError(
                    f"{name} {value}; a number from {-limit} to {limit} expected"
                )
        if not -500.0 <= self.elevation <= 9000.0:
            raise InputError(f"elevation {self.elevation} m; -500 to 9000 expected")


@dataclass(frozen=True, eq=False)
class Illuminance:
    """Measured direct and diffuse illuminance over time.

    Attributes
    ----------
    direct_normal, diffuse_horizontal : direct normal and diffuse horizontal illuminance
        [lux]
    """

    direct_normal: Float[np.ndarray, " time"]
    diffuse_horizontal: Float[np.ndarray, " time"]

    def select(self, steps: slice | np.ndarray) -> "Illuminance":
        """Return some of the time steps, by slice or boolean mask."""
        return Illuminance(self.direct_normal[steps], self.diffuse_horizontal[steps])


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
    times : centres of the steps, local standard time
    step_minutes : length of a step [min]
    direct_normal : direct normal irradiance, DNI [W/m²]
    diffuse_horizontal : diffuse horizontal irradiance, DHI [W/m²]
    dew_point_c : dew point [°C], NaN where unknown; None if unknown at all steps
    illuminance : measured illuminance; None if it is computed from the irradiance
    source : name of the weather file
    notes : corrections of the data, with numbers of values

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
    direct_normal: Float[np.ndarray, " time"]
    diffuse_horizontal: Float[np.ndarray, " time"]
    dew_point_c: Float[np.ndarray, " time"] | None = None
    illuminance: Illuminance | None = None
    source: str = ""
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _ = self.site
        for what, unit, light in (
            ("irradiance", "W/m²", self),
            ("illuminance", "lux", self.illuminance),
        ):
            if light is not None:
                self._check(f"direct normal {what}", light.direct_normal, unit)
                self._check(
                    f"diffuse horizontal {what}", light.diffuse_horizontal, unit
                )
        if self.dew_point_c is not None and self.dew_point_c.shape != self.times.shape:
            raise InputError(
                f"{len(self.dew_point_c)} dew points; {len(self)} expected"
            )
        if len(self) == 0:
            raise InputError("weather without time steps; at least one expected")
        if np.any(np.diff(self.times) <= np.timedelta64(0)):
            late = int(np.argmax(np.diff(self.times) <= np.timedelta64(0))) + 1
            raise InputError(
                f"times do not increase at {self.times[late]}; increasing times"
                " expected"
            )
        if not self.step_minutes > 0:
            raise InputError(
                f"steps of {self.step_minutes} minutes; a positive length expected"
            )

    def _check(self, name: str, values: Float[np.ndarray, " value"], unit: str) -> None:
        if values.shape != self.times.shape:
            raise InputError(f"{len(values)} values of {name}; {len(self)} expected")
        if not np.all(np.isfinite(values) & (values >= 0)):
            raise InputError(
                f"{name} is negative or not finite; {unit} from 0 expected"
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
            illuminance=None if lux is None else lux.select(steps),
        )
