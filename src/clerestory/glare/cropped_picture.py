"""Extrapolation of cropped pictures above and below, as in evalglare -I."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError
from clerestory.glare.glare_view import GlareView


@dataclass(frozen=True)
class SeenRows:
    """Captured rows of a cropped picture.

    Attributes
    ----------
    first, last : indices of the first and last row, counted from the top
    """

    first: int
    last: int

    def __post_init__(self) -> None:
        if not 0 <= self.first <= self.last:
            raise InputError(
                f"captured rows {self.first} to {self.last}; increasing numbers"
                " expected"
            )


def fill_cut(
    luminance: Float[np.ndarray, "row column"], eye: GlareView, seen: SeenRows
) -> Float[np.ndarray, "row column"]:
    """Return the luminance [cd/m²], with missing rows set to the nearest captured row.

    As in evalglare -I, a column is extrapolated upwards only if the pixel of its first
    captured row is within the field of view.

    >>> from clerestory.glare.glare_view import glare_view
    >>> from clerestory.scene.view import View
    >>> eye = glare_view(View(kind="angular", horizontal=180, vertical=180), 64, 64)
    >>> room = np.zeros((64, 64))
    >>> room[20:40] = 100.0
    >>> float(fill_cut(room, eye, SeenRows(20, 39))[[3, 60], 32].min())
    100.0
    """
    rows = len(luminance)
    if seen.last >= rows:
        raise InputError(
            f"last captured row {seen.last} in a picture of {rows} rows; a"
            " smaller number expected"
        )
    filled = luminance.copy()
    filled[: seen.first] = luminance[seen.first] * eye.valid[seen.first]
    filled[seen.last + 1 :] = luminance[seen.last]
    return filled
