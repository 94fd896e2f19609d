"""Second-order Taylor expansion of results in parameters of materials.

E(θ + δ) ≈ E + Σ_i E_i δ_i + ½ Σ_ij E_ij δ_i δ_j
"""

import importlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int8

from clerestory.argument_types import checked_arguments
from clerestory.checks import has_shape, one_of, require
from clerestory.matrix.derivatives import Parameter, pair_indices
from clerestory.matrix.error_components import UNIT

if TYPE_CHECKING:
    from collections.abc import Callable

    import xarray as xr

    from clerestory.matrix.transfer_matrix import TransferMatrix

# Names of the result variables
FIRST, FIRST_ERROR = "illuminance_derivative", "illuminance_derivative_error"
FIRST_PARTS, SECOND = "derivative_components", "illuminance_second_derivative"

# Size of a block of draws × sensors × time steps [bytes]
_BLOCK = 1 << 27


def expanded(
    value: Float[np.ndarray, "..."],
    first: Float[np.ndarray, "parameter ..."],
    second: Float[np.ndarray, "pair ..."] | None,
    changes: Float[np.ndarray, "draw parameter"],
) -> Float[np.ndarray, "draw ..."]:
    """Return values at changed parameters, by the second-order expansion.

    Without second derivatives, the expansion is linear.

    >>> one = np.ones(1)
    >>> expanded(one, 2 * one[None], 6 * one[None], np.array([[0.0], [0.1]])).ravel()
    array([1.  , 1.23])
    """
    kind = value.dtype
    terms, factors = [first], [changes]
    if second is not None:
        pairs = pair_indices(len(first))
        halves = [
            changes[:, i] * changes[:, j] * (0.5 if i == j else 1.0) for i, j in pairs
        ]
        terms, factors = [first, second], [changes, np.stack(halves, axis=1)]
    found = np.repeat(value[None], len(changes), axis=0)
    for term, factor in zip(terms, factors, strict=True):
        flat = term.reshape(len(term), -1)
        found += (factor.astype(kind) @ flat.astype(kind)).reshape(found.shape)
    return found


def expanded_matrix(
    matrix: "TransferMatrix", changes: Mapping[str, float]
) -> "TransferMatrix":
    """Return a matrix for changed parameters, by the second-order expansion.

    Its error components are those of the linear expansion. A matrix without derivatives
    does not depend on the parameters.

    Raises
    ------
    InputError : no derivative by a parameter
    """
    of = matrix.derivatives
    if of is None:
        return matrix
    change = parameter_changes(of.names, changes)[None]
    values = expanded(matrix.values, of.first, of.second, change)[0]
    parts = matrix.components
    if parts is not None and of.components is not None:
        parts = np.stack(
            [
                expanded(own, by, None, change)[0]
                for own, by in zip(parts, of.components, strict=True)
            ]
        )
    return replace(matrix, values=values, components=parts, derivatives=None)


@checked_arguments
def expanded_illuminance(
    data: "xr.Dataset",
    draws: Float[np.ndarray, "draw parameter"],
    *,
    least: float | None = 0.0,
) -> Iterator[tuple[slice, Float[np.ndarray, "draw sensor time"]]]:
    """Yield illuminance [lux] for other values of the parameters, by blocks of sensors.

    Parameters
    ----------
    data : `illuminance`, and its derivatives as `illuminance_derivatives` returns them
    draws : values of all parameters, in the order of `data.parameter`
    least : least illuminance of the result; None: no limit

    Yields
    ------
    range of the sensors, and their illuminance (draw, sensor, time)

    Raises
    ------
    InputError : no derivatives, or another number of parameters
    """
    named = FIRST in data
    require(named, "no derivatives in the results; a study with [sensitivity] expected")
    theta = np.asarray(data["parameter_value"].values, dtype=float)
    has_shape(draws, (len(draws), len(theta)), "array of parameter values")
    changes = draws - theta
    sensors, times = data["illuminance"].shape
    each = max(1, _BLOCK // max(1, 4 * len(draws) * times))
    for start in range(0, sensors, each):
        rows = slice(start, min(start + each, sensors))
        second = None
        if SECOND in data:
            second = data[SECOND][:, rows].values
            all_pairs = len(pair_indices(len(theta)))
            has_shape(second, (all_pairs, *second.shape[1:]), "second derivatives")
        value = data["illuminance"][rows].values
        first = data[FIRST][:, rows].values
        found = expanded(value, first, second, changes)
        yield rows, found if least is None else np.maximum(found, least)


def parameter_changes(
    names: Sequence[str], changes: Mapping[str, float]
) -> Float[np.ndarray, " parameter"]:
    """Return the changes of all parameters, those not given being zero."""
    for name in changes:
        one_of(name, "parameter", choices=list(names))
    return np.array([changes.get(name, 0.0) for name in names])


def parameter_steps(
    values: Float[np.ndarray, " parameter"], quantities: np.ndarray, step: float
) -> Float[np.ndarray, "parameter 2"]:
    """Return the steps of parameters downwards and upwards, within their ranges.

    >>> steps = parameter_steps(np.array([0.98]), np.array(["reflectance"]), 0.05)
    >>> steps.round(2).tolist()
    [[-0.05, 0.02]]
    """
    most = np.where(quantities == "scale", np.inf, np.maximum(1, values))
    low, high = np.maximum(-step, -values), np.minimum(step, most - values)
    return np.column_stack([low, high])


def labelled_derivatives(
    parameters: Sequence[Parameter],
    first: Float[np.ndarray, "parameter sensor time"],
    error: Float[np.ndarray, "parameter sensor time"],
    second: Float[np.ndarray, "pair sensor time"] | None,
    *,
    times: np.ndarray,
    parts: Int8[np.ndarray, "parameter sensor component time"] | None = None,
    pairs: Sequence[tuple[int, int]] | None = None,
) -> "xr.Dataset":
    """Return derivatives of illuminance and their standard errors as a dataset.

    `parts` are the error components in units of the standard error / 127; `pairs` are
    the parameters of the second derivatives, by default all pairs.
    """
    axes, unit = ("parameter", "sensor", "time"), {"units": "lux per unit"}
    values = [parameter.value for parameter in parameters]
    quantities = [parameter.quantity for parameter in parameters]
    names = [parameter.name for parameter in parameters]
    # Import here: loading xarray takes longer than most products
    data: xr.Dataset = importlib.import_module("xarray").Dataset(
        {
            FIRST: (axes, first, unit),
            FIRST_ERROR: (axes, error, unit),
            "parameter_value": ("parameter", values),
            "parameter_quantity": ("parameter", quantities),
        },
        coords={"parameter": names, "time": times},
    )
    if parts is not None:
        axes_of_parts = "parameter", "sensor", "component", "time"
        how = {"units": f"standard error / {UNIT}"}
        data[FIRST_PARTS] = axes_of_parts, parts, how
    if second is not None:
        pairs = pair_indices(len(names)) if pairs is None else pairs
        data[SECOND] = ("pair", *axes[1:]), second, {"units": "lux per unit squared"}
        data["pair_first"] = "pair", [names[i] for i, _ in pairs]
        data["pair_second"] = "pair", [names[j] for _, j in pairs]
    return data


def with_derivatives(
    matrix: "TransferMatrix", evaluate: "Callable[[TransferMatrix], xr.Dataset]"
) -> "xr.Dataset":
    """Return the illuminance of a matrix, with its derivatives if it has any.

    `evaluate` is the function, linear in the matrix, that returns the illuminance.
    """
    of = matrix.derivatives
    plain = evaluate(replace(matrix, derivatives=None))
    if of is None:
        return plain
    first = [evaluate(matrix.derivative(name)) for name in of.names]
    second = [evaluate(matrix.second_derivative(*pair)) for pair in of.pairs]
    lux, error = "illuminance", "standard_error"
    derivatives = labelled_derivatives(
        of.parameters,
        np.stack([each[lux].values for each in first]),
        np.stack([each[error].values for each in first]),
        np.stack([each[lux].values for each in second]),
        times=plain["time"].values,
    )
    return plain.merge(derivatives)
