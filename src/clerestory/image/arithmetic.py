"""Sums, scaling, cropping and reduction of pictures.

Cropping a picture also narrows and shifts its view.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float

from clerestory.checks import finite, require, same_length
from clerestory.image.picture import Picture, same_size
from clerestory.scene.projection import PROJECTIONS
from clerestory.scene.view import View

Colour = tuple[float, float, float]


def scale(picture: Picture, factor: float | Colour) -> Picture:
    """Return a picture multiplied by one factor, or by one factor per channel."""
    finite(factor, "factor")
    return replace(picture, radiance=picture.radiance * np.asarray(factor, np.float32))


def weighted_sum(
    pictures: Sequence[Picture], weights: Sequence[float] | None = None
) -> Picture:
    """Return Σ weight · picture, with the view and header of the first picture.

    All pictures must have the same size and quantity (radiance or irradiance). The
    default weight is 1. Sums are computed in double precision.

    Examples
    --------
    >>> grey = Picture(np.ones((1, 1, 3), dtype=np.float32))
    >>> weighted_sum([grey, grey], [2, -0.5]).radiance.tolist()
    [[[1.5, 1.5, 1.5]]]
    """
    require(pictures, "no pictures to add; one or more expected")
    factors = [1.0] * len(pictures) if weights is None else weights
    same_length(factors, pictures, "weights", "pictures")
    first = pictures[0]
    total = np.zeros(first.radiance.shape)
    for i, (picture, factor) in enumerate(zip(pictures, factors, strict=True), start=1):
        same_size(picture.radiance, first.radiance, f"picture {i}")
        require(
            picture.quantity == first.quantity,
            f"picture {i} contains {picture.quantity}; {first.quantity} expected,"
            " as in the first picture",
        )
        total += factor * picture.radiance
    return replace(first, radiance=total.astype(np.float32))


def masked(
    picture: Picture,
    mask: Bool[np.ndarray, "row column"],
    *,
    fill: Colour = (0.0, 0.0, 0.0),
) -> Picture:
    """Return a picture with the value `fill` where the mask is false."""
    same_size(mask, picture.radiance, "the mask")
    kept = np.where(mask[..., None], picture.radiance, np.asarray(fill, np.float32))
    return replace(picture, radiance=kept)


def within_view(picture: Picture) -> Bool[np.ndarray, "row column"]:
    """Whether each pixel lies within the view, which is a disc in fisheye views."""
    if picture.view is None:
        return np.ones(picture.radiance.shape[:2], dtype=bool)
    return picture.view.rays(picture.columns, picture.rows).valid


def crop(picture: Picture, *, left: int, top: int, columns: int, rows: int) -> Picture:
    """Return the `columns` × `rows` pixels from row `top` and column `left`.

    The view is cropped as well, so that the direction of each pixel is unchanged.
    """
    inside = 0 <= left < left + columns <= picture.columns
    require(
        inside and 0 <= top < top + rows <= picture.rows,
        f"crop of {columns} × {rows} pixels from column {left}, row {top};"
        f" an area within {picture.columns} × {picture.rows} pixels expected",
    )
    bottom, size = picture.rows - top - rows, (picture.columns, picture.rows)
    start, share = np.divide((left, bottom), size), np.divide((columns, rows), size)
    view = picture.view and _part(picture.view, start.tolist(), share.tolist())
    part = picture.radiance[top : top + rows, left : left + columns]
    return replace(picture, radiance=part.copy(), view=view)


def _part(view: View, start: Sequence[float], share: Sequence[float]) -> View:
    # Rectangle within a view: `start` is its bottom left corner and `share` its size,
    # as fractions of the width and height of the view
    projection = PROJECTIONS[view.kind]
    half = projection.extent(view.horizontal, view.vertical)
    horizontal, vertical = projection.angles(half[0] * share[0], half[1] * share[1])
    return replace(
        view,
        horizontal=horizontal,
        vertical=vertical,
        shift=(start[0] + view.shift - 0.5) / share[0] + 0.5,
        lift=(start[1] + view.lift - 0.5) / share[1] + 0.5,
    )


def reduce(picture: Picture, *, columns: int, rows: int) -> Picture:
    """Return a smaller picture whose pixels are area averages.

    The integral over the picture area is conserved. A pixel that overlaps several new
    pixels contributes to each new pixel in proportion to the overlap.

    Examples
    --------
    >>> ramp = np.arange(4, dtype=np.float32)[None, :, None] * np.ones(3, np.float32)
    >>> reduce(Picture(ramp), columns=2, rows=1).radiance[0, :, 0].tolist()
    [0.5, 2.5]
    """
    require(
        0 < columns <= picture.columns and 0 < rows <= picture.rows,
        f"size of {columns} × {rows} pixels; 1 × 1 to"
        f" {picture.columns} × {picture.rows} expected",
    )
    small = picture.radiance
    for count in (rows, columns):
        averages = _average(small.reshape(len(small), -1), count)
        small = averages.reshape(count, *small.shape[1:]).swapaxes(0, 1)
    aspect = picture.rows / rows * columns / picture.columns
    return replace(
        picture,
        radiance=np.ascontiguousarray(small, dtype=np.float32),
        pixel_aspect=picture.pixel_aspect * aspect,
    )


def _average(
    lines: Float[np.ndarray, "old width"], count: int
) -> Float[np.ndarray, "new width"]:
    # A mean is the difference of the cumulative sum between two new pixel boundaries
    integral = np.zeros((lines.shape[0] + 1, lines.shape[1]))
    np.cumsum(lines, axis=0, dtype=float, out=integral[1:])
    border = np.linspace(0, lines.shape[0], count + 1)
    below = np.minimum(border.astype(int), lines.shape[0] - 1)
    at = integral[below] + (border - below)[:, None] * lines[below]
    return np.asarray(np.diff(at, axis=0) * (count / lines.shape[0]))
