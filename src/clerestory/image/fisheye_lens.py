"""Fisheye lenses: projection of directions onto the photograph.

A lens is described by the distance from the image centre (radius) as a function of the
angle from the lens axis. Pictures are reprojected to a Radiance view, such as -vta.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, Literal, get_args

import numpy as np
from jaxtyping import Float
from numpy.polynomial import Polynomial

from clerestory.checks import one_of, positive, require
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
    mapping : image radius, up to a factor, at the angle θ from the axis: θ
        ("equidistant"), sin θ/2 ("equisolid"), sin θ ("orthographic"), tan θ/2
        ("stereographic"), or a polynomial of θ
    coefficients : coefficients, up to a factor, of θ, θ², … [1/rad, 1/rad², …]
    """

    mapping: Mapping = "equidistant"
    coefficients: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        one_of(self.mapping, "lens", choices=get_args(Mapping))
        require(
            (self.mapping == "polynomial") == bool(self.coefficients),
            "coefficients are required for a polynomial lens, and only for it",
        )
        steps = self.radius(np.linspace(0, np.pi / 2, 91))
        require(
            np.isfinite(steps).all() and (np.diff(steps) > 0).all(),
            f"lens coefficients {self.coefficients}; an image radius that increases"
            " with the angle from 0° to 90° expected",
        )

    def radius(self, theta: _Angles) -> _Angles:
        """Image radius at angles from the axis [rad], relative to the radius at 90°."""
        profiles: dict[str, Callable[[Any], Any]] = {
            "equidistant": lambda angle: angle,
            "equisolid": lambda angle: np.sin(angle / 2),
            "orthographic": lambda angle: np.sin(np.minimum(angle, np.pi / 2)),
            "stereographic": lambda angle: np.tan(angle / 2),
            "polynomial": Polynomial([0.0, *self.coefficients]),
        }
        radius = profiles[self.mapping]
        return np.asarray(radius(np.asarray(theta, float)) / radius(np.pi / 2))


@dataclass(frozen=True)
class ImageCircle:
    """Circle that shows the hemisphere on a photograph: centre and radius.

    Attributes
    ----------
    row, column : pixel coordinates of the lens axis; the centre of pixel 0 is at 0.5
    radius : distance from the centre of directions at 90° to the lens axis [pixels]
    """

    row: float
    column: float
    radius: float

    def __post_init__(self) -> None:
        positive(self.radius, "radius of the image circle", unit="pixels")


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
    """Return a picture reprojected to a view; black beyond 90° from the lens axis.

    The top of the photograph is the up direction of the view. Each pixel is the mean of
    several samples, about one per photograph pixel, so that flux and illuminance are
    approximately conserved.
    """
    require(
        0 <= circle.row <= picture.rows and 0 <= circle.column <= picture.columns,
        f"image circle centred at row {circle.row:g}, column {circle.column:g}; a"
        f" centre within {picture.columns} × {picture.rows} pixels expected",
    )
    samples = int(np.clip(np.ceil(2 * circle.radius / min(columns, rows)), 1, 8))
    total = np.zeros((rows, columns, 3))
    offsets = (np.arange(samples) + 0.5) / samples
    for up, right in product(offsets, offsets):
        jitter = np.full((rows, columns, 2), [right, up])
        total += _sampled(picture, lens, circle, view, jitter)
    radiance = (total / samples**2).astype(np.float32)
    return replace(picture, radiance=radiance, view=view, pixel_aspect=1.0)


def _sampled(
    picture: Picture, lens: Lens, circle: ImageCircle, view: View, jitter: np.ndarray
) -> np.ndarray:
    # Sample the photograph at one point within each pixel of the view
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
    # Pixels are black beyond 90° from the lens axis and outside the photograph
    inside = valid & (theta <= np.pi / 2 + 1e-6)
    inside &= (column > -1) & (column < picture.columns)
    inside &= (row > -1) & (row < picture.rows)
    return np.where(inside[..., None], seen, 0)
