"""Sums, scaling, cropping and reduction of pictures.

The view of a result is that of its pixels: the view of a cropped picture is narrower
and shifted.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float

from clerestory.errors import InputError
from clerestory.image.picture import Picture
from clerestory.scene.projection import PROJECTIONS
from clerestory.scene.view import View

Colour = tuple[float, float, float]


def scale(picture: Picture, factor: float | Colour) -> Picture:
    """Return a picture times a factor, or times one each for red, green and blue."""
    values = np.asarray(factor, dtype=np.float32)
    if not np.isfinite(values).all():
        raise InputError(f"factor {factor}; finite numbers expected")
    return replace(picture, radiance=picture.radiance * values)


def weighted_sum(
    pictures: Sequence[Picture], weights: Sequence[float] | None = None
) -> Picture:
    """Return Σ weight · picture, with the view and header of the first.

    Sums are kept in double precision until the end.

    Parameters
    ----------
    pictures : of one size and quantity
    weights : one each; all 1 if not given

    Raises
    ------
    InputError : no pictures, pictures that do not fit, another number of weights

    Examples
    --------
    >>> grey = Picture(np.ones((1, 1, 3), dtype=np.float32))
    >>> weighted_sum([grey, grey], [2, -0.5]).radiance.tolist()
    [[[1.5, 1.5, 1.5]]]
    """
    if not pictures:
        raise InputError("no pictures to add; one or more expected")
    factors = [1.0] * len(pictures) if weights is None else list(weights)
    if len(factors) != len(pictures):
        raise InputError(f"{len(factors)} weights for {len(pictures)} pictures")
    first = pictures[0]
    total = np.zeros(first.radiance.shape)
    for i, (picture, factor) in enumerate(zip(pictures, factors, strict=True), start=1):
        if picture.radiance.shape != first.radiance.shape:
            raise InputError(
                f"picture {i} has {picture.columns} × {picture.rows} pixels; the first"
                f" {first.columns} × {first.rows}"
            )
        if picture.quantity != first.quantity:
            raise InputError(
                f"picture {i} holds {picture.quantity}; the first {first.quantity}"
            )
        total += factor * picture.radiance
    return replace(first, radiance=total.astype(np.float32))


def masked(
    picture: Picture,
    mask: Bool[np.ndarray, "row column"],
    *,
    fill: Colour = (0.0, 0.0, 0.0),
) -> Picture:
    """Return a picture that keeps its pixels where the mask is true, else has `fill`.

    Raises
    ------
    InputError : a mask of another size
    """
    if mask.shape != picture.radiance.shape[:2]:
        raise InputError(
            f"a mask of shape {mask.shape} on a picture of"
            f" {picture.rows} rows and {picture.columns} columns"
        )
    kept = np.where(mask[..., None], picture.radiance, np.asarray(fill, np.float32))
    return replace(picture, radiance=kept)


def within_view(picture: Picture) -> Bool[np.ndarray, "row column"]:
    """Pixels that a ray belongs to: the disc of a hemispherical view; else all."""
    if picture.view is None:
        return np.ones(picture.radiance.shape[:2], dtype=bool)
    return picture.view.rays(picture.columns, picture.rows).valid


def crop(picture: Picture, *, left: int, top: int, columns: int, rows: int) -> Picture:
    """Return the cut-out of `columns` and `rows` from pixel (`top`, `left`) on.

    Its view is the part of the view that it shows, so that directions and solid angles
    of its pixels stay what they were.

    Raises
    ------
    InputError : a crop that is empty or exceeds the picture
    """
    inside = 0 <= left < left + columns <= picture.columns
    if not (inside and 0 <= top < top + rows <= picture.rows):
        raise InputError(
            f"a crop of {columns} × {rows} pixels from column {left}, row {top};"
            f" one within {picture.columns} × {picture.rows} expected"
        )
    view = picture.view
    if view is not None:
        bottom = picture.rows - top - rows
        view = _part(
            view,
            (left / picture.columns, bottom / picture.rows),
            (columns / picture.columns, rows / picture.rows),
        )
    part = picture.radiance[top : top + rows, left : left + columns]
    return replace(picture, radiance=part.copy(), view=view)


def _part(view: View, start: tuple[float, float], share: tuple[float, float]) -> View:
    # The view of a part that begins at `start` and has a `share` of width and height
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
    """Return a smaller picture whose pixels are averages over the area they cover.

    The sum over all pixels times their area stays. Pixels that lie in two new ones
    count in both with their share.

    Raises
    ------
    InputError : a size of nothing, or larger than the picture

    Examples
    --------
    >>> ramp = np.arange(4, dtype=np.float32)[None, :, None] * np.ones(3, np.float32)
    >>> reduce(Picture(ramp), columns=2, rows=1).radiance[0, :, 0].tolist()
    [0.5, 2.5]
    """
    if not (0 < columns <= picture.columns and 0 < rows <= picture.rows):
        raise InputError(
            f"a size of {columns} × {rows} pixels; up to"
            f" {picture.columns} × {picture.rows} expected"
        )
    lines = _average(picture.radiance.reshape(picture.rows, -1), rows)
    turned = lines.reshape(rows, picture.columns, -1).transpose(1, 0, 2)
    small = _average(turned.reshape(picture.columns, -1), columns)
    aspect = picture.rows / rows * columns / picture.columns
    return replace(
        picture,
        radiance=np.ascontiguousarray(
            small.reshape(columns, rows, -1).transpose(1, 0, 2)
        ).astype(np.float32),
        pixel_aspect=picture.pixel_aspect * aspect,
    )


def _average(
    lines: Float[np.ndarray, "old width"], count: int
) -> Float[np.ndarray, "new width"]:
    # From the integral over the lines, interpolated at the borders of the new ones
    integral = np.zeros((lines.shape[0] + 1, lines.shape[1]))
    np.cumsum(lines, axis=0, dtype=float, out=integral[1:])
    border = np.linspace(0, lines.shape[0], count + 1)
    below = np.minimum(border.astype(int), lines.shape[0] - 1)
    at = integral[below] + (border - below)[:, None] * lines[below]
    averages: np.ndarray = np.diff(at, axis=0) * (count / lines.shape[0])
    return averages
