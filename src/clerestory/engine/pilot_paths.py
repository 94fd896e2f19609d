"""Surface points sampled by pilot paths.

Pilot paths scatter diffusely at opaque surfaces and end at windows. The vertices of
pilot paths are samples of the surfaces that may be sunlit (`sun_patches`) and from
which portals are sampled (`path_guiding`).
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.lower import LoweredScene
from clerestory.engine.sampler import DIRECTION_U, DIRECTION_V, PathNumbers, points
from clerestory.engine.upload import launching
from clerestory.engine.visibility import offset, only_reflects

# Number of pilot paths, and of vertices per path.
PILOT_PATHS = 1 << 13
_VERTICES = 4


@dataclass
class SurfacePoints:
    """Points on the surfaces of a room.

    `start` is the point offset from the surface [m]; `normal` is on the side of the
    arriving path.
    """

    point: Float[np.ndarray, "n 3"]
    start: Float[np.ndarray, "n 3"]
    normal: Float[np.ndarray, "n 3"]

    def __len__(self) -> int:
        return len(self.point)

    def __add__(self, other: "SurfacePoints") -> "SurfacePoints":
        """Return the points of both."""
        mine, theirs = vars(self), vars(other)
        return SurfacePoints(*(np.concatenate([mine[k], theirs[k]]) for k in mine))

    def thinned(self, most: int) -> "SurfacePoints":
        """Return at most a given number of the points, evenly spaced."""
        return self.repeated(min(most, len(self)))

    def repeated(self, count: int) -> "SurfacePoints":
        """Return a given number of points, evenly spaced or repeated."""
        chosen = np.arange(count) * len(self) // max(count, 1)
        return SurfacePoints(*(part[chosen] for part in vars(self).values()))


def sample_surfaces(model: LoweredScene, ray: mi.Ray3f) -> SurfacePoints:
    """Trace pilot paths from given first segments; return the surface points hit."""
    index, seed = dr.arange(mi.UInt32, dr.width(ray.d)), mi.UInt32(0)
    numbers = PathNumbers(points(0, dr.width(ray.d)), seed, index, mi.UInt32(0))
    active = mi.Bool(True)
    found = []
    for vertex in range(_VERTICES):
        hit = model.scene.ray_intersect_preliminary(ray, active=active)
        active &= hit.is_valid()
        shape = dr.reinterpret_array(mi.UInt32, hit.shape)
        flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, active)
        active &= mi.has_flag(flags, mi.BSDFFlags.Smooth) & only_reflects(flags)
        si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, active)
        normal = dr.mulsign(si.n, -dr.dot(si.n, ray.d))
        here = numbers.at(mi.UInt32(vertex))
        u, v = here.sobol(DIRECTION_U), here.sobol(DIRECTION_V)
        local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
        direction = mi.Frame3f(normal).to_world(local)
        ray = mi.Ray3f(offset(model, si, direction, active), direction)
        with launching():
            dr.eval(ray, active, si.p, normal)
        kept = active.numpy()
        found.append([part.numpy().T[kept] for part in (si.p, ray.o, normal)])
    point, start, normal = (
        np.concatenate(part).astype(float) for part in zip(*found, strict=True)
    )
    return SurfacePoints(point, start, normal)
