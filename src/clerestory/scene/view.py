"""Views: cameras with six projections, and the rays of their pixels.

Image coordinates are Radiance's: x to the right and y upwards, from 0 to 1 over the
image. Pixel coordinates are (row, column) from the upper left corner; pixel (i, j)
covers i to i + 1 and j to j + 1, with its centre at i + ½, j + ½.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from clerestory.argument_types import checked_fields
from clerestory.array_types import Directions, Points2, Values, Vector
from clerestory.brief_repr import brief
from clerestory.checks import finite, one_of, positive, require
from clerestory.directions import unit
from clerestory.scene.projection import PROJECTIONS, TINY, Kind, Projection


class Rays(NamedTuple):
    """Rays through the pixels of a view; `direction` is 0 outside the projection."""

    origin: Float[np.ndarray, "row column 3"]
    direction: Float[np.ndarray, "row column 3"]
    valid: Bool[np.ndarray, "row column"]


@checked_fields
@dataclass(frozen=True, eq=False)
class View:
    """A camera: position, direction, projection and view angles.

    Attributes
    ----------
    kind : type of projection
    position : viewpoint [m]
    direction, up : view direction and up vector; normalized to unit length
    horizontal, vertical : full view angles [deg]; for a parallel view, width and height
        of the field of view [m]
    shift, lift : offset of the image to the right and up, relative to image size
    fore, aft : distances of the clipping planes [m], aft 0 is infinite; in parallel and
        perspective views along the view axis, in cylindrical views from the up
        axis, otherwise from the viewpoint

    Raises
    ------
    InputError : a number is out of range or not finite, or `up` is parallel to
        `direction`

    Examples
    --------
    >>> view = View(kind="angular", horizontal=180, vertical=180)
    >>> rays = view.rays(3, 3)
    >>> rays.direction[1, 1].tolist(), rays.valid.all()
    ([0.0, 1.0, 0.0], np.True_)
    """

    kind: Kind = "perspective"
    position: Vector = field(default_factory=lambda: np.zeros(3))
    direction: Vector = field(default_factory=lambda: np.array([0.0, 1.0, 0.0]))
    up: Vector = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    horizontal: float = 45.0
    vertical: float = 45.0
    shift: float = 0.0
    lift: float = 0.0
    fore: float = 0.0
    aft: float = 0.0

    __repr__ = brief

    def __post_init__(self) -> None:
        one_of(self.kind, "view kind", choices=PROJECTIONS)
        for name in ("position", "direction", "up"):
            vector = np.asarray(getattr(self, name), dtype=float)
            require(
                vector.shape == (3,) and np.isfinite(vector).all(),
                f"view {name} is {vector.tolist()}; three finite numbers expected",
            )
            object.__setattr__(
                self, name, vector if name == "position" else unit(vector)
            )
        for name in ("horizontal", "vertical", "shift", "lift", "fore", "aft"):
            finite(getattr(self, name), f"view {name}")
        sizes = {"horizontal": self.horizontal, "vertical": self.vertical}
        for (name, size), most in zip(
            sizes.items(), self._projection.largest, strict=True
        ):
            require(
                TINY < size <= most,
                f"{name} size of the {self.kind} view is {size:g};"
                f" a number between 0 and {most:g} expected",
            )
        require(
            min(self.fore, self.aft) >= -TINY,
            "a clipping plane of the view is behind its position; 0 m or more expected",
        )
        require(
            self.aft <= TINY or self.aft > self.fore,
            f"the view's aft plane is at {self.aft:g} m; a distance beyond its"
            f" fore plane at {self.fore:g} m expected",
        )
        parallel = np.linalg.norm(np.cross(self.direction, self.up)) < TINY
        require(not parallel, "the view's up vector is parallel to its direction")

    @property
    def _projection(self) -> Projection:
        return PROJECTIONS[self.kind]

    @cached_property
    def _axes(self) -> Float[np.ndarray, "3 3"]:
        # Rows: right, up, forward
        right = unit(np.cross(self.direction, self.up))
        return np.stack([right, np.cross(right, self.direction), self.direction])

    @property
    def _half(self) -> tuple[float, float]:
        # Half width and half height of the image in plane coordinates
        return self._projection.extent(self.horizontal, self.vertical)

    def aspect(self) -> float:
        """Return the ratio of image height to image width for square pixels."""
        half_width, half_height = self._half
        return half_height / half_width

    def size_for(
        self, resolution: int | tuple[int, int], *, pixel_aspect: float = 1.0
    ) -> tuple[int, int]:
        """Return the numbers of columns and rows of the largest image in `resolution`.

        `pixel_aspect` is the ratio of pixel height to pixel width.
        """
        columns, rows = np.broadcast_to(resolution, 2).tolist()
        positive([columns, rows], "resolution")
        aspect = self.aspect()
        # Rounds as Radiance's function normaspect does
        if aspect * columns > pixel_aspect * rows:
            columns = int(rows / aspect * pixel_aspect + 0.5)
        else:
            rows = int(columns * aspect / pixel_aspect + 0.5)
        return max(columns, 1), max(rows, 1)

    def rays(
        self,
        columns: int,
        rows: int,
        jitter: Float[np.ndarray, "row column 2"] | None = None,
    ) -> Rays:
        """Return rays through the pixels of an image, by default through their centres.

        `jitter` is the position (right, up) of the ray in each pixel, 0…1 from the
        lower left corner.
        """
        offset = np.full((rows, columns, 2), 0.5) if jitter is None else jitter
        x = (np.arange(columns)[None, :] + offset[..., 0]) / columns
        y = (np.arange(rows)[::-1, None] + offset[..., 1]) / rows
        half_width, half_height = self._half
        u = (x + self.shift - 0.5) * 2 * half_width
        v = (y + self.lift - 0.5) * 2 * half_height
        local, valid = self._projection.to_direction(u, v)
        direction = np.where(valid[..., None], local, 0) @ self._axes
        origin = self.position + self.fore * self._stretch(local) * direction
        if self.kind == "parallel":
            origin = origin + np.stack([u, v], axis=-1) @ self._axes[:2]
        return Rays(np.where(valid[..., None], origin, 0), direction, valid)

    def _stretch(self, local: Directions) -> np.ndarray:
        # Length of each ray between clipping planes one metre apart
        along = np.ones((*local.shape[:-1], 1))
        if self.kind == "perspective":
            along = local[..., 2:]
        elif self.kind == "cylindrical":
            along = np.hypot(local[..., :1], local[..., 2:])
        return np.asarray(1 / np.maximum(along, TINY))

    def reach(self, direction: Directions) -> Values:
        """Return ray lengths from fore to aft plane [m]; inf without an aft plane."""
        if self.aft <= TINY:
            return np.full(direction.shape[:-1], np.inf)
        length = (self.aft - self.fore) * self._stretch(direction @ self._axes.T)
        return np.asarray(length[..., 0])

    def pixel(self, direction: Directions, *, columns: int, rows: int) -> Points2:
        """Return the pixel coordinates (row, column) of directions.

        Pixel coordinates may be outside the image. They are NaN outside the projection,
        such as behind a perspective view, and for all directions in a parallel view.
        """
        local = unit(direction) @ self._axes.T
        u, v = self._projection.to_plane(local.reshape(-1, 3))
        where = self._pixel(u, v, columns, rows)
        return where.reshape(*local.shape[:-1], 2)

    def pixel_of_point(self, point: Directions, *, columns: int, rows: int) -> Points2:
        """Return the pixel coordinates (row, column) of points in the scene."""
        if self.kind != "parallel":
            return self.pixel(point - self.position, columns=columns, rows=rows)
        local = (point - self.position) @ self._axes.T
        return self._pixel(local[..., 0], local[..., 1], columns, rows)

    def _pixel(
        self, u: np.ndarray, v: np.ndarray, columns: int, rows: int
    ) -> np.ndarray:
        half_width, half_height = self._half
        x = u / (2 * half_width) + 0.5 - self.shift
        y = v / (2 * half_height) + 0.5 - self.lift
        return np.stack([(1 - y) * rows, x * columns], axis=-1)


def solid_angles(
    view: View, columns: int, rows: int
) -> Float[np.ndarray, "row column"]:
    """Return the solid angles of the pixels of an image [sr].

    The solid angle of a pixel excludes areas outside the projection, such as beyond the
    rim of a hemispherical view, so that the sum over a whole view is exact. In a
    parallel view the solid angles are zero.

    >>> view = View(kind="hemispherical", horizontal=180, vertical=180)
    >>> round(float(solid_angles(view, 64, 64).sum() / np.pi), 9)
    2.0
    """
    projection = PROJECTIONS[view.kind]
    half_width, half_height = projection.extent(view.horizontal, view.vertical)
    u = (np.arange(columns + 1) / columns + view.shift - 0.5) * 2 * half_width
    v = (np.arange(rows + 1)[::-1] / rows + view.lift - 0.5) * 2 * half_height
    return np.asarray(projection.solid_angles(u, v))
