"""Results of a run: hourly illuminance, standard errors, metrics and run data.

`results.nc` depends on the study alone: two runs of the same study write identical
files. Run times, versions and the machine are in `run.json`.
"""

import io
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5netcdf  # type: ignore[import-untyped]
import h5py
import numpy as np
import xarray as xr

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.documents import json_value
from clerestory.errors import InputError
from clerestory.files import is_file, read_bytes, read_text, replace_path, write_text
from clerestory.phases.hourly_file import hourly_variable
from clerestory.study.result_checks import check_results, check_run

RESULTS_FILE = "results.nc"
RUN_FILE = "run.json"
_FORMAT = "clerestory results 1"

# Hourly arrays above this size [bytes] are read and written in blocks of sensors
_LARGE = 500_000_000

# Sensors or views per block in writing: 8760 hours of a block take 36 MB
_ROWS = 1024

# Axis of the views of view grids
VIEWS = "grid_view"


@dataclass(frozen=True, eq=False)
class Results:
    """Results of a study: content of results.nc and of run.json.

    See `docs/study-file.md`, *Output files*.
    """

    data: xr.Dataset
    run: Mapping[str, Any] = field(default_factory=dict)

    __repr__ = brief

    @property
    def title(self) -> str:
        """Title of the study."""
        return str(self.data.attrs["title"])

    def grids(self) -> list[str]:
        """Names of the sensor grids, in the order of the study."""
        return list(dict.fromkeys(str(name) for name in self.data["grid"].values))

    def thinned(self, most: int) -> "Results":
        """Return the results of at most `most` evenly spaced sensors, in memory.

        The entry `selection` of `run` states how many sensors are shown.

        >>> many = xr.Dataset({"lux": ("sensor", np.arange(10))})
        >>> few = Results(many).thinned(4)
        >>> few.data["lux"].values.tolist(), few.run["selection"]
        ([0, 3, 6, 9], '4 of 10 sensors')
        """
        count = self.data.sizes["sensor"]
        if count <= most:
            return self
        chosen = np.arange(0, count, -(-count // most))
        selection = f"{len(chosen):,} of {count:,} sensors"
        data = self.data.isel(sensor=chosen).load()
        return Results(data, {**self.run, "selection": selection})


def save_results(
    results: Results, folder: str | Path, *, hourly: Path | None = None
) -> Path:
    """Write `results.nc` and `run.json` atomically; return the path of `results.nc`.

    `hourly` is a NetCDF file, on the same disk, that already contains some of the
    hourly values under their names. It becomes `results.nc`.
    """
    folder = Path(folder)
    data = storable(results.data.assign_attrs(format=_FORMAT))
    stored = () if hourly is None else _variables(hourly)
    large = [str(name) for name in data if name in stored or _is_large(data[name])]
    write_text(
        folder / RUN_FILE, json.dumps(results.run, indent=2, sort_keys=True) + "\n"
    )
    small = data.drop_vars(large)
    with replace_path(folder / RESULTS_FILE) as file:
        if hourly is None:
            file.write_bytes(small.to_netcdf(engine="h5netcdf"))
        else:
            hourly.replace(file)
            small.to_netcdf(file, mode="a", engine="h5netcdf")
        for name in large:
            if name in stored:
                _describe_hourly(file, name, data[name])
            else:
                _append_hourly(file, name, data[name])
    return folder / RESULTS_FILE


def _variables(path: Path) -> list[str]:
    with h5netcdf.File(path, "r") as file:
        return [str(name) for name in file.variables]


def _describe_hourly(path: Path, name: str, data: xr.DataArray) -> None:
    with h5netcdf.File(path, "a") as file:
        file[name].attrs.update(data.attrs)


def storable(data: xr.Dataset) -> xr.Dataset:
    """Return data with escapes for the characters that HDF5 does not store.

    These are NUL and lone surrogates, in the texts of coordinates and attributes.
    """

    def plain(text: str) -> str:
        shown = text.replace("\0", "\\x00").encode(errors="backslashreplace")
        return shown.decode()

    texts = {}
    for name, values in data.coords.items():
        if values.ndim and values.dtype.kind in "OU":
            found = values.values.ravel().tolist()
            escaped = [plain(str(text)) for text in found]
            if escaped != found:
                shape = values.shape
                texts[name] = values.dims, np.array(escaped, object).reshape(shape)
    attributes = {k: plain(v) for k, v in data.attrs.items() if isinstance(v, str)}
    return data.assign_coords(texts).assign_attrs(attributes)


def _append_hourly(path: Path, name: str, data: xr.DataArray) -> None:
    # Copy in blocks of rows, as the hourly values may be in another file
    count, axes = len(data), [str(axis) for axis in data.dims]
    with h5netcdf.File(path, "a") as file:
        for axis in axes:
            if axis not in file.dimensions:
                file.dimensions[axis] = data.sizes[axis]
        kind, compress = data.dtype.str[1:], axes[0] == VIEWS
        variable = hourly_variable(file, name, axes, kind, compress=compress)
        for key, value in data.attrs.items():
            variable.attrs[key] = value
        for first in range(0, count, _ROWS):
            rows = slice(first, min(first + _ROWS, count))
            variable[rows] = data[rows].values


def _is_large(data: xr.DataArray) -> bool:
    axes = (data.dims[0], data.dims[-1]) if data.ndim > 1 else ()
    large = axes == ("sensor", "time") and data.nbytes > _LARGE
    return large or axes == (VIEWS, "time")


def read_results(path: str | Path) -> Results:
    """Return the results of a run, from its folder or its `results.nc`.

    Values in a large file are read on demand.
    """
    path = Path(path)
    path = path / RESULTS_FILE if path.is_dir() else path
    large = is_file(path) and path.stat().st_size > 2 * _LARGE
    source = path if large else io.BytesIO(read_bytes(path))
    try:
        # h5netcdf prints a traceback for files that are not HDF5
        with h5py.File(source, "r") as file:
            known = file.attrs.get("format") == _FORMAT
        message = f"is not the results.nc of a run ({_FORMAT} expected)"
        require(known, message, file=path)
        data = xr.open_dataset(source, engine="h5netcdf", cache=False)
        if not large:
            with data:
                data = data.load()
    except InputError:
        raise
    except Exception as error:  # HDF5 raises many exception types on damage
        raise InputError(
            "is damaged; the results.nc of a run expected", file=path
        ) from error
    check_results(data, path)
    return Results(data, _read_run(path.with_name(RUN_FILE)))


def _read_run(path: Path) -> dict[str, Any]:
    # run.json is optional
    if not path.is_file():
        return {}
    data = json_value(read_text(path), file=path)
    check_run(data, path)
    return dict(data)


def recorded_seconds(folder: Path, study: Mapping[str, Any]) -> dict[str, float]:
    """Return the seconds of each stage of an earlier run of the same study, if any."""
    run = _read_run(folder / RUN_FILE)
    same = run.get("study") == json.loads(json.dumps(study))
    return dict(run.get("seconds", {})) if same else {}


def sensor_names(grid: str, count: int) -> list[str]:
    """Names of the sensors of one grid, numbered from 1, such as "desks.1"."""
    return [f"{grid}.{number}" for number in range(1, count + 1)]


def float32(data: xr.DataArray) -> xr.DataArray:
    """Return hourly data in single precision, as in results.nc."""
    return data.astype(np.float32, keep_attrs=True)
