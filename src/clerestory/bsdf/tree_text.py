"""Text of a tensor tree to a flat table, in a few passes over bytes.

A tree in a file is either `{ branch branch … }`, one branch for each half of each
of its dimensions (dimension i is bit i of the branch's number), or `{ value … }`, a
grid with the last dimension running fastest. Nothing here recurses, so neither
deep nesting nor a tree of hundreds of megabytes can exhaust the stack.
"""

import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float32, Int, Int8, Int32, Int64, UInt8

from clerestory.errors import InputError

# Halvings of a coordinate: 2¹⁵ cells along it, a few arc seconds.
DEEPEST = 15

# Bytes that are looked at together.
_CHUNK = 1 << 22

_SPACE, _WORD, _OPEN, _CLOSE = range(4)
_KIND = np.full(256, _WORD, dtype=np.uint8)
_KIND[list(b" \t\r\n\f\v,")] = _SPACE
_KIND[ord("{")], _KIND[ord("}")] = _OPEN, _CLOSE
_TO_SPACES = bytes.maketrans(b"{},", b"   ")


@dataclass(frozen=True, eq=False)
class TreeTable:
    """Slots of a tree, as `ScatteringTree` explains them, and what was cut off.

    Attributes
    ----------
    slots : values and branches
    depth : halvings of a coordinate down to the smallest cell
    negative : mean of the negative values that were read as zero [1/sr]
    """

    slots: Int32[np.ndarray, " slots"]
    depth: int
    negative: float


@dataclass(frozen=True, eq=False)
class _Scan:
    # Braces in the order of the text, words before each, and all values
    step: Int8[np.ndarray, " braces"]  # +1 opens, -1 closes
    words: Int32[np.ndarray, " braces"]
    values: Float32[np.ndarray, " values"]


@dataclass(frozen=True, eq=False)
class _Nodes:
    # One entry per pair of braces, in the order of the text
    level: Int8[np.ndarray, " nodes"]
    grid: Int8[np.ndarray, " nodes"]  # halvings within a grid; -1 for branches
    first: Int64[np.ndarray, " nodes"]  # number of the first value


def parse_tree(
    text: bytes, *, rank: int, file: str | Path | None = None, line: int = 1
) -> TreeTable:
    """Return the table of a tree from its text.

    Parameters
    ----------
    rank : dimensions of the tree, 3 or 4
    file, line : where the text starts, for messages

    Raises
    ------
    InputError : braces, counts or values that do not make a tree
    """
    try:
        scan = _scan(text)
        nodes = _read_nodes(scan, rank)
        return _build(nodes, scan.values, rank)
    except _TreeFault as fault:
        at = line + text[: _position(text, fault)].count(b"\n")
        raise InputError(fault.message, file=file, line=at) from fault


class _TreeFault(Exception):
    # A fault at a brace of the text, or in a chunk of it
    def __init__(self, message: str, *, brace: int = -1, offset: int = -1) -> None:
        super().__init__(message)
        self.message, self.brace, self.offset = message, brace, offset


def _position(text: bytes, fault: _TreeFault) -> int:
    if fault.brace < 0:
        return max(fault.offset, 0)
    seen = 0
    for start in range(0, len(text), _CHUNK):
        kind = _KIND[np.frombuffer(text[start : start + _CHUNK], dtype=np.uint8)]
        braces = np.flatnonzero(kind >= _OPEN)
        if fault.brace < seen + len(braces):
            return start + int(braces[fault.brace - seen])
        seen += len(braces)
    return len(text)


def _scan(text: bytes) -> _Scan:
    steps, words, values = [], [], []
    carried, start = 0, 0
    while start < len(text):
        end = _end_of_word(text, start + _CHUNK)
        chunk = text[start:end]
        kind: UInt8[np.ndarray, " bytes"] = _KIND[np.frombuffer(chunk, dtype=np.uint8)]
        word = kind == _WORD
        begins = np.flatnonzero(word & ~np.concatenate([[False], word[:-1]]))
        braces = np.flatnonzero(kind >= _OPEN)

        # Count the words since the brace before
        before = np.searchsorted(begins, braces)
        count = np.diff(before, prepend=0)
        if len(count):
            count[0] += carried
            carried = len(begins) - int(before[-1])
        else:
            carried += len(begins)
        steps.append(np.where(kind[braces] == _OPEN, 1, -1).astype(np.int8))
        words.append(count.astype(np.int32))
        values.append(_numbers(chunk, len(begins), start))
        start = end
    if carried:
        raise _TreeFault("values after the tensor tree's last brace", offset=len(text))
    if not any(len(step) for step in steps):
        raise _TreeFault("no tensor tree; text in braces {…} expected")
    return _Scan(np.concatenate(steps), np.concatenate(words), np.concatenate(values))


def _end_of_word(text: bytes, end: int) -> int:
    # Step back to a byte that no word runs across; a longer word is cut, and refused
    end = min(end, len(text))
    for back in range(min(end, 100)):
        if end == len(text) or _KIND[text[end - back]] != _WORD:
            return end - back if end - back > 0 else end
    return end


def _numbers(chunk: bytes, count: int, offset: int) -> Float32[np.ndarray, " values"]:
    plain = chunk.translate(_TO_SPACES)
    if not count:
        return np.empty(0, dtype=np.float32)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)
            values = np.fromstring(plain.decode("ascii"), sep=" ")
        with np.errstate(over="ignore"):
            single = values.astype(np.float32)
    except (DeprecationWarning, ValueError) as error:
        raise _bad_word(plain, offset) from error
    if len(single) != count or not np.all(np.isfinite(single)):
        raise _bad_word(plain, offset)
    return single


def _bad_word(plain: bytes, offset: int) -> _TreeFault:
    # Name the first word that is no number, with its place
    place = 0
    for word in plain.split():
        place = plain.index(word, place)
        if not _is_finite(word):
            shown = word[:40].decode("latin-1")
            return _TreeFault(
                f"{shown!r} in a tensor tree; a number expected", offset=offset + place
            )
        place += len(word)
    return _TreeFault("unreadable values in a tensor tree", offset=offset)


def _is_finite(word: bytes) -> bool:
    try:
        with np.errstate(over="ignore"):
            return bool(np.isfinite(np.float32(float(word)))) and b"_" not in word
    except ValueError:
        return False


def _read_nodes(scan: _Scan, rank: int) -> _Nodes:
    opens = scan.step > 0
    depth = np.cumsum(scan.step, dtype=np.int32)

    # Check the nesting
    ends = np.flatnonzero(depth <= 0)
    if not len(ends):
        raise _TreeFault("a tensor tree without its last brace '}'")
    if depth[ends[0]] < 0 or ends[0] + 1 < len(depth):
        raise _TreeFault(
            "a tensor tree ends before its text does; one tree expected",
            brace=int(ends[0]),
        )
    if np.max(depth) > DEEPEST + 1:
        raise _TreeFault(
            f"a tensor tree of {np.max(depth) - 1} nested levels; {DEEPEST} at most"
            " expected",
            brace=int(np.argmax(depth > DEEPEST + 1)),
        )

    # Only a pair of braces with nothing nested may hold values
    leaf = np.zeros(len(opens), dtype=bool)
    leaf[:-1] = opens[:-1] & ~opens[1:]
    holds = np.concatenate([[False], leaf[:-1]])
    stray = (scan.words > 0) & ~holds
    if np.any(stray):
        raise _TreeFault(
            "values beside the branches of a tensor tree; branches or values expected",
            brace=int(np.argmax(stray)),
        )

    # A grid has a power of 2^rank values
    count = scan.words[np.flatnonzero(holds)].astype(np.int64)
    grid = np.full(len(count), -1, dtype=np.int8)
    for halvings in range(DEEPEST + 1):
        grid[count == 1 << rank * halvings] = halvings
    if np.any(grid < 0):
        wrong = int(np.argmax(grid < 0))
        raise _TreeFault(
            f"{count[wrong]} values in a branch of a rank {rank} tensor tree; a power"
            f" of {1 << rank} expected",
            brace=int(np.flatnonzero(leaf)[wrong]),
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
    # Each node with branches has 2^rank of them on the level below
    for upper in range(int(level.max())):
        parents = np.flatnonzero((level == upper) & (grid < 0))
        children = np.flatnonzero(level == upper + 1)
        parent = np.searchsorted(parents, children) - 1
        count = np.bincount(parent, minlength=len(parents))
        if np.any(count != 1 << rank):
            wrong = int(np.argmax(count != 1 << rank))
            raise _TreeFault(
                f"{count[wrong]} branches in a rank {rank} tensor tree;"
                f" {1 << rank} expected",
                brace=int(brace[parents[wrong]]),
            )


def _build(
    nodes: _Nodes, values: Float32[np.ndarray, " values"], rank: int
) -> TreeTable:
    depth = int(np.max(nodes.level + np.maximum(nodes.grid, 0)))
    if depth > DEEPEST:
        raise _TreeFault(
            f"a tensor tree with {depth} halvings of a coordinate; {DEEPEST} at most"
            " expected"
        )
    negative = _negative_mean(nodes, values, rank)
    code = np.abs(np.maximum(values, 0)).view(np.int32)

    # Put the nodes of each level behind those of the level before
    regions: list[Int32[np.ndarray, " slots"]] = []
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

    # Put the grids behind them all
    shift = 0
    offsets = np.cumsum([0, *(len(region) for region in regions)])
    grids: list[Int32[np.ndarray, " slots"]] = []
    for level in range(len(offsets) - 1):
        on = np.flatnonzero(nodes.level == level)
        for halvings in np.unique(nodes.grid[on]):
            if halvings < 1:
                continue
            at = np.flatnonzero(nodes.grid[on] == halvings)
            regions[level][at] = _pointers(size + shift, len(at), rank)
            table = _grids(code, nodes.first[on[at]], rank, int(halvings), size + shift)
            grids.append(table)
            shift += len(table)
    return TreeTable(np.concatenate(regions + grids), depth, negative)


def _pointers(start: int, count: int, rank: int) -> Int32[np.ndarray, " slots"]:
    # Codes of `count` branches whose blocks follow each other from `start`
    if start + (count << rank) >= 1 << 31:
        raise _TreeFault("a tensor tree of more than 2³¹ slots; fewer expected")
    return ~(start + (np.arange(count, dtype=np.int64) << rank)).astype(np.int32)


def _grids(
    code: Int32[np.ndarray, " values"],
    first: Int64[np.ndarray, " grids"],
    rank: int,
    halvings: int,
    start: int,
) -> Int32[np.ndarray, " slots"]:
    # Slots of equal grids: their inner levels, then their values in branch order
    levels = []
    for level in range(1, halvings):
        count = len(first) << rank * level
        start += count
        levels.append(_pointers(start, count, rank))
    order = branch_order(rank, halvings)
    leaves = np.empty((len(first), len(order)), dtype=np.int32)
    together = max(1, _CHUNK // len(order))
    for begin in range(0, len(first), together):
        part = slice(begin, begin + together)
        leaves[part] = code[first[part, None] + order]
    return np.concatenate([*levels, leaves.ravel()])


def branch_order(rank: int, halvings: int) -> Int[np.ndarray, " cells"]:
    """Number in a grid, last dimension fastest, of each cell in the order of branches.

    >>> branch_order(3, 1).tolist()
    [0, 4, 2, 6, 1, 5, 3, 7]
    """
    number = np.arange(1 << rank * halvings).reshape([2] * (rank * halvings))
    # Axis dimension·halvings + level: coarse levels first, the last dimension slowest
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
