"""Postprocessing of traced BSDFs: reciprocal means, tree reduction, errors."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from clerestory.array_types import ExitIncident
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.resample import reciprocal_mean
from clerestory.bsdf.scattering_function import OTHER_SIDE, Function, ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import combine, reduce_tree
from clerestory.bsdfgen.trace_request import Functions
from clerestory.errors import InputError


def reciprocal_with_errors(functions: Functions) -> Functions:
    """Return functions averaged with their reciprocals, with reduced standard errors.

    A BSDF value and its reciprocal are independent estimates of the same quantity.
    """
    means = reciprocal_mean(Bsdf(functions)).functions
    found: Functions = {}
    for (channel, name), mean in means.items():
        part = functions[channel, name]
        other = functions.get((channel, OTHER_SIDE.get(name, name)))
        if isinstance(mean, ScatteringMatrix) and isinstance(other, ScatteringMatrix):
            mean = replace(mean, standard_error=_matrix_error(part, other))
        if isinstance(mean, ScatteringTree) and mean.rank == 4:
            mean = replace(mean, standard_error=_tree_error(part, other))
        found[channel, name] = mean
    return found


def _matrix_error(
    part: ScatteringFunction, other: ScatteringMatrix
) -> ExitIncident | None:
    if not isinstance(part, ScatteringMatrix):
        return None
    one, two = part.standard_error, other.standard_error
    if one is None or two is None:
        return None
    # A pair of patches that is its own reciprocal has one estimate: keep the error
    back = ScatteringMatrix(two, other.exits, other.incidents).reciprocal().values
    number = np.arange(one.size, dtype=float).reshape(one.shape)
    reverse = ScatteringMatrix(number, part.exits, part.incidents).reciprocal().values
    own = (number == reverse) & (part is other)
    return np.asarray(np.where(own, one, np.hypot(one, back) / 2))


def _tree_error(
    part: ScatteringFunction, other: ScatteringFunction | None
) -> ScatteringTree | None:
    one, two = (getattr(of, "standard_error", None) for of in (part, other))
    back = two.reciprocal() if isinstance(two, ScatteringTree) else None
    if not (isinstance(one, ScatteringTree) and isinstance(back, ScatteringTree)):
        return None
    return combine(lambda a, b: np.hypot(a, b) / 2, one, back)


def one_transmission(functions: Functions) -> Functions:
    """Return rank 4 trees without front transmission if there is back transmission.

    As in genBSDF, the back transmission is kept; the front transmission is its
    reciprocal.
    """
    return {
        (band, name): part
        for (band, name), part in functions.items()
        if name != "transmission_front" or (band, "transmission_back") not in functions
    }


def reduced(functions: Functions, percent: float) -> Functions:
    """Return trees with similar cells merged, without standard errors."""
    return {
        key: reduce_tree(part, percent).tree
        if isinstance(part, ScatteringTree)
        else part
        for key, part in functions.items()
    }


def error_functions(
    functions: Mapping[tuple[str, Function], ScatteringFunction],
) -> Functions:
    """Return the standard errors of BSDF values, on the same patches or cells."""
    found: Functions = {}
    for (channel, name), part in functions.items():
        error = getattr(part, "standard_error", None)
        if channel in ("cie-u", "cie-v"):
            continue
        if error is None:
            raise InputError(
                f"{channel} {name.replace('_', ' ')} has no standard errors;"
                " a traced BSDF without tree reduction expected"
            )
        if isinstance(part, ScatteringMatrix):
            error = ScatteringMatrix(error, part.exits, part.incidents)
        found[channel, name] = error
    return found
