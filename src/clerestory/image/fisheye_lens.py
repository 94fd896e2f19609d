"""Fisheye lenses: projection of directions onto the photograph.

A lens is described by the image radius as a function of the angle from the axis,
relative to the radius at 90°. Pictures are reprojected to a Radiance view, e.g. -vta.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError
from clerestory.image.opencv import opencv
from clerestory.image.picture import Picture
from clerestory.scene.view import View

Mapping = Literal[
    "equidistant", "equisolid", "orthographic", "stereographic", "polynomial"
]

_Angles = Float[np.ndarray, "*shape"]


@dataclass(frozen=True)
class Lens:
    """Projection of a fisheye lens.

    Attributes
    ----------
    mapping : image radius as a function of the angle θ, up to a factor: θ
        ("equidistant"), sin θ/2 ("equisolid"), sin θ ("orthographic"), tan θ/2
        ("stereographic"), or a polynomial of θ
    coefficients : polynomial coefficients of θ, θ², … [1/rad, 1/rad², …], to any scale

    Raises
    ------
    InputError : unknown mapping, polynomial without coefficients, or radius that does
        not increase up to 90°

    Examples
    --------
    >>> Lens("equisolid").radius(np.radians([45.0, 90.0])).round(4).tolist()
    [0.5412, 1.0]
    """

    mapping: Mapping = "equidistant"
    coefficients: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        known = Mapping.__args__  # type: ignore[attr-defined]
        if self.mapping not in known:
            raise InputError(
                f'lens "{self.mapping}"; one of {", ".join(known)} expected'
            )
        if (self.mapping == "polynomial") != bool(self.coefficients):
            raise InputError(
                "coefficients required for a polynomial lens, and only for it"
            )
        steps = self.radius(np.linspace(0, np.pi / 2, 91))
        if not (np.isfinite(steps).all() and (np.diff(steps) > 0).all()):
            raise InputError(
                f"lens coefficients {self.coefficients}; a radius that increases from 0"
                " to 90° expected"
            )

    def radius(self, theta: _Angles) -> _Angles:
        """Image radius at angles from the axis [rad], relative to the radius at 90°."""
        plain = self._plain(np.asarray(theta, float))
        radius: np.ndarray = plain / self._plain(np.array(np.pi / 2))
        return radius

    def _plain(self, theta: np.ndarray) -> np.ndarray:
        if self.mapping == "equisolid":
            return np.asarray(np.sin(theta / 2))
        if self.mapping == "orthographic":
            return np.asarray(np.sin(np.minimum(theta, np.pi / 2)))
        if self.mapping == "stereographic":
            return np.asarray(np.tan(theta / 2))
        if self.mapping == "polynomial":
            return np.asarray(np.polyval([*self.coefficients[::-1], 0.0], theta))
        return theta


@dataclass(frozen=True)
class ImageCircle:
    """Position and size of the hemisphere on a photograph.

    Attributes
    ----------
    row, column : pixel coordinates of the axis; the centre of pixel 0 is at 0.5
    radius : distance from the axis at which 90° is imaged [pixels]
    """

    row: float
    column: float
    radius: float

    def __post_init__(self) -> None:
        if not 0 < self.radius < np.inf:
            raise InputError(
                f"image circle of radius {self.radius:g}; above 0 expected"
            )


def largest_circle(picture: Picture) -> ImageCircle:
    """Return the largest image circle centred in a picture."""
    middle = picture.rows / 2, picture.columns / 2
    return ImageCircle(row=middle[0], column=middle[1], radius=min(middle))


def reproject(
    picture: Picture,
    lens: Lens,
    circle: ImageCircle,
    *,
    view: View,
    columns: int,
    rows: int,
) -> Picture:
    """Return the picture reprojected to a view; black outside the field of the lens.

    Each pixel is the mean of n × n samples, where n is about the number of photograph
    pixels across the pixel. Flux is approximately conserved, so that the illuminance
    computed from the new view is correct.

    Parameters
    ----------
    lens, circle : lens and image circle of the photograph; the top of the photograph
        is the up direction of the view
    view : target view; its position and direction are not changed
    columns, rows : size of the result in pixels

    Raises
    ------
    InputError : the centre of the image circle lies outside the photograph

    Examples
    --------
    >>> flat = Picture(np.ones((40, 40, 3), dtype=np.float32))
    >>> eye = View(kind="angular", horizontal=180, vertical=180)
    >>> seen = reproject(
    ...     flat,
    ...     Lens("equisolid"),
    ...     ImageCircle(20, 20, 20),
    ...     view=eye,
    ...     columns=30,
    ...     rows=30,
    ... )
    >>> seen.radiance[15, 15].tolist(), seen.radiance[0, 0].tolist()
    ([1.0, 1.0, 1.0], [0.0, 0.0, 0.0])
    """
    if not (0 <= circle.row <= picture.rows and 0 <= circle.column <= picture.columns):
        raise InputError(
            f"image circle centred at row {circle.row:g}, column {circle.column:g}; a"
            f" centre within {picture.columns} × {picture.rows} pixels expected"
        )
    samples = int(np.clip(np.ceil(2 * circle.radius / min(columns, rows)), 1, 8))
    total = np.zeros((rows, columns, 3))
    offsets = (np.arange(samples) + 0.5) / samples
    for up in offsets:
        for right in offsets:
            jitter = np.broadcast_to([right, up], (rows, columns, 2))
            total += _sampled(picture, lens, circle, view, np.array(jitter))
    radiance = (total / samples**2).astype(np.float32)
    return replace(picture, radiance=radiance, view=view, pixel_aspect=1.0)


def _sampled(
    picture: Picture, lens: Lens, circle: ImageCircle, view: View, jitter: np.ndarray
) -> np.ndarray:
    # Photograph sampled at one point of each pixel of the view
    cv2 = opencv()
    rows, columns, _ = jitter.shape
    direction, valid = view.rays(columns, rows, jitter)[1:]
    right = np.cross(view.direction, view.up)
    right /= np.linalg.norm(right)
    aside, above = direction @ right, direction @ np.cross(right, view.direction)
    flat = np.hypot(aside, above)
    theta = np.arctan2(flat, direction @ view.direction)
    stretch = lens.radius(theta) * circle.radius / np.maximum(flat, 1e-12)
    # In OpenCV the centre of the first pixel is at 0
    column = circle.column + aside * stretch - 0.5
    row = circle.row - above * stretch - 0.5
    seen = cv2.remap(
        picture.radiance,
        column.astype(np.float32),
        row.astype(np.float32),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_REPLICATE,
    )
    # Directions beyond 90° are outside the field of the lens
    inside = valid & (theta <= np.pi / 2 + 1e-6)
    inside &= (column > -1) & (column < picture.columns)
    inside &= (row > -1) & (row < picture.rows)
    seen_inside: np.ndarray = np.where(inside[..., None], seen, 0)
    return seen_inside
