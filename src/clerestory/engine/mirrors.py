"""Plane mirrors of a scene, and the mirror images of the sun.

As with Radiance's virtual sources, the image of the sun in a plane mirror is treated as
another sun, for single reflections only. All other light in mirrors is found by BSDF
sampling.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.lower import LoweredScene
from clerestory.engine.sampler import Distribution
from clerestory.engine.upload import vectors
from clerestory.engine.visibility import along, first_opaque, interaction, offset
from clerestory.scene.model import Mirror, Polygon, Ring, Scene

# Largest number of mirror orientations (curved mirrors have many); light reflected by
# the smallest mirrors is found by BSDF sampling only.
MOST = 64

# Normals count as equal if 1 minus their scalar product is below this limit (0.08°).
_SAME = 1e-6


@dataclass
class Mirrors:
    """Unit normals of plane mirrors, sampled in proportion to mirror area."""

    count: int
    normal: mi.Vector3f
    chosen: Distribution

    @classmethod
    def of(cls, scene: Scene) -> "Mirrors":
        """Return the normals of a scene's plane mirrors, the largest mirrors first."""
        normals: list[np.ndarray] = []
        areas: list[float] = []
        for surface in scene.surfaces:
            material = scene.materials[surface.material]
            if not isinstance(material, Mirror) or material.alternate is not None:
                continue
            if isinstance(surface, Polygon | Ring):
                _add(normals, areas, _area_vector(surface))
        order = np.argsort(areas)[::-1][:MOST]
        # Kernels need non-empty tables: add an unused entry if there are no mirrors
        kept = np.array([normals[i] for i in order] or [[0.0, 0.0, 1.0]])
        share = np.array([areas[i] for i in order] or [1.0])
        return cls(len(order), vectors(mi.Vector3f, kept), Distribution.of(share))

    def choose(self, pick):
        """Sample a mirror normal; return the normal and its probability."""
        number, chance, _ = self.chosen.sample(pick)
        return dr.gather(mi.Vector3f, self.normal, number), chance

    @dr.syntax
    def holds(self, normal, active):
        """Whether the table of mirrors contains the given normal."""
        found = mi.Bool(False)
        number = mi.UInt32(0)
        while active & ~found & (number < self.count):
            other = dr.gather(mi.Vector3f, self.normal, number)
            found |= is_same(normal, other)
            number += 1
        return found


def is_mirror(bsdf):
    """Whether a BSDF is a mirror: a single delta reflection at the front."""
    return (bsdf.flags() & +mi.BSDFFlags.All) == +mi.BSDFFlags.DeltaReflection


def is_same(normal, other):
    """Whether two unit vectors are equal up to rounding."""
    return dr.dot(normal, other) > 1 - _SAME


def reflected(model: LoweredScene, start, direction, normal, active: mi.Bool):
    """Trace a ray through panes to a mirror that has a given normal.

    Return the transmittance to the mirror times the mirror's reflectance (zero if the
    ray hits no such mirror), and the point hit, offset from the front [m].
    """
    share, ray, hit = first_opaque(model, start, along(direction), active)
    met = active & hit.is_valid()
    si = interaction(hit, ray, met)
    bsdf = si.bsdf()
    found = met & is_mirror(bsdf) & is_same(si.n, normal)
    _, colour = bsdf.sample(
        mi.BSDFContext(), si, mi.Float(0.5), mi.Point2f(0.5, 0.5), found
    )
    return dr.select(found, share * colour, 0), offset(model, si, si.n, found)


def _area_vector(surface: Polygon | Ring) -> Float[np.ndarray, "3"]:
    # Unit normal of a surface times its area [m²]
    if isinstance(surface, Ring):
        area = np.pi * (surface.outer_radius**2 - surface.inner_radius**2)
        return surface.normal / np.linalg.norm(surface.normal) * area
    around = surface.vertices - surface.vertices[0]
    return 0.5 * np.cross(around, np.roll(around, -1, axis=0)).sum(axis=0)


def _add(
    normals: list[np.ndarray], areas: list[float], vector: Float[np.ndarray, "3"]
) -> None:
    # Add the area of a mirror to its orientation, or add a new orientation
    area = float(np.linalg.norm(vector))
    if area == 0:
        return
    for i, normal in enumerate(normals):
        if normal @ vector / area > 1 - _SAME / 10:
            areas[i] += area
            return
    normals.append(vector / area)
    areas.append(area)
