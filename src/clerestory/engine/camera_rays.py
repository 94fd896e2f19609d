"""Camera rays through the pixels of a view or the cells of a sphere, and given rays.

A ray through a point of a pixel is computed from the ray through the pixel centre and
the derivatives of that ray across the pixel, for all view types alike. A ray through a
point of a cell is computed by the equal-area map of `hemisphere.sphere_square`.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.sampler import (
    DIRECTION_U,
    DIRECTION_V,
    PathNumbers,
    random_number,
)
from clerestory.engine.upload import on_device, vectors
from clerestory.image.camera import Camera, PixelsOrCells
from clerestory.scene.ray_bundles import RayBundles
from clerestory.scene.sphere_cells import SphereCells
from clerestory.scene.view import View

# Dimension of the random number that selects the ray of the first path of a bundle
_FIRST_RAY = 0x30000


@dataclass
class CameraRays:
    """Rays through pixel centres, and their derivatives across a pixel.

    The viewpoint is the origin of translated coordinates.
    """

    origin: mi.Point3f
    direction: mi.Vector3f
    across: mi.Vector3f
    upwards: mi.Vector3f
    origin_across: mi.Vector3f | None
    origin_upwards: mi.Vector3f | None
    valid: mi.Bool

    @classmethod
    def of(cls, view: View, columns: int, rows: int) -> "CameraRays":
        """Return the rays of a view's pixels, row by row from the top."""

        def at(x: float, y: float):
            return view.rays(columns, rows, np.full((rows, columns, 2), [x, y]))

        middle = at(0.5, 0.5)
        left, right, below, above = at(0, 0.5), at(1, 0.5), at(0.5, 0), at(0.5, 1)

        def change(one, two, what: str):
            both = (one.valid & two.valid)[..., None]
            step = np.where(both, getattr(two, what) - getattr(one, what), 0)
            return vectors(mi.Vector3f, step.reshape(-1, 3))

        moving = view.kind == "parallel" or view.fore > 0
        return cls(
            vectors(mi.Point3f, (middle.origin - view.position).reshape(-1, 3)),
            vectors(mi.Vector3f, middle.direction.reshape(-1, 3)),
            change(left, right, "direction"),
            change(below, above, "direction"),
            change(left, right, "origin") if moving else None,
            change(below, above, "origin") if moving else None,
            on_device(mi.Bool, middle.valid),
        )

    def through(self, pixel, x, y):
        """Return the ray through a point of a pixel."""
        x, y = x - 0.5, y - 0.5
        direction = dr.gather(mi.Vector3f, self.direction, pixel)
        direction += dr.gather(mi.Vector3f, self.across, pixel) * x
        direction += dr.gather(mi.Vector3f, self.upwards, pixel) * y
        origin = dr.gather(mi.Point3f, self.origin, pixel)
        if self.origin_across is not None:
            origin += dr.gather(mi.Vector3f, self.origin_across, pixel) * x
            origin += dr.gather(mi.Vector3f, self.origin_upwards, pixel) * y
        valid = dr.gather(mi.Bool, self.valid, pixel)
        return mi.Ray3f(origin, dr.normalize(direction)), valid


@dataclass
class CellRays:
    """Rays from a point through cells of the sphere: corner and size in the map.

    The point is the origin of translated coordinates.
    """

    corner: mi.Point2f
    size: mi.Float

    @classmethod
    def of(cls, cells: SphereCells) -> "CellRays":
        """Return the rays of the cells."""
        size = 0.5**cells.level
        corner = (on_device(mi.Float, part * size) for part in cells.place.T)
        return cls(mi.Point2f(*corner), on_device(mi.Float, size))

    def through(self, cell, x, y):
        """Return the ray through a point of a cell."""
        size = dr.gather(mi.Float, self.size, cell)
        corner = dr.gather(mi.Point2f, self.corner, cell)
        direction = _from_square(corner + mi.Point2f(x, y) * size)
        return mi.Ray3f(mi.Point3f(0), direction), dr.full(
            mi.Bool, True, dr.width(direction)
        )


@dataclass
class GivenRays:
    """Rays of bundles of given rays, from the mean of their origins."""

    origin: mi.Point3f
    direction: mi.Vector3f
    valid: mi.Bool
    rays: int

    @classmethod
    def of(cls, bundles: RayBundles) -> "GivenRays":
        """Return the rays of the bundles."""
        origin = (bundles.origin - bundles.position).reshape(-1, 3)
        towards = bundles.direction.reshape(-1, 3)
        return cls(
            vectors(mi.Point3f, origin),
            vectors(mi.Vector3f, towards),
            on_device(mi.Bool, bundles.valid.ravel()),
            bundles.rays,
        )

    def through(self, bundle, x, y):
        """Return the ray of a bundle at a fraction x of their number."""
        most = dr.opaque(mi.UInt32, self.rays)
        ray = dr.minimum(mi.UInt32(x * mi.Float(most)), most - 1)
        index = bundle * most + ray
        origin = dr.gather(mi.Point3f, self.origin, index)
        direction = dr.gather(mi.Vector3f, self.direction, index)
        return mi.Ray3f(origin, direction), dr.gather(mi.Bool, self.valid, index)


def camera_rays(camera: PixelsOrCells) -> CameraRays | CellRays | GivenRays:
    """Return the rays through pixels or cells, or given rays."""
    match camera:
        case Camera():
            return CameraRays.of(camera.view, camera.columns, camera.rows)
        case SphereCells():
            return CellRays.of(camera)
        case RayBundles():
            return GivenRays.of(camera)


def sampled_ray(
    rays: CameraRays | CellRays | GivenRays, pixel: mi.UInt32, numbers: PathNumbers
):
    """Sample the camera ray of a path; return it, and whether it is valid.

    The paths of a pixel are distributed evenly over given rays: a choice at random of
    few rays, one of which may see the window, has more variance than the paths.
    """
    if isinstance(rays, GivenRays):
        share = mi.Float(numbers.index) / mi.Float(numbers.points.stride)
        first, purpose = numbers.points.first, mi.UInt32(_FIRST_RAY)
        x = share + random_number(numbers.seed, first, purpose)
        return rays.through(pixel, x - dr.floor(x), mi.Float(0))
    x, y = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
    return rays.through(pixel, x, y)


def _from_square(point: mi.Point2f) -> mi.Vector3f:
    # See `hemisphere.sphere_square.sphere_from_square`
    place = 2 * point - 1
    wide, tall = dr.abs(place.x), dr.abs(place.y)
    height = 1 - (wide + tall)
    radius = 1 - dr.abs(height)
    turn = dr.select(radius > 0, (tall - wide) / dr.maximum(radius, 1e-12), 0)
    sine, cosine = dr.sincos((turn + 1) * (dr.pi / 4))
    flat = radius * dr.safe_sqrt(2 - radius * radius)
    x, y = dr.copysign(flat * cosine, place.x), dr.copysign(flat * sine, place.y)
    up = dr.copysign(1 - radius * radius, height)
    return dr.normalize(mi.Vector3f(x, y, up))
