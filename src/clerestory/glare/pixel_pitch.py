"""How far neighbouring pixels are apart: the least and the most over all ways to go."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.glare.row_blocks import by_rows


class Pitch(NamedTuple):
    """Angle between a pixel and the next, over all ways to go [rad]."""

    least: Float[np.ndarray, "row column"]
    most: Float[np.ndarray, "row column"]


def pixel_pitch(direction: Float[np.ndarray, "row column 3"]) -> Pitch:
    """Return the angles between neighbouring pixels, from the slope of directions.

    >>> x = np.arange(5.0) * 0.01
    >>> level = np.stack(np.broadcast_arrays(x, 2 * x[:, None], 0 * x), axis=-1)
    >>> pitch = pixel_pitch(level)
    >>> float(pitch.least[2, 2].round(6)), float(pitch.most[2, 2].round(6))
    (0.01, 0.02)
    """
    rows, columns = direction.shape[:2]
    pitch = Pitch(np.empty((rows, columns)), np.empty((rows, columns)))

    def fill(some: slice) -> None:
        # A row more on either side, for the slope; the edges of the picture keep theirs
        wide = slice(max(some.start - 1, 0), min(some.stop + 1, rows))
        inner = slice(some.start - wide.start, some.stop - wide.start)
        part = direction[wide]
        down = np.gradient(part, axis=0)[inner] if len(part) > 1 else 0 * part
        across = np.gradient(part[inner], axis=1)
        e, g, f = (
            np.einsum("ijk,ijk->ij", a, b)
            for a, b in ((down, down), (across, across), (down, across))
        )
        middle, spread = (e + g) / 2, np.hypot((e - g) / 2, f)
        pitch.least[some] = np.sqrt(np.maximum(middle - spread, 0))
        pitch.most[some] = np.sqrt(middle + spread)

    by_rows(fill, rows, columns)
    return pitch
