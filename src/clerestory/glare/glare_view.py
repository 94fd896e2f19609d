"""Pixel quantities of a view: direction, solid angle, cosine and position index.

The quantities are computed once for all pictures of a view. Only pixels in the
hemisphere in front of the eye are valid.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Image, ImageMask, Pictures, Values
from clerestory.checks import require
from clerestory.glare.field_of_view import FieldOfView, in_field
from clerestory.glare.pixel_rays import pixel_rays, quadrilaterals
from clerestory.glare.position_index import PositionModel, position_index
from clerestory.scene.projection import Kind
from clerestory.scene.view import View

# Smallest picture width and height from which `pixel_angle` can be computed [pixels]
_SMALLEST = 21

# Pixels per block, so that several arrays fit in the cache of a processor core
_PIXELS = 24_000
_MOST_THREADS = 8


class Pitch(NamedTuple):
    """Smallest and largest angle per pixel [rad] over all directions in the picture."""

    least: Image
    most: Image


class EyeAngles(NamedTuple):
    """Angles of directions from the line of sight (sigma) and around it (tau) [rad].

    `cosine` is that of sigma, tau is the azimuth from the upward vertical.
    """

    cosine: Values
    sigma: Values
    tau: Values


@dataclass(frozen=True, eq=False)
class GlareView:
    """Direction, solid angle, cosine and position index of the pixels of a view.

    `sigma` is the angle from the line of sight, `tau` the azimuth around the line of
    sight from the upward vertical [rad]. Solid angle [sr] and cosine of sigma are zero
    for invalid pixels.
    """

    view: View
    direction: Float[np.ndarray, "row column 3"]
    solid_angle: Image
    cosine: Image
    position_index: Image
    sigma: Image
    tau: Image

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of pixel rows and columns."""
        rows, columns = self.solid_angle.shape
        return rows, columns

    @cached_property
    def valid(self) -> ImageMask:
        """Whether a pixel is in the hemisphere in front of the eye."""
        return self.solid_angle > 0

    @cached_property
    def total_solid_angle(self) -> float:
        """Solid angle of all valid pixels [sr]."""
        return float(self.solid_angle.sum())

    @cached_property
    def eye_weight(self) -> Image:
        """Vertical illuminance at the eye per luminance of each pixel [sr]."""
        return np.asarray(self.solid_angle * self.cosine)

    def flux(self, pictures: Pictures) -> Float[np.ndarray, " picture"]:
        """Integral of the luminance of each picture over solid angle [cd·sr/m²]."""
        return _sums(self._weights[pictures.dtype == np.float32][0], pictures)

    def illuminance(self, pictures: Pictures) -> Float[np.ndarray, " picture"]:
        """Vertical illuminance at the eye of each picture [lux]."""
        return _sums(self._weights[pictures.dtype == np.float32][1], pictures)

    @cached_property
    def _weights(self) -> list[tuple[Image, Image]]:
        # Solid angles and weights of illuminance in double and in single precision
        omega, weight = self.solid_angle, self.eye_weight
        return [(omega, weight), (omega.astype("f4"), weight.astype("f4"))]

    def in_field(self, field: FieldOfView) -> ImageMask:
        """Whether pixels lie in Guth's field of view."""
        up = np.cross(np.cross(self.view.direction, self.view.up), self.view.direction)
        return in_field(self.sigma, self.tau, self.direction @ up < 0, field=field)

    def angle_from(self, row: int, column: int) -> Image:
        """Angle between every pixel and the given pixel [rad]."""
        cosine = self.direction @ self.direction[row, column]
        angle: np.ndarray = np.arccos(np.clip(cosine, -1, 1))
        angle[row, column] = 0
        return angle

    @cached_property
    def _pitch(self) -> Pitch:
        return pixel_pitch(self.direction)

    @cached_property
    def _least_pitch(self) -> float:
        # Smallest angle per pixel over all valid pixels [rad]
        least = self._pitch.least[self.valid]
        return float(least[least > 0].min(initial=np.inf))

    def farthest_within(self, angle: float) -> int:
        """Largest number of pixel rows or columns that an angle [rad] may span."""
        # The factor accounts for variation of the angle per pixel
        reach = 1.25 * angle / self._least_pitch
        return int(min(np.ceil(reach) + 1, max(self.shape)))

    def surely_within(self, angle: float) -> Image:
        """Radius [pixels] within which pixels are surely within an angle [rad]."""
        with np.errstate(divide="ignore"):
            return np.asarray(angle / self._pitch.most)

    def pixel_angle(self) -> float:
        """Angle per pixel [rad], averaged over ten pixels along the central diagonal.

        evalglare divides the merging angle by this angle per pixel.
        """
        rows, columns = self.shape
        # The central pixel of evalglare, which counts rows from below
        row, column = rows - 1 - rows // 2, columns // 2
        cosine = self.direction[row, column] @ self.direction[row - 10, column + 10]
        return float(np.arccos(min(cosine, 1.0))) / 10


def glare_view(
    view: View, columns: int, rows: int, *, model: PositionModel = "guth"
) -> GlareView:
    """Return the pixel quantities of a view; recent results are cached.

    >>> eye = glare_view(View(kind="angular", horizontal=180, vertical=180), 64, 64)
    >>> round(float(eye.eye_weight.sum() / np.pi), 3)
    1.0
    """
    require(
        view.kind != "parallel",
        "pixels of a parallel view have no solid angles; a fisheye view (-vta, -vth)"
        " expected",
    )
    require(
        min(columns, rows) >= _SMALLEST,
        f"a picture of {columns} × {rows} pixels; at least {_SMALLEST} pixels per side"
        " expected",
    )
    axes = tuple(view.direction.tolist()), tuple(view.up.tolist())
    size = view.horizontal, view.vertical, view.shift, view.lift
    return _glare_view(view.kind, axes, size, (rows, columns), model)


def _sums(weights: Image, pictures: Pictures) -> Float[np.ndarray, " picture"]:
    # Rows are summed by einsum, which uses one thread: threads cost more than they save
    rows = np.einsum("ij,kij->ki", weights, pictures)
    return np.asarray(rows.sum(axis=1, dtype=float))


@lru_cache(maxsize=8)
def _glare_view(
    kind: Kind,
    axes: tuple[tuple[float, ...], tuple[float, ...]],
    size: tuple[float, float, float, float],
    shape: tuple[int, int],
    model: PositionModel,
) -> GlareView:
    # Hashable arguments for the cache: the view parameters that define the directions
    direction, up = map(np.array, axes)
    view = View(kind, np.zeros(3), direction, up, *size)
    rows, columns = shape
    direction = np.empty((rows, columns, 3))
    parts = {
        name: np.empty((rows, columns))
        for name in ("solid_angle", "cosine", "position_index", "sigma", "tau")
    }

    def fill(some: slice) -> None:
        rays = pixel_rays(view, columns, rows, some)
        cosine, sigma, tau = angles_from(view, rays.direction)
        counts = rays.covered & (cosine >= 0)
        omega = quadrilaterals(view, columns, rows, some)
        direction[some] = rays.direction
        parts["solid_angle"][some] = np.where(counts, omega, 0)
        parts["cosine"][some] = np.where(counts, cosine, 0)
        parts["position_index"][some] = position_index(
            sigma, tau, rays.up < 0, model=model
        )
        parts["sigma"][some], parts["tau"][some] = sigma, tau

    _by_rows(fill, rows, columns)
    return GlareView(view=view, direction=direction, **parts)


def _by_rows(work: Callable[[slice], None], rows: int, columns: int) -> None:
    # Call `work` in parallel with slices that cover all rows
    size = max(1, _PIXELS // columns)
    blocks = [slice(at, min(at + size, rows)) for at in range(0, rows, size)]
    with ThreadPoolExecutor(min(os.cpu_count() or 1, _MOST_THREADS)) as pool:
        list(pool.map(work, blocks))


def angles_from(view: View, direction: Directions) -> EyeAngles:
    """Return the angles of directions from the line of sight of a view.

    As in evalglare, the up vector of a tilted view is not projected perpendicular to
    the line of sight.
    """
    cosine = np.clip(direction @ view.direction, -1, 1)
    ahead = float(view.direction @ view.up)
    with np.errstate(divide="ignore", invalid="ignore"):
        across = (direction @ view.up - cosine * ahead) / np.sqrt(1 - cosine * cosine)
        angle = np.arccos(np.clip(across, -1, 1))
    tau = np.where(np.isfinite(angle), angle, np.pi / 2)
    return EyeAngles(cosine, np.arccos(cosine), tau)


def pixel_pitch(direction: Float[np.ndarray, "row column 3"]) -> Pitch:
    """Return the angles per pixel [rad], from the gradient of the pixel directions."""
    rows, columns = direction.shape[:2]
    pitch = Pitch(np.empty((rows, columns)), np.empty((rows, columns)))

    def fill(some: slice) -> None:
        # Include one row above and one below, for the gradient
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

    _by_rows(fill, rows, columns)
    return pitch
