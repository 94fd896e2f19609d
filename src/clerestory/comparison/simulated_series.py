"""Simulated time series: illuminance of sensors and glare indices of views."""

from pathlib import Path

import numpy as np
import xarray as xr

from clerestory.comparison.series import GLARE, Series
from clerestory.errors import InputError
from clerestory.study.results import read_results


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
    names = [str(name) for name in data["sensor"].values]
    values = [np.asarray(data["illuminance"].transpose("sensor", "time").values)]
    errors = [np.asarray(data["standard_error"].transpose("sensor", "time").values)]
    places = [np.asarray(data["position"].values, dtype=float)]
    for name, view in _views(data):
        names.append(name)
        values.append(view[None])
        errors.append(np.full((1, view.size), np.nan))
        places.append(np.full((1, 3), np.nan))
    return Series(
        tuple(names),
        data["time"].values.astype("datetime64[s]"),
        np.concatenate(values).astype(float),
        float(data.attrs["step_minutes"]),
        float(data.attrs["utc_offset_hours"]),
        np.concatenate(errors).astype(float),
        np.concatenate(places),
        str(path),
    )


def _views(data: xr.Dataset) -> list[tuple[str, np.ndarray]]:
    if "view" not in data.dims:
        return []
    kinds = [*GLARE, "illuminance"]
    return [
        (f"{view}.{kind}", data[f"glare_{kind}"].sel(view=view).values)
        for view in data["view"].values
        for kind in kinds
        if f"glare_{kind}" in data
    ]
