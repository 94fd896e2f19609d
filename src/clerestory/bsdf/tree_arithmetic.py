"""Cell-wise operations on tensor trees, and tristimulus values from Y, u' and v'."""

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np
from jaxtyping import Bool, Float, Float32, Int32

from clerestory.array_types import Values
from clerestory.bsdf.scattering_function import ScatteringFunction
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.checks import require

_Values = Float32[np.ndarray, " cells"]

# Slots of one part of a tree
Region = Int32[np.ndarray, " _"]

# Values of the nodes of one tree level, and whether each node is a branch node
Nodes = tuple[Float[np.ndarray, " nodes"], Bool[np.ndarray, " nodes"]]


def level_slots(levels: Iterable[Nodes], rank: int) -> list[Region]:
    """Slots of each level of a tree, or of several trees whose roots come first.

    The nodes of a level are the children of the branch nodes of the level above.
    """
    regions: list[Region] = []
    size = 0
    for value, branch in levels:
        region = float_bits(value)
        size += len(region)
        count = np.count_nonzero(branch)
        region[branch] = ~(size + (np.arange(count, dtype=np.int64) << rank))
        regions.append(region)
    return regions


def full_levels(rank: int, count: int) -> Iterator[Nodes]:
    """Levels of a tree without leaves, from the root on."""
    for level in range(count):
        yield np.zeros(1 << rank * level), np.ones(1 << rank * level, dtype=bool)


def combine(operation: Callable[..., Values], *trees: ScatteringTree) -> ScatteringTree:
    """Apply a function to the values of trees of equal rank, cell by cell.

    Each cell of the result is as small as the smallest cell of any tree there.
    `operation`: function of one array of values per tree; returns non-negative values.
    """
    rank = trees[0].rank
    regions = level_slots(_combined(operation, trees), rank)
    return ScatteringTree(np.concatenate(regions), rank, len(regions) - 1)


def _combined(
    operation: Callable[..., Values], trees: Sequence[ScatteringTree]
) -> Iterator[Nodes]:
    step = np.arange(1 << trees[0].rank, dtype=np.int32)
    codes = [tree.slots[:1] for tree in trees]
    while len(codes[0]):
        inner = np.any([code < 0 for code in codes], axis=0)
        value = np.zeros(len(inner), dtype=np.float32)
        leaves: list[_Values] = [code[~inner].view(np.float32) for code in codes]
        value[~inner] = operation(*leaves)
        yield value, inner

        # Descend; if a tree has a leaf here, all children have the value of this leaf
        below = []
        for code, tree in zip(codes, trees, strict=True):
            of = code[inner, None]
            place = np.where(of < 0, ~of + step, 0)
            below.append(np.where(of < 0, tree.slots[place], of).ravel())
        codes = below


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
    require(
        len(trees) == 3 and len({tree.rank for tree in trees}) == 1,
        "CIE Y, u' and v' differ in kind; three tensor trees of equal rank expected",
    )
    # CIE 15:2004, eq. 8.24 and 8.25, solved for X/Y and Z/Y; both are 1 where v' is 0
    x = combine(lambda y, u, v: y * _over(9 * u, 4 * v), *trees)
    z = combine(lambda y, u, v: y * _over(12 - 3 * u - 20 * v, 4 * v), *trees)
    return x, luminance, z


def _over(above: Values, below: Values) -> Values:
    ratio = np.divide(above, below, out=np.ones_like(above), where=below > 0)
    return np.asarray(ratio)
