"""Weather from measured series, by quality control and irradiance decomposition.

Measured components are global horizontal, diffuse horizontal and direct normal
irradiance or illuminance; two of the three determine the third.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float, Int

from clerestory.errors import InputError
from clerestory.sky.gap_filling import repair_irradiance, warn_of_corrections
from clerestory.sky.illuminance_conversion import irradiance_of
from clerestory.sky.irradiance_decomposition import (
    Decomposition,
    Irradiance,
    split_irradiance,
)
from clerestory.sky.solar_position import SunPosition, sun_at
from clerestory.sky.weather import Illuminance, Site, Weather

Quantity = Literal[
    "global_horizontal",
    "diffuse_horizontal",
    "direct_normal",
    "global_illuminance",
    "diffuse_illuminance",
    "direct_illuminance",
]

_Role = Literal["global_horizontal", "diffuse_horizontal", "direct_normal"]

# Argument of `split_irradiance` for each measured quantity
_IRRADIANCE: dict[Quantity, _Role] = {role: role for role in get_args(_Role)}
_ILLUMINANCE: dict[Quantity, _Role] = {
    "global_illuminance": "global_horizontal",
    "diffuse_illuminance": "diffuse_horizontal",
    "direct_illuminance": "direct_normal",
}

# The limits of irradiance apply to illuminance at 100 lux per W/m²
_LUX_PER_WATT = 100.0


@dataclass(frozen=True, eq=False)
class Measurement:
    """Irradiance or illuminance measured at one site.

    Attributes
    ----------
    site : location of the instruments
    times : centres of the steps, local standard time
    step_minutes : length of a step [min]
    series : measured irradiance [W/m²] or illuminance [lux] by quantity; NaN where
        missing
    file, lines : file, and line number of each step
    names : column name of each quantity
    dew_point_c : dew point [°C], NaN where missing; None if not measured
    """

    site: Site
    times: np.ndarray
    step_minutes: float
    series: Mapping[Quantity, Float[np.ndarray, " time"]]
    file: str | Path
    lines: Int[np.ndarray, " time"]
    names: Mapping[Quantity, str] = field(default_factory=dict)
    dew_point_c: Float[np.ndarray, " time"] | None = None


def weather_of(
    measurement: Measurement, *, decomposition: Decomposition = "erbs"
) -> Weather:
    """Return the weather of a measurement; one warning lists all corrections."""
    site, times = measurement.site, measurement.times
    sun = sun_at(site, times)
    watts, notes = _repaired(measurement, _IRRADIANCE, scale=1.0, unit="W/m²")
    lux, more = _repaired(measurement, _ILLUMINANCE, scale=_LUX_PER_WATT, unit="lux")
    notes += more
    illuminance = None
    if lux:
        illuminance, more = _illuminance(lux, times, sun, file=measurement.file)
        notes += more
    if watts or illuminance is None:
        parts = _split(watts, times, sun, decomposition=decomposition)
    else:
        parts = Irradiance(
            *irradiance_of(
                illuminance, times=times, sun=sun, dew_point_c=measurement.dew_point_c
            )
        )
    notes += parts.notes
    warn_of_corrections(notes, file=measurement.file)
    return Weather(
        **asdict(site),
        times=times,
        step_minutes=measurement.step_minutes,
        direct_normal=parts.direct_normal,
        diffuse_horizontal=parts.diffuse_horizontal,
        dew_point_c=measurement.dew_point_c,
        illuminance=illuminance,
        source=str(measurement.file),
        notes=notes + _assumptions(watts, illuminance, decomposition),
    )


def _assumptions(
    watts: Mapping[_Role, np.ndarray],
    illuminance: Illuminance | None,
    decomposition: Decomposition,
) -> tuple[str, ...]:
    if set(watts) == {"global_horizontal"}:
        return (f"global irradiance decomposed by the {decomposition} model",)
    if not watts and illuminance is not None:
        return ("irradiance from illuminance by Perez's luminous efficacy",)
    return ()


def _repaired(
    measurement: Measurement, kind: Mapping[Quantity, _Role], *, scale: float, unit: str
) -> tuple[dict[_Role, Float[np.ndarray, " time"]], tuple[str, ...]]:
    # Return the series by component, in W/m² or hundreds of lux
    notes: tuple[str, ...] = ()
    series = {}
    for quantity, role in kind.items():
        if quantity in measurement.series:
            values, made = repair_irradiance(
                measurement.series[quantity],
                name=measurement.names.get(quantity, quantity.replace("_", " ")),
                times=measurement.times,
                file=measurement.file,
                lines=measurement.lines,
                scale=scale,
                unit=unit,
            )
            series[role] = values / scale
            notes += made
    return series, notes


def _illuminance(
    series: Mapping[_Role, Float[np.ndarray, " time"]],
    times: np.ndarray,
    sun: SunPosition,
    *,
    file: str | Path,
) -> tuple[Illuminance, tuple[str, ...]]:
    if len(series) < 2:
        raise InputError(
            "only one component of illuminance; two of global, diffuse and"
            " direct expected,"
            " since decomposition models apply to irradiance",
            file=file,
        )
    parts = _split(series, times, sun)
    lux = Illuminance(
        parts.direct_normal * _LUX_PER_WATT, parts.diffuse_horizontal * _LUX_PER_WATT
    )
    return lux, parts.notes


def _split(
    series: Mapping[_Role, Float[np.ndarray, " time"]],
    times: np.ndarray,
    sun: SunPosition,
    *,
    decomposition: Decomposition = "erbs",
) -> Irradiance:
    return split_irradiance(
        times,
        sun,
        global_horizontal=series.get("global_horizontal"),
        diffuse_horizontal=series.get("diffuse_horizontal"),
        direct_normal=series.get("direct_normal"),
        decomposition=decomposition,
    )
