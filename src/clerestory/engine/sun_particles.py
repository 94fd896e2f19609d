"""Particles traced from suns by way of surfaces that refract or focus sunlight.

Particles start at suns, aimed at surfaces that only BSDF sampling could find
(`caustic_surfaces`), and are followed through refractions, reflections and narrow
highlights to the first matt surface. From where they land, and from sensors that they
pass, the direction in which they arrive leads back to a sun.

Reference: H. W. Jensen, "Importance driven path tracing using the photon map",
Rendering Techniques 1995.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.illumination import Illumination
from clerestory.engine.sampler import mix, random_number
from clerestory.engine.spherical_rectangle import Parallelograms, fold
from clerestory.engine.upload import launching, on_device, search
from clerestory.engine.visibility import interaction, offset, only_reflects

# Number of particles of a round, and largest number of surfaces that a particle meets.
_PARTICLES, _MOST_SURFACES = 1 << 17, 32

# Salt of the random numbers of a round, which differ between rounds.
_SALT = 0x51ED270B

# Smallest density of directions of narrow highlights [1/sr].
_NARROW = 4 / np.pi

# Probability that a particle goes on where a surface has highlights as well.
_ONWARD = 0.5

# Distance to the first surface from where particles are followed [m].
_CLOSE = 0.01


@dataclass
class Particles:
    """Last segments of particles, from the last scattering to a matt surface.

    Attributes
    ----------
    start, end : ends of the segments [m]
    normal : unit normals of the matt surfaces, on the side of the segments; 0 where a
        segment leaves the scene
    blur : half angle of the cone of directions in which neighbours may arrive [rad]
    chain : hash of the surfaces that scattered the particle, and of how they did
    """

    start: Float[np.ndarray, "n 3"]
    end: Float[np.ndarray, "n 3"]
    normal: Float[np.ndarray, "n 3"]
    blur: Float[np.ndarray, " n"]
    chain: Int[np.ndarray, " n"]

    def __len__(self) -> int:
        return len(self.end)

    def __add__(self, other: "Particles") -> "Particles":
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return Particles(*(np.concatenate(pair) for pair in pairs))

    def some(self, chosen: Int[np.ndarray, " m"]) -> "Particles":
        """Return the particles of given indices."""
        return Particles(*(part[chosen] for part in vars(self).values()))


@dr.syntax
def trace_particles(
    scene: Illumination,
    triangles: Float[np.ndarray, "triangle 3 3"],
    *,
    reach: float,
    seed: int,
) -> Particles:
    """Trace a round of particles, aimed at points of triangles.

    Particles are followed to a distance `reach` from where they leave the scene [m].
    """
    model = scene.model
    lane = dr.arange(mi.UInt32, _PARTICLES)
    key = mix(dr.opaque(mi.UInt32, seed), mi.UInt32(_SALT))
    ray, sun_radius = _start(scene, triangles, lane, key)
    beyond = dr.opaque(mi.Float, reach)

    # ------------------------------- Loop state -------------------------------
    ray = mi.Ray3f(ray)
    travelling = mi.Bool(True)
    focused = mi.Bool(False)  # whether a surface has refracted or focused the particle
    weight = mi.Float(1)  # share of the power
    blur = mi.Float(sun_radius)  # half angle of the cone of neighbours [rad]
    start = mi.Point3f(ray.o)  # last point of scattering
    end, normal = mi.Point3f(0), mi.Vector3f(0)
    arrived = mi.Bool(False)
    chain = mi.UInt32(0)
    number = mi.UInt32(0)
    while travelling:
        hit = model.scene.ray_intersect_preliminary(ray, active=travelling)
        # A particle that leaves the scene may pass sensors
        leaves = travelling & focused & ~hit.is_valid()
        end = dr.select(leaves, ray.o + ray.d * beyond, end)
        arrived |= leaves
        travelling &= hit.is_valid()
        si = interaction(hit, ray, travelling)
        shape = dr.reinterpret_array(mi.UInt32, si.shape)
        flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, travelling)
        emitter = dr.gather(mi.UInt32, model.emitter_of_shape, shape, travelling)
        depth = dr.gather(mi.Float, model.thickness_of_shape, shape, travelling)
        travelling &= (emitter == 0) & (depth == 0)
        pick, u, v, again, roulette = (
            random_number(key, lane, 8 + 8 * number + n) for n in range(5)
        )
        sample, factor = si.bsdf().sample(
            mi.BSDFContext(), si, pick, mi.Point2f(u, v), travelling
        )
        kind = sample.sampled_type
        null = mi.has_flag(kind, mi.BSDFFlags.Null)
        delta = mi.has_flag(kind, mi.BSDFFlags.Delta) & ~null
        narrow = delta | (~null & (sample.pdf > _NARROW))

        # Land on matt surfaces, unless a highlight sends the particle on
        matt = mi.has_flag(flags, mi.BSDFFlags.Smooth) & only_reflects(flags)
        goes_on = narrow & (again < _ONWARD)
        lands = travelling & focused & matt & ~goes_on
        end = dr.select(lands, si.p, end)
        normal = dr.select(lands, dr.mulsign(si.n, si.wi.z), normal)
        arrived |= lands
        travelling &= ~lands & (null | narrow)

        # Reflection by flat smooth surfaces alone is left to mirror images
        bent = narrow & ~null
        if dr.hint(scene.images_of_suns.count > 0, mode="scalar"):
            plane = scene.images_of_suns.plane(model, shape, si, travelling)
            bent &= (plane == 0) | ~mi.has_flag(kind, mi.BSDFFlags.DeltaReflection)
        focused |= travelling & bent
        wide = dr.sqrt(dr.inv_pi / dr.maximum(sample.pdf, 1e-3))
        blur = dr.select(travelling & narrow & ~delta, dr.maximum(blur, wide), blur)
        start = dr.select(travelling & narrow, si.p, start)
        chain = dr.select(travelling & narrow, mix(chain + shape, kind), chain)
        direction = si.to_world(sample.wo)
        ray.o = dr.select(travelling, offset(model, si, direction, travelling), ray.o)
        ray.d = dr.select(travelling, direction, ray.d)
        # Radiance changes at interfaces, power does not
        gain = dr.select(travelling, dr.max(factor), 1)
        weight *= dr.select(
            delta & (sample.eta > 0), gain * dr.square(sample.eta), gain
        )
        travelling &= roulette < weight
        weight = dr.maximum(weight, 1)
        number += 1
        travelling &= number < _MOST_SURFACES
    with launching():
        dr.eval(arrived, start, end, normal, blur, chain)
    kept = arrived.numpy()
    corners = (part.numpy().T[kept].astype(float) for part in (start, end, normal))
    number = chain.numpy()[kept].astype(np.int64)
    return Particles(*corners, blur.numpy()[kept].astype(float), number)


def _start(
    scene: Illumination, triangles: Float[np.ndarray, "triangle 3 3"], lane, key
):
    # First segments of particles: from the sun to points of the triangles, uniform
    # across the beam
    a, b, c = np.moveaxis(triangles, 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    cumulative = on_device(mi.Float, np.cumsum(area) / max(area.sum(), 1e-30))
    surface = Parallelograms.of(a, b - a, c - a)
    pick, u, v, which, x, y, kept = (random_number(key, lane, n) for n in range(7))
    chosen = surface.take(search(cumulative, len(area), pick))
    point = chosen.point(*fold(u, v))
    sun = scene.distant.sample_sun(which, x, y)
    box = scene.model.scene.bbox()
    far = dr.opaque(mi.Float, 2 * float(dr.norm(box.max - box.min)))
    across = dr.cross(chosen.edge_u, chosen.edge_v)
    cosine = dr.abs(dr.dot(across, sun.direction)) * dr.rsqrt(dr.squared_norm(across))
    # A particle that is not kept starts beyond all surfaces
    origin = point + sun.direction * far
    heading = dr.select(kept < cosine, -sun.direction, sun.direction)
    ray = mi.Ray3f(origin, heading)
    # Follow it from close to the first surface: `offset` increases with distance, and
    # would exceed small prisms
    hit = scene.model.scene.ray_intersect_preliminary(ray)
    skipped = dr.select(hit.is_valid(), dr.maximum(hit.t - _CLOSE, 0), 0)
    ray.o += heading * skipped
    return ray, dr.sqrt(2 * dr.max(scene.distant.one_minus_cos))
