"""Masks of glare pixels of several pictures of one view, stacked in one mask.

The pictures are then scanned together. The masks are cropped to the pixels that are set
in any of them; rows between them are dark, so that no search around a pixel meets a
pixel of another picture.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clerestory.array_types import ImageMask, Indices

# Dark rows between masks, in addition to twice the search radius: a coarse grid of up
# to four cells per search radius must separate them
_BETWEEN = 8


class MaskStack(NamedTuple):
    """Masks one above the other.

    Attributes
    ----------
    pitch : number of rows from one mask to the next
    top, left : row and column of the view at the first row and column of a mask
    """

    mask: ImageMask
    pitch: int
    top: int = 0
    left: int = 0

    @classmethod
    def of(cls, masks: Sequence[ImageMask], reach: int) -> "MaskStack":
        """Return the stack of masks; `reach` is the search radius in pixels.

        >>> above, below = np.zeros((2, 40, 40), bool)
        >>> above[30, 7] = below[29, 8] = True
        >>> stack = MaskStack.of([above, below], 8)
        >>> [part.tolist() for part in stack.seen(*np.nonzero(stack.mask))]
        [[30, 29], [7, 8]]
        """
        rows, columns = (
            np.flatnonzero(np.any([mask.any(axis=axis) for mask in masks], axis=0))
            for axis in (1, 0)
        )
        if not rows.size:
            return cls(np.zeros((0, 0), dtype=bool), 1)
        # A dark column on both sides, unless it is outside of the view
        top, bottom = int(rows[0]), int(rows[-1]) + 1
        left, right = max(int(columns[0]) - 1, 0), int(columns[-1]) + 2
        part = np.s_[top:bottom, left:right]
        height, width = masks[0][part].shape
        pitch = height + 2 * reach + _BETWEEN
        tall = np.zeros((len(masks), pitch, width), dtype=bool)
        for into, mask in zip(tall, masks, strict=True):
            into[:height] = mask[part]
        return cls(tall.reshape(-1, width), pitch, top, left)

    def seen(self, row: Indices, column: Indices) -> tuple[Indices, Indices]:
        """Return row and column of pixels in the view."""
        return row % self.pitch + self.top, column + self.left
