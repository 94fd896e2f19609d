"""Sampling of rays from room surfaces along lobes of scattered sunlight.

A blind or a film scatters sunlight into narrow lobes, which sampling of window points
seldom finds. Leaving directions are therefore sampled from a window's BSDF for the
incident direction of the sun; rays from room surfaces are traced in the reverse
direction to the windows. The same is done for narrow highlights of slightly rough flat
surfaces, from the distribution of their slopes.

The sampled direction does not depend on the surface that the ray hits, so its density
is the sum over all lobes.

Reference: B. Walter, "Notes on the Ward BRDF", Cornell 2005 (sampling of half vectors).
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.bsdf.scattering_function import Function
from clerestory.directions import unit
from clerestory.engine.materials.bsdf_file import Table, forward_table
from clerestory.engine.narrow_highlights import Kind, highlights
from clerestory.engine.sampled_sources import suns_of
from clerestory.engine.sampler import DIRECTION_U, DIRECTION_V, PathNumbers, points
from clerestory.engine.upload import on_device, vectors
from clerestory.scene.model import BsdfSurface, Material, Polygon, Scene
from clerestory.scene.surface import area_vector

# Greatest number of window groups (equal BSDF and orientation), the largest in area.
MOST = 4

# Lobes are sampled if their density, averaged over sampled directions, is at least this
# multiple of the cosine-weighted density; number of directions for the estimate.
_NARROW = 4.0
_TRIED = 1024

# Least sine of the angle between up vector and normal that defines a frame.
_UPRIGHT = 1e-6

# Transmission function by side of the sun: behind (1) or in front of (-1) a surface.
_SIDES: dict[int, Function] = {1: "transmission_front", -1: "transmission_back"}


@dataclass
class Lobes:
    """Lobes of sunlight transmitted by windows of one BSDF and one orientation.

    The table samples the BSDF for a given incident direction, in a local frame whose z
    axis is the normal of the windows. The sun is behind the windows if `side` is 1, and
    in front of the windows if -1. `chance` is the probability of sampling these lobes.
    """

    table: Table
    frame: mi.Frame3f
    side: int
    chance: float

    def sample(self, sun, u, v):
        """Return the direction of a ray to a window along a lobe of sunlight."""
        disc, _, _ = self.table.sample(mi.UInt32(0), self.frame.to_local(sun), u, v)
        height = dr.safe_sqrt(1 - dr.squared_norm(disc))
        return -self.frame.to_world(mi.Vector3f(disc.x, disc.y, self.side * height))

    def pdf(self, direction, sun):
        """Return the density of sampling a direction [1/sr]."""
        leaving, incident = self.frame.to_local(-direction), self.frame.to_local(sun)
        _, density = self.table.evaluate(mi.UInt32(0), leaving, incident)
        met = (leaving.z * self.side > 0) & (incident.z * self.side < 0)
        return dr.select(met, density * dr.abs(leaving.z), 0)

    def concentration(self, suns: Float[np.ndarray, "sun 3"]) -> float:
        """Return the greatest ratio of lobe density to cosine-weighted density."""
        normal = np.array(self.frame.n).ravel()
        shining = suns[(suns @ normal) * self.side < 0]
        zero, index = mi.UInt32(0), dr.arange(mi.UInt32, _TRIED)
        numbers = PathNumbers(points(0, _TRIED), zero, index, zero)
        u, v = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
        found = 0.0
        for direction in shining[:MOST]:
            sun = vectors(mi.Vector3f, direction[None])
            along = self.sample(sun, u, v)
            cosine = dr.maximum(dr.abs(dr.dot(along, self.frame.n)), 1e-6)
            density = dr.mean(self.pdf(along, sun) / cosine) * dr.pi
            found = max(found, float(density[0]))
        return found


@dataclass
class Highlight:
    """Highlights of the sun in surfaces of one orientation and roughness.

    `chance` is the probability of sampling these highlights.
    """

    normal: mi.Vector3f
    roughness2: mi.Float
    chance: float

    @classmethod
    def of(cls, kind: Kind, chance: float) -> "Highlight":
        """Return the highlights of a roughness and normal."""
        roughness, normal = kind
        # The normal of a kind is rounded; small errors change narrow highlights
        normals = vectors(mi.Vector3f, unit(np.array(normal))[None])
        return cls(normals, on_device(mi.Float, [roughness**2]), chance)

    def sample(self, sun, u, v):
        """Return the direction of a ray to a surface along a highlight of the sun."""
        slope2 = -self.roughness2 * dr.log(1 - u)
        cosine = dr.rsqrt(1 + slope2)
        s, c = dr.sincos(2 * dr.pi * v)
        sine = dr.sqrt(slope2) * cosine
        facing = mi.Frame3f(dr.mulsign(self.normal, dr.dot(self.normal, sun)))
        half = facing.to_world(mi.Vector3f(sine * c, sine * s, cosine))
        return sun - 2 * dr.dot(half, sun) * half

    def pdf(self, direction, sun):
        """Return the density of sampling a direction [1/sr]."""
        half = sun - direction
        length = dr.norm(half)
        half /= dr.maximum(length, 1e-6)
        side = dr.mulsign(mi.Float(1), dr.dot(self.normal, sun))
        cosine = side * dr.dot(half, self.normal)
        valid = (cosine > 1e-3) & (length > 1e-6)
        cosine2 = dr.square(dr.select(valid, cosine, 1))
        slope2 = dr.squared_norm(half - side * cosine * self.normal) / cosine2
        bell = dr.exp(-slope2 / self.roughness2)
        bell *= dr.inv_pi / (self.roughness2 * cosine2 * dr.sqrt(cosine2))
        return dr.select(valid, bell / (4 * dr.dot(half, sun)), 0)


@dataclass
class SunLobes:
    """Lobes of sunlight from windows and narrow highlights of a scene."""

    groups: list[Lobes | Highlight]

    @classmethod
    def of(cls, scene: Scene) -> "SunLobes":
        """Return the narrow lobes of the largest surfaces that a sun can light."""
        found: dict[tuple, float] = {}
        suns = np.reshape([sun.direction for sun in suns_of(scene)], (-1, 3))
        for surface in scene.surfaces:
            material = scene.materials[surface.material]
            if isinstance(surface, Polygon) and is_layer(material):
                vector = area_vector(surface.vertices)
                area = float(np.linalg.norm(vector))
                if area == 0:
                    continue
                normal = tuple(np.round(vector / area, 5))
                for side in (1, -1):
                    shone = np.any(suns @ vector * side < 0)
                    if shone and material.bsdf.has(_SIDES[side]):
                        key = (surface.material, side, normal)
                        found[key] = found.get(key, 0) + area
        made = {key: _lobes(scene, *key) for key in sorted(found, key=found.get)}
        narrow = [key for key in made if made[key].concentration(suns) >= _NARROW]
        largest = narrow[-MOST:]
        glossy = highlights(scene) if len(suns) else {}
        total = sum(found[key] for key in largest) + sum(glossy.values())
        for key in largest:
            made[key].chance = found[key] / total
        rough = [Highlight.of(kind, area / total) for kind, area in glossy.items()]
        return cls([*(made[key] for key in largest), *rough])

    def sample(self, pick, sun, u, v):
        """Return the direction of a ray to a window along a lobe of sunlight."""
        direction = self.groups[0].sample(sun, u, v)
        before = self.groups[0].chance
        for lobes in self.groups[1:]:
            chosen = pick >= before
            direction = dr.select(chosen, lobes.sample(sun, u, v), direction)
            before += lobes.chance
        return direction

    def pdf(self, direction, sun):
        """Return the density of sampling a direction [1/sr]."""
        parts = (lobes.chance * lobes.pdf(direction, sun) for lobes in self.groups)
        return sum(parts, start=mi.Float(0))


def is_layer(material: Material) -> bool:
    """Whether a material is a BSDF of zero thickness (not a proxy for geometry)."""
    return isinstance(material, BsdfSurface) and material.thickness == 0


def _lobes(scene: Scene, name: str, side: int, normal: tuple) -> Lobes:
    material = scene.materials[name]
    up = vectors(mi.Vector3f, (material.up @ material.transform)[None])
    facing = dr.normalize(vectors(mi.Vector3f, [normal]))
    right = dr.cross(up, facing)
    length = dr.norm(right)
    right *= dr.select(length > _UPRIGHT, 1 / length, 0)
    frame = mi.Frame3f(right, dr.cross(facing, right), facing)
    return Lobes(forward_table(material.bsdf, _SIDES[side]), frame, side, 1.0)
