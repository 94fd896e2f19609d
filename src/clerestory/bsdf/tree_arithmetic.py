"""Operations on tensor trees: cell-by-cell arithmetic, and merging of similar cells.

Cells are merged as in rttree_reduce: a branch node is kept if the measure √((max − min)
/ (√mean + 0.03)) of the BSDF values below the node exceeds a threshold. The threshold
is a percentile of the measure over all blocks of smallest cells: at 95 % about one
block in twenty is kept.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float, Float32, Int32, Int64

from clerestory.array_types import Values
from clerestory.bsdf.scattering_function import ScatteringFunction
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.checks import require
from clerestory.hemisphere.klems import klems

_Values = Float32[np.ndarray, " cells"]

# Consecutive slots of a tree
Region = Int32[np.ndarray, " _"]

# BSDF of the nodes of one tree level, and whether each node is a branch node
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
    """Upper levels of a full tree, which have only branch nodes; root first."""
    for level in range(count):
        yield np.zeros(1 << rank * level), np.ones(1 << rank * level, dtype=bool)


def combine(operation: Callable[..., Values], *trees: ScatteringTree) -> ScatteringTree:
    """Apply a function to the values of trees of equal rank, cell by cell.

    Cells of the result are as small as the smallest cell of any tree at the same place.
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

        # Descend one level; below a leaf, all children have the value of the leaf
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
        "CIE Y, u' and v' are not tensor trees of equal rank; three trees of rank 3 or"
        " three of rank 4 expected",
    )
    # CIE 15:2004, eq. 8.24 and 8.25, solved for X/Y and Z/Y; both are 1 where v' is 0
    x = combine(lambda y, u, v: y * _over(9 * u, 4 * v), *trees)
    z = combine(lambda y, u, v: y * _over(12 - 3 * u - 20 * v, 4 * v), *trees)
    return x, luminance, z


def _over(above: Values, below: Values) -> Values:
    ratio = np.divide(above, below, out=np.ones_like(above), where=below > 0)
    return np.asarray(ratio)


# Histogram of the merging measure: number of bins, upper end; as in rttree_reduce.
_STEPS, _END = 300, 4.0


@dataclass(frozen=True, eq=False)
class Reduction:
    """A reduced tree, the numbers of cells, and the errors of the reduction."""

    tree: ScatteringTree  # the reduced tree
    cells_before: int  # number of cells before the reduction
    cells_after: int  # number of cells after the reduction
    # Flux whose exit cell changes, as a fraction of the incident flux, under a uniform
    # sky
    moved: float
    # Largest change of directional-hemispherical transmittance or reflectance, for
    # incidence at the centres of the Klems full patches
    hemispherical_error: float


@dataclass(frozen=True, eq=False)
class _Level:
    # Nodes of one level: slots; smallest, largest and mean BSDF below each node
    code: Int32[np.ndarray, " nodes"]
    least: Float[np.ndarray, " nodes"]
    most: Float[np.ndarray, " nodes"]
    mean: Float[np.ndarray, " nodes"]

    def measure(self) -> Values:
        spread = (self.most - self.least) / (np.sqrt(self.mean) + 0.03)
        return np.asarray(np.sqrt(spread))


def reduce_tree(tree: ScatteringTree, percent: float) -> Reduction:
    """Merge similar cells of a tree; flux is conserved.

    `percent`: percentage of the blocks of smallest cells that are merged; 0 merges only
    equal cells.
    """
    message = f"reduction is {percent} %; 0 ≤ reduction < 100 % expected"
    require(0 <= percent < 100, message)
    levels = _levels(tree)
    threshold = _threshold(levels, tree, percent)
    regions = level_slots(_merged(levels, tree.rank, threshold), tree.rank)
    reduced = ScatteringTree(np.concatenate(regions), tree.rank, len(regions) - 1)

    # Half the sum of absolute changes: a decrease in one cell is an increase in another
    change = combine(lambda a, b: np.abs(a - b), tree, reduced)
    live = 2 if tree.rank == 3 else 1
    incident = klems("full").centres()
    shares = tree.hemispherical(incident) - reduced.hemispherical(incident)
    return Reduction(
        reduced,
        cells_before=int(np.sum(tree.slots >= 0)),
        cells_after=int(np.sum(reduced.slots >= 0)),
        moved=float(np.pi / 2 * live * _levels(change)[0].mean[0]),
        hemispherical_error=float(np.abs(shares).max()),
    )


def _levels(tree: ScatteringTree) -> list[_Level]:
    levels: list[_Level] = []
    for at in reversed(_places(tree)):
        code = tree.slots[at]
        inner = code < 0
        value = np.where(inner, 0, code).astype(np.int32).view(np.float32).astype(float)
        least, most, mean = value, value.copy(), value.copy()
        if levels:
            shape = -1, 1 << tree.rank
            least[inner] = levels[-1].least.reshape(shape).min(axis=1)
            most[inner] = levels[-1].most.reshape(shape).max(axis=1)
            mean[inner] = levels[-1].mean.reshape(shape).mean(axis=1)
        levels.append(_Level(code, least, most, mean))
    return levels[::-1]


def _threshold(levels: list[_Level], tree: ScatteringTree, percent: float) -> float:
    if len(levels) < 2 or percent == 0:
        return 0.0
    blocks = levels[-2]
    measure = blocks.measure()[blocks.code < 0]
    step = np.minimum(measure * (_STEPS / _END), _STEPS - 1).astype(int)
    count = np.bincount(step, minlength=_STEPS).astype(float)

    # Count regions without smallest cells as blocks of uniform BSDF (measure 0)
    total = float(1 << tree.rank * (tree.depth - 1))
    count[0] += total - len(measure)
    wanted = np.floor(percent / 100 * total)
    passed = int(np.searchsorted(np.cumsum(count), wanted)) + 1
    return _END / _STEPS * passed if wanted > 0 else 0.0


def _merged(levels: list[_Level], rank: int, threshold: float) -> Iterator[Nodes]:
    at = np.zeros(1, dtype=np.int64)
    for level in levels:
        inner = level.code < 0
        keep = (inner & (level.measure() > threshold))[at]
        yield level.mean[at], keep
        if not np.any(keep):
            break
        number = np.cumsum(inner) - 1
        at = ((number[at[keep]] << rank)[:, None] + np.arange(1 << rank)).ravel()


def slot_means(tree: ScatteringTree) -> Float32[np.ndarray, " slots"]:
    """Mean BSDF of the cells below each slot of a tree."""
    values = np.where(tree.slots < 0, 0, tree.slots).astype(np.int32)
    means = values.view(np.float32).astype(np.float64)
    for at, below in reversed(list(pairwise(_places(tree)))):
        inner = at[tree.slots[at] < 0]
        means[inner] = means[below].reshape(-1, 1 << tree.rank).mean(axis=1)
    return means.astype(np.float32)


def _places(tree: ScatteringTree) -> list[Int64[np.ndarray, " _"]]:
    # Indices of the slots of each level
    places = [np.zeros(1, dtype=np.int64)]
    while np.any((code := tree.slots[places[-1]]) < 0):
        below = ~code[code < 0, None] + np.arange(1 << tree.rank, dtype=np.int64)
        places.append(below.ravel())
    return places
