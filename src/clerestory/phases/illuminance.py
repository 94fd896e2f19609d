"""Illuminance of sensors by the matrix equation, in memory or written to a file."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import h5netcdf  # type: ignore[import-untyped]
import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Float32

from clerestory.errors import MatrixError
from clerestory.files import replace_path
from clerestory.matrix.transfer_matrix import illuminance_dataset
from clerestory.phases.blockwise_product import Block, BlockwiseProduct
from clerestory.phases.matrix_equation import (
    Skies,
    States,
    Term,
    WindowMatrices,
    chains,
    equation_bands,
)
from clerestory.progress import Progress

# NetCDF chunk size of hourly results (sensors, time steps), for fast reading of few
# sensors or few time steps
_CHUNK = 256, 730


def illuminance(
    windows: Sequence[WindowMatrices],
    terms: Sequence[Term],
    skies: Skies,
    states: States | None = None,
    *,
    hours: Bool[np.ndarray, " time"] | None = None,
    file: Path | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Illuminance [lux] of sensors over time, with its standard error, as float32.

    Parameters
    ----------
    states : index of the shade state at each time step, per window group; default 0
    hours : mask of the time steps averaged in `mean_components`
    file : NetCDF file for the hourly values; by default they are kept in memory

    Returns
    -------
    `illuminance` and `standard_error` over (sensor, time); each term unsigned, if
    there are several terms; `mean_components` (component, sensor): error components of
    the mean illuminance over `hours`
    """
    axis = chains(windows, terms[0].part)[0].receivers
    if axis is None:
        message = "direct-sun coefficients C_ds have pixels as rows; sensors expected"
        raise MatrixError(message)
    product = BlockwiseProduct(
        windows,
        terms,
        skies,
        states,
        equation_bands(windows, skies).weights[None],
        axis.size,
    )
    shape = axis.size, len(skies.times)
    names = ["illuminance", "standard_error"]
    names += [term.name for term in terms] if len(terms) > 1 else []
    means = MeanComponents(hours, axis.size) if hours is not None else None
    if file is None:
        held = {name: np.zeros(shape, np.float32) for name in names}
        _fill(held, product, means, progress)
        lux, error, *_ = held.values()
        data = illuminance_dataset(lux, error, sensors=axis, times=skies.whole.columns)
        for term in names[2:]:
            data[term] = ("sensor", "time"), held[term], {"units": "lux"}
    else:
        with replace_path(file) as made, h5netcdf.File(made, "w") as stored:
            stored.dimensions = {"sensor": shape[0], "time": shape[1]}
            variables = {name: hourly_variable(stored, name, *shape) for name in names}
            for variable in variables.values():
                variable.attrs["units"] = "lux"
            long_name = "standard error of the illuminance"
            variables["standard_error"].attrs["long_name"] = long_name
            _fill(variables, product, means, progress)
        # Read illuminance from the file when needed, without a cache
        data = xr.open_dataset(file, engine="h5netcdf", cache=False)
        data = data.assign_coords(sensor=np.arange(axis.size), time=skies.times)
    if means is not None:
        data["mean_components"] = ("component", "sensor"), means.values()
    return data


def _fill(
    targets: Mapping[str, Any],
    product: BlockwiseProduct,
    means: "MeanComponents | None",
    progress: Progress | None,
) -> None:
    # Write the results to `targets`: arrays in memory or NetCDF variables
    done, whole = 0, product.count * len(product.skies.times)
    for block in product.blocks():
        terms = block.terms[:, 0]
        found = [terms.sum(axis=0), np.sqrt(_variance(block))]
        found += [
            term.sign * lux for term, lux in zip(product.terms, terms, strict=True)
        ]
        size = block.rows.stop - block.rows.start, block.times.stop - block.times.start
        for target, lux in zip(targets.values(), found, strict=False):
            every = np.zeros(size, np.float32)
            every[:, block.steps] = lux
            target[block.rows, block.times] = every
        if means is not None:
            means.add(block)
        if progress is not None:
            done += size[0] * size[1]
            progress(done / whole, f"{block.rows.stop} of {product.count} sensors")


def _variance(block: Block) -> Float32[np.ndarray, "row step"]:
    # Sum of the squares of all error components
    total: np.ndarray = np.zeros_like(block.terms[0, 0])
    for part in block.components:
        square = np.einsum("krs,krs->rs", part.values[:, 0], part.values[:, 0])
        if len(part.steps) == total.shape[1]:
            total += square
        else:
            total[:, part.steps] += square
    return total


class MeanComponents:
    """Error components of the mean illuminance over selected time steps."""

    def __init__(self, hours: Bool[np.ndarray, " time"], sensors: int) -> None:
        self._share = (hours / max(1, np.count_nonzero(hours))).astype(np.float32)
        self._sensors = sensors
        self._found: dict[tuple[int, int, int], np.ndarray] = {}

    def add(self, block: Block) -> None:
        """Add the error components of a block, weighted by the selected time steps."""
        share = self._share[block.times][block.steps]
        for part in block.components:
            own = part.values[:, 0] @ share[part.steps]
            known = self._found.setdefault(
                part.source, np.zeros((len(own), self._sensors), np.float32)
            )
            known[:, block.rows] += own

    def values(self) -> Float[np.ndarray, "component sensor"]:
        """Return the error components; the variance is the sum of squares."""
        none = np.zeros((0, self._sensors), np.float32)
        return np.concatenate([none, *self._found.values()])


def hourly_variable(
    file: h5netcdf.File, name: str, sensors: int, steps: int
) -> h5netcdf.Variable:
    """Create and return a NetCDF variable over the dimensions (sensor, time)."""
    chunks = min(_CHUNK[0], sensors), min(_CHUNK[1], steps)
    return file.create_variable(name, ("sensor", "time"), "f4", chunks=chunks)
