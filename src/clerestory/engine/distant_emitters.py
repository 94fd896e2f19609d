"""Distant emitters: sky and ground as a directional map, suns as discs."""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.directional_map import DirectionalMap, map_directions
from clerestory.engine.sampled_sources import suns_of
from clerestory.engine.sampler import Distribution
from clerestory.engine.upload import on_device, vectors
from clerestory.scene.model import DistantSource, Scene

# Number of cells along an edge of the table of sky radiance.
_EDGE = 512


@dataclass
class SunSample:
    """A sampled direction to a sun, its pdf [1/sr], and the sun's radiance."""

    direction: mi.Vector3f
    pdf: mi.Float
    radiance: mi.Color3f


@dataclass
class DistantEmitters:
    """Dr.Jit arrays of all distant sources.

    `dome` is the total radiance of the wide sources (sky, ground). The arrays describe
    the narrow sources (suns): `one_minus_cos` is 1 − cos of the angular radius, and
    `chosen` the sampling probability, proportional to irradiance.
    """

    dome: DirectionalMap | None
    suns: int
    direction: mi.Vector3f
    radiance: mi.Color3f
    one_minus_cos: mi.Float
    chosen: Distribution

    @classmethod
    def of(cls, scene: Scene) -> "DistantEmitters":
        """Return the tables of a scene's distant sources."""
        narrow = suns_of(scene)
        wide = [source for source in scene.distant if source not in narrow]
        # Kernels need non-empty tables: add an unused entry if there are no suns
        direction = np.array([s.direction for s in narrow] or [[0.0, 0.0, 1.0]])
        radiance = np.array([_at_centre(scene, s) for s in narrow] or [np.zeros(3)])
        half = np.radians([s.angle_deg / 2 for s in narrow] or [0.5])
        depth = 2 * np.sin(half / 2) ** 2
        power = radiance.mean(axis=1) * depth
        return cls(
            dome=_dome(scene, wide) if wide else None,
            suns=len(narrow),
            direction=vectors(mi.Vector3f, direction),
            radiance=vectors(mi.Color3f, radiance),
            one_minus_cos=on_device(mi.Float, depth),
            chosen=Distribution.of(power if power.any() else np.ones(len(power))),
        )

    def environment_radiance(self, direction):
        """Return the radiance of the wide sources (sky, ground) in a direction."""
        if self.dome is None:
            return mi.Color3f(0)
        return self.dome.look_up(direction)

    @dr.syntax
    def sun_radiance(self, direction, active):
        """Return the radiance of suns in a direction, and its sampling pdf [1/sr]."""
        found = mi.Color3f(0)
        pdf = mi.Float(0)
        number = mi.UInt32(0)
        while active & (number < self.suns):
            towards = dr.gather(mi.Vector3f, self.direction, number)
            depth = dr.gather(mi.Float, self.one_minus_cos, number)
            apart = 0.5 * dr.squared_norm(direction - towards)
            inside = apart <= depth
            radiance = dr.gather(mi.Color3f, self.radiance, number)
            found += dr.select(inside, radiance, 0)
            density = self.chosen.probability(number) / (2 * dr.pi * depth)
            pdf += dr.select(inside, density, 0)
            number += 1
        return found, pdf

    def sample_sun(self, pick, u, v) -> SunSample:
        """Sample a direction to a sun."""
        number, chance, _ = self.chosen.sample(pick)
        depth = dr.gather(mi.Float, self.one_minus_cos, number)
        axis = dr.gather(mi.Vector3f, self.direction, number)
        height = u * depth
        flat = dr.safe_sqrt(height * (2 - height))
        sine, cosine = dr.sincos(2 * dr.pi * v)
        local = mi.Vector3f(flat * cosine, flat * sine, 1 - height)
        pdf = chance / (2 * dr.pi * depth)
        radiance = dr.gather(mi.Color3f, self.radiance, number)
        return SunSample(mi.Frame3f(axis).to_world(local), pdf, radiance)


def _at_centre(scene: Scene, source: DistantSource) -> Float[np.ndarray, "3"]:
    material = scene.materials[source.material]
    if material.pattern is None:
        return material.radiance
    return material.radiance * material.pattern.value(source.direction[None])[0]


def _dome(scene: Scene, sources: list[DistantSource]) -> DirectionalMap:
    direction = map_directions(_EDGE)
    total = np.zeros_like(direction)
    for source in sources:
        material = scene.materials[source.material]
        least = np.cos(np.radians(source.angle_deg / 2)) - 1e-9
        inside = direction @ source.direction >= least
        radiance = np.broadcast_to(material.radiance, (int(inside.sum()), 3))
        if material.pattern is not None:
            radiance = radiance * material.pattern.value(direction[inside])
        total[inside] += radiance
    return DirectionalMap(total[None], _EDGE)
