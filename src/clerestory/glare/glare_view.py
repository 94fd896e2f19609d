"""What glare needs to know of a view, once for all pictures taken through it.

Per pixel: direction, solid angle, cosine to the line of sight and position index.
Only what lies in front of the eye counts: light from behind adds nothing to the
illuminance on it.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from clerestory.errors import InputError
from clerestory.glare.field_of_view import FieldOfView, in_field
from clerestory.glare.pixel_pitch import Pitch, pixel_pitch
from clerestory.glare.pixel_rays import pixel_rays
from clerestory.glare.pixel_solid_angle import quadrilaterals
from clerestory.glare.position_index import PositionModel, position_index
from clerestory.glare.row_blocks import by_rows
from clerestory.scene.projection import Kind
from clerestory.scene.view import View

# Sides of a picture from which an angle per pixel can be told
_SMALLEST = 21


@dataclass(frozen=True, eq=False)
class GlareView:
    """Pixels of a view as the eye sees them.

    Attributes
    ----------
    view : the camera
    direction : unit vectors of the pixel centres
    solid_angle : of the pixels that count, else zero [sr]
    cosine : to the line of sight, at least zero
    position_index : 1 in the middle, up to 16
    sigma, tau : angles from the line of sight and from the vertical around it [rad]
    """

    view: View
    direction: Float[np.ndarray, "row column 3"]
    solid_angle: Float[np.ndarray, "row column"]
    cosine: Float[np.ndarray, "row column"]
    position_index: Float[np.ndarray, "row column"]
    sigma: Float[np.ndarray, "row column"]
    tau: Float[np.ndarray, "row column"]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, columns = self.solid_angle.shape
        return rows, columns

    @cached_property
    def valid(self) -> Bool[np.ndarray, "row column"]:
        """Whether a pixel counts."""
        return self.solid_angle > 0

    @cached_property
    def total_solid_angle(self) -> float:
        """Solid angle of all pixels that count [sr]."""
        return float(self.solid_angle.sum())

    @cached_property
    def eye_weight(self) -> Float[np.ndarray, "row column"]:
        """Illuminance on the eye by each pixel per unit of its luminance [sr]."""
        weight: np.ndarray = self.solid_angle * self.cosine
        return weight

    def in_field(self, field: FieldOfView) -> Bool[np.ndarray, "row column"]:
        """Whether pixels lie in Guth's field of view."""
        up = np.cross(np.cross(self.view.direction, self.view.up), self.view.direction)
        return in_field(self.sigma, self.tau, self.direction @ up < 0, field=field)

    def angle_from(self, row: int, column: int) -> Float[np.ndarray, "row column"]:
        """Angles of all pixels from one of them [rad]."""
        cosine = self.direction @ self.direction[row, column]
        angle: np.ndarray = np.arccos(np.clip(cosine, -1, 1))
        angle[row, column] = 0
        return angle

    @cached_property
    def _pitch(self) -> Pitch:
        return pixel_pitch(self.direction)

    @cached_property
    def _least_pitch(self) -> float:
        # Over all pixels that count [rad]
        least = self._pitch.least[self.valid]
        return float(least[least > 0].min(initial=np.inf))

    def farthest_within(self, angle: float) -> int:
        """Most rows or columns between two pixels that count, an angle [rad] apart."""
        # Pixels shrink a little within the angle
        reach = 1.25 * angle / self._least_pitch
        return int(min(np.ceil(reach) + 1, max(self.shape)))

    def surely_within(self, angle: float) -> Float[np.ndarray, "row column"]:
        """Pixels to go from each pixel in any way and stay within an angle [rad]."""
        with np.errstate(divide="ignore"):
            reach: np.ndarray = angle / self._pitch.most
        return reach

    def pixel_angle(self) -> float:
        """A tenth of the angle of ten pixels along the diagonal from the middle [rad].

        The scale on which evalglare decides whether pixels are small enough to merge.
        """
        rows, columns = self.shape
        # The middle as evalglare counts it, rows from below
        row, column = rows - 1 - rows // 2, columns // 2
        cosine = self.direction[row, column] @ self.direction[row - 10, column + 10]
        return float(np.arccos(min(cosine, 1.0))) / 10


def glare_view(
    view: View,
    columns: int,
    rows: int,
    *,
    model: PositionModel = "guth",
) -> GlareView:
    """Return the pixels of a view as the eye sees them.

    The last few results are kept: pictures through one view share them.

    Parameters
    ----------
    columns, rows : size of the pictures
    model : of the position index

    Raises
    ------
    InputError : a parallel view, which sees one direction only; a picture of fewer
        than 21 pixels a side

    Examples
    --------
    >>> eye = glare_view(View(kind="angular", horizontal=180, vertical=180), 64, 64)
    >>> round(float(eye.eye_weight.sum() / np.pi), 3)
    1.0
    """
    if view.kind == "parallel":
        raise InputError(
            "a parallel view has no solid angles; a fisheye view (-vta, -vth) expected"
        )
    if min(columns, rows) < _SMALLEST:
        raise InputError(
            f"a picture of {columns} × {rows} pixels; {_SMALLEST} a side or more"
            " expected for glare"
        )
    key = _Key(
        view.kind,
        tuple(view.direction.tolist()),
        tuple(view.up.tolist()),
        (view.horizontal, view.vertical, view.shift, view.lift),
    )
    return _glare_view(key, columns, rows, model)


class _Key(NamedTuple):
    # What directions depend on, as something that can be looked up
    kind: Kind
    direction: tuple[float, ...]
    up: tuple[float, ...]
    size: tuple[float, float, float, float]


@lru_cache(maxsize=8)
def _glare_view(key: _Key, columns: int, rows: int, model: PositionModel) -> GlareView:
    view = View(
        key.kind, np.zeros(3), np.array(key.direction), np.array(key.up), *key.size
    )
    direction = np.empty((rows, columns, 3))
    parts = {
        name: np.empty((rows, columns))
        for name in ("solid_angle", "cosine", "position_index", "sigma", "tau")
    }

    def fill(some: slice) -> None:
        rays = pixel_rays(view, columns, rows, some)
        cosine = np.clip(rays.direction @ view.direction, -1, 1)
        sigma, tau = np.arccos(cosine), _tau(view, rays.direction, cosine)
        counts = rays.covered & (cosine >= 0)
        omega = quadrilaterals(view, columns, rows, some)
        direction[some] = rays.direction
        parts["solid_angle"][some] = np.where(counts, omega, 0)
        parts["cosine"][some] = np.where(counts, cosine, 0)
        parts["position_index"][some] = position_index(
            sigma, tau, rays.up < 0, model=model
        )
        parts["sigma"][some], parts["tau"][some] = sigma, tau

    by_rows(fill, rows, columns)
    return GlareView(view=view, direction=direction, **parts)


def _tau(view: View, direction: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    # Angle from the view's up vector, as evalglare takes it: in a tilted view the up
    # vector is not turned into the picture's plane
    ahead = float(view.direction @ view.up)
    with np.errstate(divide="ignore", invalid="ignore"):
        across = (direction @ view.up - cosine * ahead) / np.sqrt(1 - cosine * cosine)
        angle: np.ndarray = np.arccos(np.clip(across, -1, 1))
    return np.where(np.isfinite(angle), angle, np.pi / 2)
