"""Hourly spectra of light at eyes, reduced to quantities of CIE S 026 and CIE 15.

The eyes are the sensors of the grids that `[output] spectral` names. Quantities of
daylight and electric light together are named `total_…`, and have no standard errors.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from clerestory.metrics.light_spectrum import Products, SpectralQuantities
from clerestory.metrics.melanopic import days_of_light
from clerestory.phases.blockwise_product import Block, BlockwiseProduct
from clerestory.phases.matrix_equation import States
from clerestory.study.control_inputs import ControlInputs
from clerestory.study.labels import sensor_labels

# Number of error components of the products
_COMPONENTS = 8

_UNITS = {"edi": "lux", "colour_temperature": "K"}
_NAMES = {
    "edi": "equivalent daylight (D65) illuminance",
    "colour_temperature": "correlated colour temperature",
    "duv": "distance from the Planckian locus in CIE 1960 (u, v)",
    "colour_rendering": "general colour rendering index Ra",
    "colour_rendering_red": "special colour rendering index R9",
}


def light_spectra(
    signals: ControlInputs,
    states: States,
    illuminance: xr.DataArray,
    electric: xr.Dataset,
) -> xr.Dataset:
    """Return quantities of the spectrum over (eye, time), with standard errors.

    `eye` are the sensors of the grids in `[output] spectral`; the dataset is empty
    without these. `illuminance` is that of all sensors, over (sensor, time), and
    `electric` the results on electric light.
    """
    inputs, grids = signals.inputs, signals.study.output.spectral
    if not grids:
        return xr.Dataset()
    rows = np.unique(np.concatenate([inputs.rows(grid) for grid in grids]))
    quantities = SpectralQuantities.of(signals.skies.whole.bands)
    lamps = _of_lamps(signals, rows, electric)
    found = _hourly(signals, quantities, rows, states, lamps)
    names = np.array(sensor_labels(inputs))[rows]
    found = found.assign_coords(
        eye=names,
        photoreceptor=list(quantities.receptors),
        time=signals.times,
    )
    lux = illuminance.values[rows].astype(np.float32)
    found["eye_illuminance"] = ("eye", "time"), lux, {"units": "lux"}
    share = days_of_light(
        lux,
        signals.times,
        step_hours=signals.step_minutes / 60,
        target_lux=500.0,
        period_hours=2.0,
        first_hour=7.0,
        last_begin=14.0,
    )
    words = "days with 500 lux for two hours from 7 to 16 h"
    found["bright_days"] = "eye", share, {"units": "1", "long_name": words}
    return found


def _hourly(
    signals: ControlInputs,
    quantities: SpectralQuantities,
    rows: Int[np.ndarray, " eye"],
    states: States,
    lamps: Float[np.ndarray, "band eye time"] | None,
) -> xr.Dataset:
    matrices, steps = signals.matrices, len(signals.times)
    product = BlockwiseProduct(
        matrices.windows,
        matrices.terms,
        signals.skies,
        states,
        np.eye(len(quantities.bands)),
        len(sensor_labels(signals.inputs)),
        summed=True,
    )
    held: dict[str, np.ndarray] = {}
    if lamps is not None:
        lamps = np.tensordot(quantities.weights(), lamps, axes=1)
        held = {
            f"total_{name}": values.astype(np.float32)
            for name, values in quantities.values(lamps).items()
        }
    for block in product.blocks():
        inside = (rows >= block.rows.start) & (rows < block.rows.stop)
        if inside.any() and len(block.steps):
            eyes = np.flatnonzero(inside)
            _put(
                held,
                block,
                rows[eyes] - block.rows.start,
                eyes,
                quantities,
                times=block.times.start + block.steps,
                shape=(len(rows), steps),
                lamps=lamps,
            )
    return xr.Dataset({name: _variable(name, x) for name, x in held.items()})


def _put(
    held: dict[str, np.ndarray],
    block: Block,
    inside: Int[np.ndarray, " chosen"],
    eyes: Int[np.ndarray, " chosen"],
    quantities: SpectralQuantities,
    *,
    times: Int[np.ndarray, " step"],
    shape: tuple[int, int],
    lamps: Products | None,
) -> None:
    # Quantities of the eyes in a block, and their errors
    weights = quantities.weights()
    light = np.tensordot(weights, block.terms[0][:, inside].astype(float), axes=1)
    parts = np.einsum("pb,kbes->kpes", weights, _components(block, inside))
    values, errors = quantities.values(light), quantities.errors(light, parts)
    of_receptors = weights[: len(quantities.receptors)]
    errors = {**errors, "edi": _edi_error(block, inside, of_receptors)}
    shown = {**values, **{f"{name}_error": one for name, one in errors.items()}}
    if lamps is not None:
        both = quantities.values(light + lamps[:, eyes[:, None], times])
        shown |= {f"total_{name}": one for name, one in both.items()}
    for name, one in shown.items():
        whole = held.setdefault(
            name,
            np.full(
                (*one.shape[:-2], *shape),
                0.0 if name.startswith("edi") else np.nan,  # no light in the dark
                np.float32,
            ),
        )
        whole[..., eyes[:, None], times] = one


def _of_lamps(
    signals: ControlInputs, rows: Int[np.ndarray, " eye"], electric: xr.Dataset
) -> Float[np.ndarray, "band eye time"] | None:
    # Electric light in bands; None without luminaires with spectra
    if signals.lamps is None or signals.lamps.spectra is None:
        return None
    full = signals.lamps.spectra[:, :, rows]
    output = electric["dimming"].values
    return np.asarray(np.einsum("zbe,zt->bet", full, output))


def _edi_error(
    block: Block,
    inside: Int[np.ndarray, " chosen"],
    weights: Float[np.ndarray, "receptor band"],
) -> Float[np.ndarray, "receptor eye step"]:
    # Standard error of linear quantities, from all deviations, as of illuminance
    square = np.zeros((len(weights), len(inside), len(block.steps)))
    for each in block.components:
        own = np.einsum("pb,kbes->kpes", weights, each.values[:, :, inside])
        square[..., each.steps] += np.square(own, dtype=float).sum(axis=0)
    return np.sqrt(square)


def _components(
    block: Block, inside: Int[np.ndarray, " chosen"]
) -> Float[np.ndarray, "component band eye step"]:
    # Deviations whose indices are equal modulo eight are added, as in other results
    first = block.terms[0][:, inside]
    total = np.zeros((_COMPONENTS, *first.shape))
    for each in block.components:
        for number, own in enumerate(each.values):
            total[number % _COMPONENTS][..., each.steps] += own[:, inside]
    return total


def _variable(
    name: str, values: np.ndarray
) -> tuple[Sequence[str], np.ndarray, dict[str, str]]:
    stem = name.removesuffix("_error").removeprefix("total_")
    axes = ("photoreceptor", "eye", "time")[-values.ndim :]
    words = _NAMES[stem]
    if name.startswith("total_"):
        words = f"{words} with electric light"
    if name.endswith("_error"):
        words = f"standard error of the {words}"
    return axes, values, {"units": _UNITS.get(stem, "1"), "long_name": words}
