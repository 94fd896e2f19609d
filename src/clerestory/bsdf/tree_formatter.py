"""Text of tensor trees in BSDF files."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float32

from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_parser import branch_order


def format_tree(tree: ScatteringTree, *, digits: int | None = None) -> str:
    """Return the text of a tree: branches and values in braces.

    Parameters
    ----------
    digits : significant digits; None for all

    Examples
    --------
    >>> even = ScatteringTree(np.array([0.25], dtype=np.float32).view(np.int32), 4, 0)
    >>> format_tree(even)
    '{ 0.25 }'
    """
    return "\n".join(tree_lines(tree, digits=digits))


def tree_lines(tree: ScatteringTree, *, digits: int | None = None) -> Iterator[str]:
    """Yield the lines of the text of a tree: a brace, a value or a block of values."""
    slots, width = tree.slots, 1 << tree.rank
    blocks = slots[1:].reshape(-1, width)
    full = np.all(blocks >= 0, axis=1)
    order = np.argsort(branch_order(tree.rank, 1))

    # Slots to be written, the next one last; None is a closing brace
    waiting: list[int | None] = [int(slots[0])]
    while waiting:
        code = waiting.pop()
        if code is None:
            yield "}"
        elif code >= 0:
            yield _row(np.array([code], dtype=np.int32).view(np.float32), digits)
        elif full[number := ~code // width]:
            yield _row(blocks[number][order].view(np.float32), digits)
        else:
            yield "{"
            waiting.append(None)
            waiting.extend(blocks[number][::-1].tolist())


def _row(values: Float32[np.ndarray, " value"], digits: int | None) -> str:
    # One format string per row is several times faster than one per value
    if digits is None:
        texts = " ".join(str(value).removesuffix(".0") for value in values)
    else:
        texts = f"%.{digits}g " * len(values) % tuple(values.tolist())
    return f"{{ {texts.rstrip()} }}"
