"""Illuminance of sensors by the matrix equation, in memory or written to a file."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import h5netcdf  # type: ignore[import-untyped]
import numpy as np
import xarray as xr
from jaxtyping import Float, Float32

from clerestory.errors import MatrixError
from clerestory.files import replace_path
from clerestory.matrix.error_components import COUNT, UNIT, add_components, compressed
from clerestory.matrix.transfer_matrix import illuminance_dataset
from clerestory.phases.blockwise_product import BlockwiseProduct
from clerestory.phases.column_light import runs
from clerestory.phases.hourly_file import hourly_variable, read_hourly
from clerestory.phases.matrix_equation import (
    Skies,
    States,
    Term,
    WindowMatrices,
    chains,
    equation_bands,
)
from clerestory.phases.product_factors import Components
from clerestory.phases.recent_values import RecentValues
from clerestory.progress import Progress

# Name of the error components, and axes of hourly results
PARTS = "error_components"
_AXES, _PART_AXES = ("sensor", "time"), ("sensor", "component", "time")


def illuminance(
    windows: Sequence[WindowMatrices],
    terms: Sequence[Term],
    skies: Skies,
    states: States | None = None,
    *,
    weights: Float[np.ndarray, " band"] | None = None,
    file: Path | None = None,
    progress: Progress | None = None,
    recent: RecentValues | None = None,
    errors: bool = True,
    apart: Mapping[str, str] | None = None,
) -> xr.Dataset:
    """Illuminance [lux] of sensors over time, with its standard error, as float32.

    Parameters
    ----------
    states : index of the shade state at each time step, per window group; default 0
    weights : weights of the bands; default: luminous efficacy
    file : NetCDF file for the hourly values; by default they are kept in memory
    recent : products D S that several simulations have in common
    errors : whether to compute standard errors; otherwise they are zero
    apart : names of `illuminance`, `standard_error` and `error_components` of the last
        term by itself, which are then returned as well

    Returns
    -------
    `illuminance` and `standard_error` over (sensor, time); `error_components` over
    (sensor, component, time), see `clerestory.matrix.error_components`; each term
    unsigned, if there are several terms
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
        (equation_bands(windows, skies).weights if weights is None else weights)[None],
        axis.size,
        errors=errors,
        recent=recent or RecentValues(),
        threads=True,
    )
    names = ["illuminance", "standard_error"]
    names += [term.name for term in terms] if len(terms) > 1 else []
    kinds = {**dict.fromkeys(names, (_AXES, "f4")), PARTS: (_PART_AXES, "i1")}
    more = {own: kinds[name] for name, own in (apart or {}).items()}
    kinds |= more
    sizes = {"sensor": axis.size, "component": COUNT, "time": len(skies.times)}
    if file is None:
        held = {
            name: np.zeros([sizes[axis] for axis in axes], kind)
            for name, (axes, kind) in kinds.items()
        }
        _fill(held, product, progress, apart)
        lux, error = (held[name] for name in names[:2])
        data = illuminance_dataset(lux, error, sensors=axis, times=skies.whole.columns)
        for name in [*names[2:], PARTS, *more]:
            data[name] = kinds[name][0], held[name]
    else:
        with replace_path(file) as made, h5netcdf.File(made, "w") as stored:
            stored.dimensions = sizes
            variables = {
                name: hourly_variable(stored, name, *kind)
                for name, kind in kinds.items()
            }
            _fill(variables, product, progress, apart)
        axes = ((name, kind[0]) for name, kind in kinds.items())
        data = xr.Dataset(read_hourly(file, axes))
        data = data.assign_coords(sensor=np.arange(axis.size), time=skies.times)
    for name in names:
        data[name].attrs["units"] = "lux"
    data["standard_error"].attrs["long_name"] = "standard error of the illuminance"
    data[PARTS].attrs["units"] = f"standard error / {UNIT}"
    for name, own in (apart or {}).items():
        data[own].attrs = data[name].attrs
    return data


def _fill(
    targets: Mapping[str, Any],
    product: BlockwiseProduct,
    progress: Progress | None,
    apart: Mapping[str, str] | None,
) -> None:
    # Write the results to `targets`: arrays in memory or NetCDF variables
    done, whole = 0, product.count * len(product.skies.times)
    last = len(product.terms) - 1
    for block in product.blocks():
        terms = block.terms[:, 0]
        found = _with_errors(terms.sum(axis=0), block.components)
        for term, lux in zip(product.terms, terms, strict=True):
            found.setdefault(term.name, term.sign * lux)
        if apart is not None:
            own = [each for each in block.components if each.source[0] == last]
            of_term = _with_errors(product.terms[last].sign * terms[last], own)
            found |= {new: of_term[name] for name, new in apart.items()}
        steps = block.times.stop - block.times.start
        for name, target in targets.items():
            every = np.zeros((*found[name].shape[:-1], steps), target.dtype)
            for some, own_steps in runs(block.steps):
                every[..., some] = found[name][..., own_steps]
            target[block.rows, ..., block.times] = every
        if progress is not None:
            done += (block.rows.stop - block.rows.start) * steps
            progress(done / whole, f"{block.rows.stop} of {product.count} sensors")


def _with_errors(
    lux: Float32[np.ndarray, "row step"], components: Sequence[Components]
) -> dict[str, np.ndarray]:
    # Illuminance, its standard error, and its error components in compressed form
    total: np.ndarray = np.zeros_like(lux)
    parts = np.zeros((COUNT, *total.shape), np.float32)
    for each in components:
        own = each.values[:, 0]
        square = np.einsum("krs,krs->rs", own, own)
        if len(each.steps) == total.shape[1]:
            total += square
            add_components(parts, own)
        else:
            total[:, each.steps] += square
            some = parts[..., each.steps]
            add_components(some, own)
            parts[..., each.steps] = some
    error = np.sqrt(total)
    return {"illuminance": lux, "standard_error": error, PARTS: compressed(parts)}
