"""Tristimulus values of tensor trees from luminance Y and CIE 1976 u', v'."""

import numpy as np

from clerestory.array_types import Values
from clerestory.bsdf.scattering_function import ScatteringFunction
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import combine
from clerestory.errors import InputError


def xyz_functions(
    luminance: ScatteringFunction, u: ScatteringFunction, v: ScatteringFunction
) -> tuple[ScatteringFunction, ScatteringFunction, ScatteringFunction]:
    """Return the functions of X, Y and Z from those of Y, u' and v'."""
    trees = [part for part in (luminance, u, v) if isinstance(part, ScatteringTree)]
    if len(trees) < 3 or len({tree.rank for tree in trees}) > 1:
        raise InputError("CIE u' and v' of another kind than Y; tensor trees expected")
    return combine(_x, *trees), luminance, combine(_z, *trees)


# CIE 15:2004, eq. 8.24 and 8.25, solved for X/Y and Z/Y; white where v' is 0.
def _x(y: Values, u: Values, v: Values) -> Values:
    return np.asarray(y * _over(9 * u, 4 * v))


def _z(y: Values, u: Values, v: Values) -> Values:
    return np.asarray(y * _over(12 - 3 * u - 20 * v, 4 * v))


def _over(above: Values, below: Values) -> Values:
    ratio = np.divide(above, below, out=np.ones_like(above), where=below > 0)
    return np.asarray(ratio)
