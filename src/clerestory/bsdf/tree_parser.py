"""Parser for the text of tensor trees.

A tree is either `{ branch branch … }` with 2^rank branches, one for each half of each
dimension (dimension i is bit i of the branch number), or `{ value … }`, a grid in
row-major order. The parser is not recursive: deep nesting cannot exhaust the stack.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from jaxtyping import Float32, Int8, Int32, Int64

from clerestory.array_types import Indices, Slots
from clerestory.bsdf.tree_scanner import TreeFault, TreeScan, position_of, scan_tree
from clerestory.errors import InputError

MAX_DEPTH = 15  # largest number of tree levels: 2¹⁵ cells along each dimension
_TOGETHER = 1 << 22  # largest number of values that are reordered together


@dataclass(frozen=True, eq=False)
class TreeTable:
    """Slots of a tree, and the magnitude of negative values in the text."""

    slots: Slots  # values and branch nodes, as in `ScatteringTree`
    depth: int  # number of levels below the root
    # Mean magnitude of negative values [1/sr] over all cells; negative values are read
    # as zero
    negative: float


@dataclass(frozen=True, eq=False)
class _Nodes:
    # One entry per pair of braces, in text order
    level: Int8[np.ndarray, " nodes"]
    grid: Int8[np.ndarray, " nodes"]  # number of levels of a grid; -1 for branch nodes
    first: Int64[np.ndarray, " nodes"]  # index of the first value


def parse_tree(
    text: bytes, *, rank: int, file: str | Path | None = None, line: int = 1
) -> TreeTable:
    """Parse the text of a tree of rank 3 or 4.

    `file`, `line`: file and line where the text starts, for error messages.
    """
    try:
        scan = scan_tree(text)
        return _build(_read_nodes(scan, rank), scan.values, rank)
    except TreeFault as fault:
        at = line + text[: position_of(text, fault)].count(b"\n")
        raise InputError(fault.message, file=file, line=at) from fault


def _read_nodes(scan: TreeScan, rank: int) -> _Nodes:
    opens = scan.step > 0
    depth = np.cumsum(scan.step, dtype=np.int32)

    # Check the nesting
    ends = np.flatnonzero(depth <= 0)
    if not len(ends):
        raise TreeFault("the last brace '}' of a tensor tree is missing")
    message = "text after the end of a tensor tree; one tree expected"
    _demand(depth[ends[0]] == 0 and ends[0] + 1 == len(depth), message, ends[0])
    nested = f"a tensor tree has {np.max(depth) - 1} nested levels"
    message = f"{nested}; at most {MAX_DEPTH} expected"
    _demand(depth <= MAX_DEPTH + 1, message)

    # Only innermost pairs of braces may contain values
    leaf = np.zeros(len(opens), dtype=bool)
    leaf[:-1] = opens[:-1] & ~opens[1:]
    holds = np.concatenate([[False], leaf[:-1]])
    _demand(
        (scan.words == 0) | holds,
        "values and branches in the same braces of a tensor tree; only branches or only"
        " values expected",
    )

    # The number of values of a grid must be a power of 2^rank
    count = scan.words[np.flatnonzero(holds)].astype(np.int64)
    grid = np.full(len(count), -1, dtype=np.int8)
    for halvings in range(MAX_DEPTH + 1):
        grid[count == 1 << rank * halvings] = halvings
    _demand(
        grid >= 0,
        f"{{}} values in a branch of a rank {rank} tensor tree; 1, {1 << rank},"
        f" {1 << rank}², … values expected",
        np.flatnonzero(leaf),
        count,
    )
    of_leaf = leaf[opens]
    kind = np.full(int(opens.sum()), -1, dtype=np.int8)
    kind[of_leaf] = grid
    first = np.zeros(len(kind), dtype=np.int64)
    first[of_leaf] = np.cumsum(count) - count
    level = (depth[opens] - 1).astype(np.int8)
    _check_branches(level, kind, np.flatnonzero(opens), rank)
    return _Nodes(level, kind, first)


def _check_branches(
    level: Int8[np.ndarray, " nodes"],
    grid: Int8[np.ndarray, " nodes"],
    brace: Int64[np.ndarray, " nodes"],
    rank: int,
) -> None:
    # Each branch node must have 2^rank children on the level below
    for upper in range(int(level.max())):
        parents = np.flatnonzero((level == upper) & (grid < 0))
        children = np.flatnonzero(level == upper + 1)
        parent = np.searchsorted(parents, children) - 1
        count = np.bincount(parent, minlength=len(parents))
        message = f"{{}} branches in a rank {rank} tensor tree; {1 << rank} expected"
        _demand(count == 1 << rank, message, brace[parents], count)


def _demand(
    valid: npt.ArrayLike,
    message: str,
    brace: npt.ArrayLike | None = None,
    count: npt.ArrayLike = 0,
) -> None:
    # Require valid entries; the message contains `count` of the first invalid entry
    wrong = np.flatnonzero(~np.atleast_1d(valid))
    if len(wrong):
        at = wrong if brace is None else np.atleast_1d(brace)[wrong]
        number = np.broadcast_to(count, np.shape(np.atleast_1d(valid)))[wrong[0]]
        raise TreeFault(message.format(number), brace=int(at[0]))


def _build(
    nodes: _Nodes, values: Float32[np.ndarray, " values"], rank: int
) -> TreeTable:
    depth = int(np.max(nodes.level + np.maximum(nodes.grid, 0)))
    if depth > MAX_DEPTH:
        message = f"a tensor tree has {depth} levels; at most {MAX_DEPTH} expected"
        raise TreeFault(message)
    negative = _negative_mean(nodes, values, rank)
    code = np.abs(np.maximum(values, 0)).view(np.int32)

    # Append the nodes level by level
    regions: list[Slots] = []
    size = 1
    for level in range(int(nodes.level.max()) + 1):
        on = np.flatnonzero(nodes.level == level)
        grid, first = nodes.grid[on], nodes.first[on]
        region = np.zeros(len(on), dtype=np.int32)
        region[grid == 0] = code[first[grid == 0]]
        inner = grid < 0
        region[inner] = _pointers(size, int(inner.sum()), rank)
        regions.append(region)
        size += int(inner.sum()) << rank

    # Append the grids
    grids: list[Slots] = []
    for level, region in enumerate(regions):
        on = np.flatnonzero(nodes.level == level)
        for halvings in np.unique(nodes.grid[on][nodes.grid[on] > 0]):
            at = np.flatnonzero(nodes.grid[on] == halvings)
            region[at] = _pointers(size, len(at), rank)
            grids.append(_grids(code, nodes.first[on[at]], rank, int(halvings), size))
            size += len(grids[-1])
    return TreeTable(np.concatenate(regions + grids), depth, negative)


def _pointers(start: int, count: int, rank: int) -> Slots:
    # Slots of `count` branch nodes whose children are stored from `start` on
    if start + (count << rank) >= 1 << 31:
        raise TreeFault("a tensor tree has more than 2³¹ slots; fewer expected")
    return ~(start + (np.arange(count, dtype=np.int64) << rank)).astype(np.int32)


def _grids(
    code: Int32[np.ndarray, " values"],
    first: Int64[np.ndarray, " grids"],
    rank: int,
    halvings: int,
    start: int,
) -> Slots:
    # Slots of grids of equal size: inner levels, then values in Morton order
    levels = []
    for level in range(1, halvings):
        count = len(first) << rank * level
        start += count
        levels.append(_pointers(start, count, rank))
    order = morton_order(rank, halvings)
    leaves = np.empty((len(first), len(order)), dtype=np.int32)
    together = max(1, _TOGETHER // len(order))
    for begin in range(0, len(first), together):
        part = slice(begin, begin + together)
        leaves[part] = code[first[part, None] + order]
    return np.concatenate([*levels, leaves.ravel()])


def morton_order(rank: int, halvings: int) -> Indices:
    """Row-major index of each cell of a grid, with cells in Morton (Z-curve) order.

    >>> morton_order(3, 1).tolist()
    [0, 4, 2, 6, 1, 5, 3, 7]
    """
    number = np.arange(1 << rank * halvings).reshape([2] * (rank * halvings))
    # Axis number: dimension·halvings + level, from the coarsest to the finest level and
    # from the last to the first dimension
    axes = [
        dimension * halvings + level
        for level in range(halvings)
        for dimension in reversed(range(rank))
    ]
    return number.transpose(axes).ravel()


def _negative_mean(
    nodes: _Nodes, values: Float32[np.ndarray, " values"], rank: int
) -> float:
    if not len(values) or values.min() >= 0:
        return 0.0
    leaf = nodes.grid >= 0
    size = rank * (nodes.level[leaf] + nodes.grid[leaf]).astype(np.int64)
    count = np.int64(1) << rank * nodes.grid[leaf].astype(np.int64)
    volume = np.repeat(0.5**size, count)
    return float(np.maximum(-values, 0).astype(float) @ volume)
