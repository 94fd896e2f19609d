"""Hourly values of many sensors in files, written some sensors at a time."""

from pathlib import Path

import h5netcdf  # type: ignore[import-untyped]
import xarray as xr

from clerestory.phases.illuminance import hourly_variable

# Sensors written at a time: a year of them takes 36 MB
_SENSORS = 1024


def append_hourly(path: Path, name: str, data: xr.DataArray) -> None:
    """Append values over (sensor, time) to a NetCDF file that has these dimensions.

    Parameters
    ----------
    data : may lie in another file; no more than some sensors are in memory
    """
    sensors, steps = data.shape
    with h5netcdf.File(path, "a") as file:
        variable = hourly_variable(file, name, sensors, steps)
        for key, value in data.attrs.items():
            variable.attrs[key] = value
        for first in range(0, sensors, _SENSORS):
            rows = slice(first, min(first + _SENSORS, sensors))
            variable[rows] = data[rows].values
