"""Camera rays through the pixels of a view.

A ray through a point of a pixel is computed from the ray through the pixel centre and
the derivatives of that ray across the pixel, for all view types alike.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.upload import on_device, vectors
from clerestory.scene.view import View


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
