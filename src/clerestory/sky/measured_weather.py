"""Weather from measured irradiance or illuminance, with quality control.

1. Values from -10 to 0 W/m² (zero offset of a pyranometer) are set to 0.
2. Missing values and values below -10 or above 1500 W/m² (physically impossible) are
   replaced by linear interpolation in time. More than 10 % of such values are an error.
3. Direct normal irradiance is limited to the extraterrestrial irradiance.
4. Direct normal and diffuse horizontal irradiance are computed from any two of global,
   diffuse and direct irradiance or illuminance, or from global irradiance alone.

The numbers of corrected values are stored with the weather and given in a warning.
"""

import warnings
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Literal, get_args

import numpy as np
from jaxtyping import Bool

from clerestory.array_types import Series
from clerestory.checks import require
from clerestory.errors import ClerestoryWarning
from clerestory.sky.irradiance_decomposition import (
    Component,
    Decomposition,
    Irradiance,
    limit_to_extraterrestrial,
    split_irradiance,
)
from clerestory.sky.sky_state import irradiance_of
from clerestory.sky.solar_position import sun_at
from clerestory.sky.table_cells import DataRows
from clerestory.sky.time_steps import typical_step
from clerestory.sky.weather import Illuminance, Site, Weather

Quantity = Literal[
    "global_horizontal",
    "diffuse_horizontal",
    "direct_normal",
    "global_illuminance",
    "diffuse_illuminance",
    "direct_illuminance",
]

_IRRADIANCE: dict[Quantity, Component] = {name: name for name in get_args(Component)}
_ILLUMINANCE: dict[Quantity, Component] = {
    "global_illuminance": "global_horizontal",
    "diffuse_illuminance": "diffuse_horizontal",
    "direct_illuminance": "direct_normal",
}

# Limits of irradiance [W/m²]; those of illuminance [lux] are 100 times as large
_ZERO_OFFSET, _LARGEST = -10.0, 1500.0
_LUX_PER_WATT = 100.0

_LARGEST_SHARE_OF_GAPS = 0.1

_Notes = tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Measurement:
    """Irradiance [W/m²] or illuminance [lux] at one site; NaN where missing.

    Times are local standard time at the centres of the time steps. File rows and column
    names are used in messages.
    """

    site: Site
    times: np.ndarray
    step_minutes: float
    series: Mapping[Quantity, Series]
    rows: DataRows
    names: Mapping[Quantity, str] = field(default_factory=dict)
    dew_point_c: Series | None = None


def weather_of_components(
    site: Site,
    times: np.ndarray,
    rows: DataRows,
    parts: Irradiance,
    *,
    step_minutes: float | None = None,
    dew_point_c: Series | None = None,
) -> Weather:
    """Return weather from direct and diffuse irradiance; values at night are kept."""
    step = typical_step(times) if step_minutes is None else step_minutes
    series: dict[Quantity, np.ndarray] = {
        "direct_normal": parts.direct_normal,
        "diffuse_horizontal": parts.diffuse_horizontal,
    }
    measurement = Measurement(site, times, step, series, rows, dew_point_c=dew_point_c)
    watts, repairs = _repaired(measurement, _IRRADIANCE, scale=1.0, unit="W/m²")
    direct, limited = limit_to_extraterrestrial(watts["direct_normal"], times)
    notes = parts.notes + repairs + limited
    parts = Irradiance(direct, watts["diffuse_horizontal"], notes)
    return _weather(measurement, parts)


def weather_of(
    measurement: Measurement, *, decomposition: Decomposition = "erbs"
) -> Weather:
    """Return the weather from a measurement; irradiance at night is set to zero.

    `decomposition` is the model applied if only global irradiance is measured.
    """
    times, rows = measurement.times, measurement.rows
    sun = sun_at(measurement.site, times)
    watts, notes = _repaired(measurement, _IRRADIANCE, scale=1.0, unit="W/m²")
    lux, more = _repaired(measurement, _ILLUMINANCE, scale=_LUX_PER_WATT, unit="lux")
    notes += more
    illuminance: Illuminance | None = None
    assumptions: _Notes = ()
    if lux:
        require(
            len(lux) > 1,
            "only one component of illuminance; two of global, diffuse and direct"
            " expected, since decomposition models apply to irradiance",
            file=rows.file,
        )
        parts = split_irradiance(times, sun, lux)
        notes += parts.notes
        direct, diffuse = parts.direct_normal, parts.diffuse_horizontal
        illuminance = Illuminance(direct * _LUX_PER_WATT, diffuse * _LUX_PER_WATT)
    if watts or illuminance is None:
        parts = split_irradiance(times, sun, watts, decomposition=decomposition)
        if set(watts) == {"global_horizontal"}:
            note = f"global irradiance decomposed by the {decomposition} model"
            assumptions = (note,)
    else:
        dew_point = measurement.dew_point_c
        found = irradiance_of(illuminance, times=times, sun=sun, dew_point_c=dew_point)
        parts = Irradiance(*found)
        assumptions = ("irradiance from illuminance by Perez's luminous efficacy",)
    parts = replace(parts, notes=notes + parts.notes)
    return _weather(measurement, parts, illuminance, assumptions)


def _weather(
    measurement: Measurement,
    parts: Irradiance,
    illuminance: Illuminance | None = None,
    assumptions: _Notes = (),
) -> Weather:
    # Issue one warning with all corrections
    file = measurement.rows.file
    if parts.notes:
        message = f"{file}: {'; '.join(parts.notes)}"
        warnings.warn(message, ClerestoryWarning, stacklevel=5)
    return Weather(
        **asdict(measurement.site),
        times=measurement.times,
        step_minutes=measurement.step_minutes,
        direct_normal=parts.direct_normal,
        diffuse_horizontal=parts.diffuse_horizontal,
        dew_point_c=measurement.dew_point_c,
        illuminance=illuminance,
        source=str(file),
        notes=parts.notes + assumptions,
    )


def _repaired(
    measurement: Measurement,
    kind: Mapping[Quantity, Component],
    *,
    scale: float,
    unit: str,
) -> tuple[dict[Component, Series], _Notes]:
    # Return corrected series by component [W/m² or 100 lux], and notes of corrections
    notes: _Notes = ()
    series = {}
    for quantity, component in kind.items():
        if quantity in measurement.series:
            values, made = _filled(measurement, quantity, scale, unit)
            series[component] = values / scale
            notes += made
    return series, notes


def _filled(
    measurement: Measurement, quantity: Quantity, scale: float, unit: str
) -> tuple[Series, _Notes]:
    values, rows = measurement.series[quantity], measurement.rows
    plain = quantity.replace("_", " ")
    plain += "" if quantity in _ILLUMINANCE else " irradiance"
    name = measurement.names.get(quantity, plain)
    lowest, largest = scale * _ZERO_OFFSET, scale * _LARGEST
    offset = (values < 0) & (values >= lowest)
    gap = ~((values >= lowest) & (values <= largest))
    notes = []
    if np.any(offset):
        notes.append(
            f"{name}: {np.count_nonzero(offset)} values just below zero set to zero"
        )
    if np.any(gap):
        first = int(rows.lines[np.argmax(gap)])
        count = f"{np.count_nonzero(gap)} of {len(values)} values"
        require(
            np.mean(gap) <= _LARGEST_SHARE_OF_GAPS,
            f"{count} of {name} are missing or impossible; at least 90 % from"
            f" {lowest:g} to {largest:g} {unit} expected",
            file=rows.file,
            line=first,
        )
        notes.append(
            f"{name}: {count} missing or impossible, interpolated (first: line"
            f" {first}; at most {_longest(gap)} in a row)"
        )

    # Replace missing values by linear interpolation in time
    moment = (measurement.times - measurement.times[0]).astype(float)
    filled = np.where(offset, 0.0, values)
    filled[gap] = np.interp(moment[gap], moment[~gap], filled[~gap])
    return filled, tuple(notes)


def _longest(gap: Bool[np.ndarray, " time"]) -> int:
    # Largest number of consecutive missing values
    ends = np.flatnonzero(np.diff(np.concatenate([[0], gap.astype(int), [0]])))
    return int(np.max(ends[1::2] - ends[::2]))
