"""Sun behind a clear film: rays of its whole disc, traced through the real film."""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.distant_emitters import DistantEmitters
from clerestory.engine.lower import LoweredScene
from clerestory.engine.visibility import offset
from truth.facades import Part
from truth.setting import FACE, HEIGHT, PLANE, SILL, WIDTH

_RAYS = 1 << 20

# Most surfaces that a path meets; prisms hold some rays for long
MOST = 200

# Area of the film through which rays are traced [m], and their distance before it
_WIDE, _HIGH, _BEFORE = 1.0, 0.4, 0.02


@dataclass
class Beams:
    """Sun behind the film.

    Attributes
    ----------
    direction : of rays that entered the room
    irradiance : of each, across itself, times the number of rays
    count : of rays that entered, of all of them
    lit : the sunlit part of the film: least and most x, least and most z, from the
        middle of the window [m]
    """

    direction: mi.Vector3f
    irradiance: mi.Float
    count: mi.UInt32
    lit: list[mi.Float]


def beams(film: LoweredScene, part: Part, sky: DistantEmitters) -> Beams:
    """Trace rays of the sun's whole disc through the film, around its middle."""
    sun = np.array(sky.direction).ravel()
    normal = np.array(sky.radiance).ravel() * 2 * np.pi * float(sky.one_minus_cos[0])
    onward, incident, weight, left = map(
        np.array, _through(film, sky, dr.opaque(mi.UInt32, 11))
    )
    entered = left & (onward[1] > 1e-4)
    direction = onward[:, entered]
    across = incident[entered] * weight[entered] / direction[1]
    irradiance = np.mean(normal) * across * entered.mean()
    # The reveal shades the window, and not one part of it another
    shift_x, shift_z = (PLANE - FACE) / -sun[1] * sun[[0, 2]]
    middle = SILL + HEIGHT / 2
    low, high = part.low - middle, part.high - middle
    lit = [
        max(-WIDTH / 2, -WIDTH / 2 - shift_x),
        min(WIDTH / 2, WIDTH / 2 - shift_x),
        max(low, -HEIGHT / 2 - shift_z),
        min(high, HEIGHT / 2 - shift_z),
    ]
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
    """Return where rays of the sun go, their cosine to the film, weight, and end.

    The last value tells whether a ray left the film.
    """
    rng = random_numbers(dr.arange(mi.UInt32, _RAYS), seed)
    u, v = rng.next_float32(), rng.next_float32()
    sun = sky.sample_sun(mi.Float(0.5), u, v).direction
    x, z = (rng.next_float32() - 0.5) * _WIDE, (rng.next_float32() - 0.5) * _HIGH
    context = mi.BSDFContext()

    # ------------------------------- Loop state -------------------------------
    ray = mi.Ray3f(mi.Point3f(x, -_BEFORE, z), -sun)
    active = sun.y < 0
    weight = mi.Float(1)  # in air: inside, radiance is that of the denser medium
    left = mi.Bool(False)  # whether the ray went off to infinity
    vertex = mi.UInt32(0)

    while active:
        si = film.scene.ray_intersect(ray, active)
        met = active & si.is_valid()
        left |= active & ~met
        a, b, c = rng.next_float32(), rng.next_float32(), rng.next_float32()
        sample, factor = si.bsdf().sample(context, si, a, mi.Point2f(b, c), met)
        onward = si.to_world(sample.wo)
        weight *= dr.select(met, dr.max(factor), 1)
        ray.o = dr.select(met, offset(film, si, onward, met), ray.o)
        ray.d = dr.select(met, onward, ray.d)
        vertex += 1
        active = met & (vertex < MOST) & (weight > 0)

    return ray.d, sun.y * -1, weight, left


def window_pdf(point, direction):
    """Return the density of aiming at the window, over its area alike [1/sr]."""
    distance = -point.y / direction.y
    x, z = point.x + distance * direction.x, point.z + distance * direction.z
    inside = (abs(x) <= WIDTH / 2) & (abs(z) <= HEIGHT / 2)
    reached = (direction.y < 0) & (point.y > 0) & inside
    area = WIDTH * HEIGHT * abs(direction.y)
    return dr.select(reached, dr.square(distance) / area, 0)


def borrowed(sun: Beams, point, pick):
    """Return a direction to borrowed sun, its irradiance, how far the window is."""
    number = dr.minimum(mi.UInt32(pick * mi.Float(sun.count)), sun.count - 1)
    towards = -dr.gather(mi.Vector3f, sun.direction, number)
    distance = -point.y / towards.y
    x, z = point.x + distance * towards.x, point.z + distance * towards.z
    low_x, high_x, low_z, high_z = sun.lit
    lit = (x > low_x) & (x < high_x) & (z > low_z) & (z < high_z)
    irradiance = dr.select(lit, dr.gather(mi.Float, sun.irradiance, number), 0)
    return towards, irradiance, distance


def random_numbers(number, seed):
    """Return a stream of random numbers for each number."""
    state, stream = mi.sample_tea_32(number, seed)
    return mi.PCG32(initstate=state, initseq=stream)
