"""Text of a tensor tree, as BSDF files have it."""

import numpy as np

from clerestory.bsdf.tree import ScatteringTree
from clerestory.bsdf.tree_text import branch_order


def format_tree(tree: ScatteringTree, *, digits: int | None = None) -> str:
    """Return the text of a tree: branches and values in braces.

    Parameters
    ----------
    digits : significant digits; None for all

    >>> even = ScatteringTree(np.array([0.25], dtype=np.float32).view(np.int32), 4, 0)
    >>> format_tree(even)
    '{ 0.25 }'
    """

    def number(value: np.float32) -> str:
        text = str(value) if digits is None else f"{value:.{digits}g}"
        return text.removesuffix(".0")

    slots, width = tree.slots, 1 << tree.rank
    order = np.argsort(branch_order(tree.rank, 1))
    parts: list[str] = []

    # Slots that are still to be written, the next one last; a text is a closing brace
    waiting: list[int | str] = [int(slots[0])]
    while waiting:
        code = waiting.pop()
        if isinstance(code, str):
            parts.append(code)
        elif code >= 0:
            parts.append(f"{{ {number(np.int32(code).view(np.float32))} }}")
        else:
            block = slots[~code : ~code + width]
            if np.all(block >= 0):
                row = map(number, block[order].view(np.float32))
                parts.append(f"{{ {' '.join(row)} }}")
            else:
                parts.append("{")
                waiting.append("}")
                waiting.extend(block[::-1].tolist())
    return "\n".join(parts)
