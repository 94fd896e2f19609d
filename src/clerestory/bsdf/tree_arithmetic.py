"""Cell-wise operations on tensor trees, and tristimulus values from Y, u' and v'."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float, Float32, Int32

from clerestory.array_types import Slots, Values
from clerestory.bsdf.scattering_function import ScatteringFunction
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.errors import InputError

_Values = Float32[np.ndarray, " cells"]


def combine(operation: Callable[..., Values], *trees: ScatteringTree) -> ScatteringTree:
    """Apply a function to the values of one or more trees, cell by cell.

    Each cell of the result is as small as the smallest cell of any tree there.

    Parameters
    ----------
    operation : function of one array of values per tree; returns non-negative values
    trees : one or more trees of equal rank

    Examples
    --------
    >>> def constant(value):
    ...     slots = np.array([value], dtype=np.float32).view(np.int32)
    ...     return ScatteringTree(slots, 4, 0)
    >>> combine(np.add, constant(1.0), constant(2.0)).extrema()
    (3.0, 3.0)
    """
    rank = trees[0].rank
    step = np.arange(1 << rank, dtype=np.int32)
    codes = [tree.slots[:1] for tree in trees]
    regions: list[Slots] = []
    size, level = 1, -1
    while len(codes[0]):
        level += 1
        inner = np.any([code < 0 for code in codes], axis=0)
        region = np.empty(len(inner), dtype=np.int32)
        values: list[_Values] = [code[~inner].view(np.float32) for code in codes]
        region[~inner] = float_bits(operation(*values))
        count = int(inner.sum())
        region[inner] = ~(size + (np.arange(count, dtype=np.int64) << rank))
        regions.append(region)
        size += count << rank

        # Descend; if a tree has a leaf here, all children have the value of this leaf
        below = []
        for code, tree in zip(codes, trees, strict=True):
            of = code[inner, None]
            place = np.where(of < 0, ~of + step, 0)
            below.append(np.where(of < 0, tree.slots[place], of).ravel())
        codes = below
    return ScatteringTree(np.concatenate(regions), rank, level)


def float_bits(value: Float[np.ndarray, " cells"]) -> Int32[np.ndarray, " cells"]:
    """Slots that encode float values; negative values become zero."""
    single: Float32[np.ndarray, " cells"] = np.abs(np.maximum(value, 0)).astype(
        np.float32
    )
    return single.view(np.int32)


def xyz_functions(
    luminance: ScatteringFunction, u: ScatteringFunction, v: ScatteringFunction
) -> tuple[ScatteringFunction, ScatteringFunction, ScatteringFunction]:
    """Return the scattering functions of X, Y and Z, from functions of Y, u' and v'."""
    trees = [part for part in (luminance, u, v) if isinstance(part, ScatteringTree)]
    if len(trees) < 3 or len({tree.rank for tree in trees}) > 1:
        raise InputError(
            "CIE Y, u' and v' differ in kind; three tensor trees of equal rank expected"
        )
    return combine(_x, *trees), luminance, combine(_z, *trees)


# CIE 15:2004, eq. 8.24 and 8.25, solved for X/Y and Z/Y; both are 1 where v' is 0.
def _x(y: Values, u: Values, v: Values) -> Values:
    return np.asarray(y * _over(9 * u, 4 * v))


def _z(y: Values, u: Values, v: Values) -> Values:
    return np.asarray(y * _over(12 - 3 * u - 20 * v, 4 * v))


def _over(above: Values, below: Values) -> Values:
    ratio = np.divide(above, below, out=np.ones_like(above), where=below > 0)
    return np.asarray(ratio)


def slot_means(tree: ScatteringTree) -> Float32[np.ndarray, " slots"]:
    """Mean value of the cells below each slot of a tree."""
    width = 1 << tree.rank
    values = np.where(tree.slots < 0, 0, tree.slots).astype(np.int32)
    means = values.view(np.float32).astype(np.float64)
    levels, code, at = [], tree.slots[:1], np.zeros(1, dtype=np.int64)
    while True:
        inner = code < 0
        if not inner.any():
            break
        below = ~code[inner].astype(np.int64)
        levels.append((at[inner], below))
        at = (below[:, None] + np.arange(width)).ravel()
        code = tree.slots[at]
    for slot, below in reversed(levels):
        means[slot] = means[below[:, None] + np.arange(width)].mean(axis=1)
    return means.astype(np.float32)
