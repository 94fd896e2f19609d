"""Hourly results in NetCDF files, from which values are read on demand.

A file is open only while it is read, so that it can be renamed and extended: that of
the illuminance of a study becomes its file of results.
"""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import h5netcdf  # type: ignore[import-untyped]
import h5py
import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

# NetCDF chunk size of hourly results (sensors, time steps), for fast reading of few
# sensors or few time steps
_CHUNK = 256, 730


def hourly_variable(
    file: h5netcdf.File,
    name: str,
    axes: Sequence[str],
    kind: str = "f4",
    *,
    compress: bool = False,
) -> h5netcdf.Variable:
    """Create and return a NetCDF variable over (sensor, time) and axes between them."""
    how = {"compression": "gzip", "shuffle": True} if compress else {}
    sizes = [file.dimensions[axis].size for axis in axes]
    chunks = (min(_CHUNK[0], sizes[0]), *sizes[1:-1], min(_CHUNK[1], sizes[-1]))
    return file.create_variable(name, tuple(axes), kind, chunks=chunks, **how)


def read_hourly(
    path: Path, axes: Iterable[tuple[str, Sequence[str]]]
) -> dict[str, xr.Variable]:
    """Return variables of a file by name, given with their axes, to read on demand."""
    return {
        name: xr.Variable(own, indexing.LazilyIndexedArray(_Stored(path, name)))
        for name, own in axes
    }


class _Stored(BackendArray):
    # Values of a variable of a file that is closed in the meantime

    def __init__(self, path: Path, name: str) -> None:
        self._path, self._name = path, name
        with h5py.File(path, "r") as file:
            self.shape, self.dtype = file[name].shape, file[name].dtype

    def __getitem__(self, key: Any) -> np.ndarray:
        support = indexing.IndexingSupport.OUTER_1VECTOR
        found = indexing.explicit_indexing_adapter(key, self.shape, support, self._read)
        return np.asarray(found)

    def _read(self, key: tuple[Any, ...]) -> np.ndarray:
        # Selected steps from all between the first and last: HDF5 selects slowly
        steps, few = key[-1], isinstance(key[-1], np.ndarray) and key[-1].size > 0
        if few:
            first = int(steps.min())
            key = *key[:-1], slice(first, int(steps.max()) + 1)
        with h5py.File(self._path, "r") as file:
            found = np.asarray(file[self._name][key])
        return np.take(found, steps - first, axis=-1) if few else found
