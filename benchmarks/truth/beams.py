"""Sun behind a clear film: rays of its whole disc, traced through the real prisms."""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.distant_emitters import DistantEmitters
from clerestory.engine.lower import LoweredScene
from clerestory.engine.visibility import offset
from truth.setting import FACE, HEIGHT, PLANE, WIDTH

_RAYS = 1 << 18

# Most surfaces that a path meets; prisms hold some rays for long
MOST = 200


@dataclass
class Beams:
    """Sun behind the film.

    Attributes
    ----------
    direction : of rays that entered the room
    irradiance : of each, across itself, times the number of rays
    count : of rays that entered, of all of them
    lit : the sunlit part of the window: least and most x, least and most z
    """

    direction: mi.Vector3f
    irradiance: mi.Float
    count: mi.UInt32
    lit: list[mi.Float]


def beams(film: LoweredScene, sky: DistantEmitters) -> Beams:
    """Trace rays of the sun's whole disc through the film."""
    sun = np.array(sky.direction).ravel()
    normal = np.array(sky.radiance).ravel() * 2 * np.pi * float(sky.one_minus_cos[0])
    onward, incident, left = map(
        np.array, _through(film, sky, dr.opaque(mi.UInt32, 11))
    )
    entered = left & (onward[1] > 1e-4)
    direction = onward[:, entered]
    irradiance = np.mean(normal) * incident[entered] / direction[1] * entered.mean()
    shift = (PLANE - FACE) / -sun[1] * sun[[0, 2]]
    lit = []
    for half, moved in zip((WIDTH / 2, HEIGHT / 2), shift, strict=True):
        lit += [max(-half, -half - moved), min(half, half - moved)]
    made = Beams(
        mi.Vector3f(direction.astype(np.float32)),
        mi.Float(irradiance.astype(np.float32)),
        dr.opaque(mi.UInt32, int(entered.sum())),
        [dr.opaque(mi.Float, float(edge)) for edge in lit],
    )
    dr.make_opaque(made.direction, made.irradiance)
    return made


@dr.syntax
def _through(film: LoweredScene, sky: DistantEmitters, seed: mi.UInt32):
    """Return where rays of the sun go, their cosine to the film, whether they left."""
    rng = random_numbers(dr.arange(mi.UInt32, _RAYS), seed)
    u, v = rng.next_float32(), rng.next_float32()
    sun = sky.sample_sun(mi.Float(0.5), u, v).direction
    place = mi.Point3f(rng.next_float32() - 0.5, -0.02, rng.next_float32() - 0.5)
    context = mi.BSDFContext()

    # ------------------------------- Loop state -------------------------------
    ray = mi.Ray3f(place, -sun)
    active = sun.y < 0
    left = mi.Bool(False)  # whether the ray went off to infinity
    vertex = mi.UInt32(0)

    while active:
        si = film.scene.ray_intersect(ray, active)
        met = active & si.is_valid()
        left |= active & ~met
        a, b, c = rng.next_float32(), rng.next_float32(), rng.next_float32()
        sample, _ = si.bsdf().sample(context, si, a, mi.Point2f(b, c), met)
        onward = si.to_world(sample.wo)
        ray.o = dr.select(met, offset(film, si, onward, met), ray.o)
        ray.d = dr.select(met, onward, ray.d)
        vertex += 1
        active = met & (vertex < MOST)

    return ray.d, sun.y * -1, left


def random_numbers(number, seed):
    """Return a stream of random numbers for each number."""
    state, stream = mi.sample_tea_32(number, seed)
    return mi.PCG32(initstate=state, initseq=stream)
