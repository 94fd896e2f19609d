"""Quality control and gap filling of irradiance in weather files.

1. Values from -10 to 0 W/m² (zero offset of a pyranometer) are set to 0.
2. Missing values and values below -10 or above 1500 W/m² (physically impossible) are
   replaced by linear interpolation in time. More than 10 % of such values are an error.
3. Direct normal irradiance is limited to the extraterrestrial irradiance.

The numbers of corrections are stored as notes of the weather and reported by a warning.
"""

import warnings
from dataclasses import asdict
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.sky.irradiance_decomposition import limit_to_extraterrestrial
from clerestory.sky.table_cells import DataRows
from clerestory.sky.weather import Site, Weather

_ZERO_OFFSET = -10.0
_LARGEST = 1500.0
_LARGEST_SHARE_OF_GAPS = 0.1


def repair_irradiance(
    values: Float[np.ndarray, " time"],
    *,
    name: str,
    times: np.ndarray,
    file: str | Path,
    lines: Int[np.ndarray, " time"],
    scale: float = 1.0,
    unit: str = "W/m²",
) -> tuple[Float[np.ndarray, " time"], tuple[str, ...]]:
    """Return irradiance with interpolated gaps, and notes on the corrections.

    Parameters
    ----------
    values : irradiance, or illuminance with `scale` and `unit`; NaN where missing
    name : name of the quantity, for messages
    times : centres of the steps
    file, lines : file and line number of each value
    scale, unit : factor from W/m² to the unit of the values, and symbol of the unit
    """
    notes = []
    lowest, largest = scale * _ZERO_OFFSET, scale * _LARGEST
    offset = (values < 0) & (values >= lowest)
    gap = ~((values >= lowest) & (values <= largest))
    if np.any(offset):
        notes.append(
            f"{name}: {np.count_nonzero(offset)} values just below zero set to zero"
        )
    if np.any(gap):
        first = int(lines[np.argmax(gap)])
        count = f"{np.count_nonzero(gap)} of {len(values)} values"
        if np.mean(gap) > _LARGEST_SHARE_OF_GAPS:
            raise InputError(
                f"{count} of {name} are missing or impossible; at least 90 % from"
                f" {lowest:g} to {largest:g} {unit} expected",
                file=file,
                line=first,
            )
        notes.append(
            f"{name}: {count} missing or impossible, interpolated (first: line"
            f" {first}; at most {_longest(gap)} in a row)"
        )

    # Interpolate across the gaps in time
    moment = (times - times[0]).astype(float)
    filled = np.where(offset, 0.0, values)
    filled[gap] = np.interp(moment[gap], moment[~gap], filled[~gap])
    return filled, tuple(notes)


def repaired_weather(
    site: Site,
    times: np.ndarray,
    rows: DataRows,
    *,
    direct_normal: Float[np.ndarray, " time"],
    diffuse_horizontal: Float[np.ndarray, " time"],
    dew_point_c: Float[np.ndarray, " time"] | None = None,
    step_minutes: float,
    notes: tuple[str, ...] = (),
) -> Weather:
    """Return the weather from the columns of a file, after quality control."""
    filled = []
    for name, values in (
        ("direct normal irradiance", direct_normal),
        ("diffuse horizontal irradiance", diffuse_horizontal),
    ):
        series, made = repair_irradiance(
            values, name=name, times=times, file=rows.file, lines=rows.lines
        )
        filled.append(series)
        notes += made
    direct, made = limit_to_extraterrestrial(filled[0], times)
    notes += made
    warn_of_corrections(notes, file=rows.file)
    return Weather(
        **asdict(site),
        times=times,
        step_minutes=step_minutes,
        direct_normal=direct,
        diffuse_horizontal=filled[1],
        dew_point_c=dew_point_c,
        source=str(rows.file),
        notes=notes,
    )


def warn_of_corrections(notes: tuple[str, ...], *, file: str | Path) -> None:
    """Issue one warning with all corrections to the data of a file."""
    if notes:
        warnings.warn(f"{file}: {'; '.join(notes)}", ClerestoryWarning, stacklevel=5)


def _longest(gap: Bool[np.ndarray, " time"]) -> int:
    # Largest number of consecutive missing values
    ends = np.flatnonzero(np.diff(np.concatenate([[0], gap.astype(int), [0]])))
    return int(np.max(ends[1::2] - ends[::2]))
