"""Emitting surfaces: radiance by direction, and sampling in proportion to power.

Every emitting shape is one emitter. A pattern that varies with direction is tabulated
over all directions; a pattern that varies with position is evaluated at the centre of
the surface.
"""

from dataclasses import dataclass, replace

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.directional_map import DirectionalMap, map_directions
from clerestory.engine.origin import Origin
from clerestory.engine.sampled_sources import is_sampled
from clerestory.engine.sampler import Distribution
from clerestory.engine.spherical_rectangle import Parallelograms, fold
from clerestory.engine.upload import on_device, vectors
from clerestory.errors import InputError
from clerestory.scene.model import Emitter, Glow, Illum, Spotlight
from clerestory.scene.tessellate import Mesh

# Number of cells along the edge of a pattern's table; a cell is 0.6° wide
_EDGE = 256


def split_by_surface(mesh: Mesh) -> list[Mesh]:
    """Split a mesh into surfaces if its pattern depends on normal or position."""
    pattern = getattr(mesh.material, "pattern", None)
    if pattern is None or not (pattern.needs_normal or pattern.needs_point):
        return [mesh]
    parts = [mesh.surface == number for number in np.unique(mesh.surface)]
    return [replace(mesh, faces=mesh.faces[p], surface=mesh.surface[p]) for p in parts]


@dataclass
class Emitters:
    """Dr.Jit arrays of all emitting shapes, and of their `count` sampled triangles.

    Attributes
    ----------
    shapes : number of emitting shapes, those that are not sampled included
    table : 1 + index of the pattern of each emitter, or 0 without a pattern
    view_only : whether an emitter is visible but does not illuminate (glow of negative
        radius)
    illum : whether an emitter is an illum; camera rays see its alternate material
    emitter : index of the emitter that each triangle belongs to
    chosen : sampling probabilities of the triangles, proportional to power
    density : probability per area on each emitter [1/m²]; 0 if not sampled
    """

    shapes: int
    count: int
    radiance: mi.Color3f
    table: mi.UInt32
    view_only: mi.Bool
    illum: mi.Bool
    patterns: DirectionalMap | None
    triangles: Parallelograms
    emitter: mi.UInt32
    chosen: Distribution
    density: mi.Float

    @classmethod
    def of(cls, shining: list[Mesh], origin: Origin) -> "Emitters":
        """Return the Dr.Jit arrays of emitting meshes; emitter i is mesh i."""
        radiance = np.array([m.material.radiance for m in shining]).reshape(-1, 3)
        found = [_pattern(mesh) for mesh in shining]
        tables = [table for table in found if table is not None]
        number = np.cumsum([table is not None for table in found], dtype=int)
        number = np.where([table is None for table in found], 0, number)
        mean = radiance.mean(axis=1)
        mean *= [1 if table is None else table.mean() for table in found]

        # Triangles of sampled emitters, and their power
        emitting = np.array([is_sampled(m.material) for m in shining], dtype=bool)
        sampled = np.flatnonzero(emitting & (mean > 0))
        meshes = [shining[index] for index in sampled]
        corners = [mesh.vertices[mesh.faces] - origin for mesh in meshes]
        corner = np.concatenate([np.zeros((0, 3, 3)), *corners])
        faces = np.array([len(mesh.faces) for mesh in meshes], dtype=int)
        owner = np.repeat(sampled, faces)
        u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
        area = 0.5 * np.linalg.norm(np.cross(u, v), axis=1)
        power = area * mean[owner]
        aimed = np.zeros(len(shining))
        if len(power):
            aimed[np.unique(owner)] = mean[np.unique(owner)] / power.sum()
        return cls(
            shapes=len(shining),
            count=len(owner),
            radiance=vectors(mi.Color3f, radiance),
            table=on_device(mi.UInt32, number),
            view_only=on_device(mi.Bool, [_is_view_only(m.material) for m in shining]),
            illum=on_device(mi.Bool, [isinstance(m.material, Illum) for m in shining]),
            patterns=DirectionalMap(np.array(tables), _EDGE) if tables else None,
            triangles=Parallelograms.of(corner[:, 0], u, v),
            emitter=on_device(mi.UInt32, owner),
            chosen=Distribution.of(power),
            density=on_device(mi.Float, aimed),
        )

    def emitted(self, emitter, direction, active):
        """Return the radiance emitted by an emitter along a direction."""
        found = dr.gather(mi.Color3f, self.radiance, emitter, active)
        if self.patterns is None:
            return found
        table = dr.gather(mi.UInt32, self.table, emitter, active)
        varied = self.patterns.look_up(direction, dr.maximum(table, 1) - 1)
        return dr.select(table > 0, found * varied, found)

    def pdf(self, emitter, distance2, cosine, active):
        """Return the pdf of the direction to a point of an emitter [1/sr]."""
        chance = dr.gather(mi.Float, self.density, emitter, active)
        return chance * distance2 / dr.maximum(cosine, 1e-6)

    def sample_point(self, pick, u, v):
        """Sample a point by power; return the point, the normal and the emitter."""
        number, _, _ = self.chosen.sample(pick)
        triangle = self.triangles.take(number)
        normal = dr.normalize(dr.cross(triangle.edge_u, triangle.edge_v))
        emitter = dr.gather(mi.UInt32, self.emitter, number)
        return triangle.point(*fold(u, v)), normal, emitter


def _is_view_only(material: Emitter) -> bool:
    return isinstance(material, Glow) and material.radius < 0


def _pattern(mesh: Mesh) -> Float[np.ndarray, "n 3"] | None:
    # Multiplier of radiance for each exiting direction of a table
    material = mesh.material
    pattern = material.pattern
    if pattern is None and not isinstance(material, Spotlight):
        return None
    direction = map_directions(_EDGE)
    value = np.ones_like(direction)
    if pattern is not None:
        normal = np.broadcast_to(_normal(mesh), direction.shape)
        corners = mesh.vertices[mesh.faces].reshape(-1, 3)
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        point = np.broadcast_to(middle, direction.shape)
        value = value * pattern.value(direction, normal, point)
    if isinstance(material, Spotlight):
        limit = np.cos(np.radians(material.angle_deg / 2))
        value = value * (direction @ material.direction >= limit)[:, None]
    return value


def _normal(mesh: Mesh) -> Float[np.ndarray, "3"]:
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    normal = np.cross(b - a, c - a)
    total = normal.sum(axis=0)
    length = np.linalg.norm(total)
    if mesh.material.pattern.needs_normal and (
        length < 0.999 * np.linalg.norm(normal, axis=1).sum()
    ):
        raise InputError(
            f'emitter "{mesh.material.name}" is curved, and its pattern depends on the'
            " normal; a flat surface expected"
        )
    return total / max(length, 1e-30)
