"""Where light enters a room, as rectangles to aim at.

Light comes through few places: panes, blinds, skylights. Directions towards them are
proposed beside those of the materials; every proposal's density is known for every
direction, so both together stay unbiased whatever the rectangles leave out.

Rectangles are aimed at by the solid angle they subtend (see `windows`).
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.upload import vectors
from clerestory.engine.windows import RectangleView
from clerestory.scene.model import BsdfSurface, Glass, Illum, Polygon, Scene, Trans

# Rectangles beyond the largest ones only cost time.
MOST = 12

# Polygons smaller than this share of the largest are no place to aim at.
_SMALLEST = 1e-3

_TRANSMITTING = (Glass, BsdfSurface, Illum, Trans)


@dataclass
class Portals:
    """Rectangles, for kernels.

    Attributes
    ----------
    count : of rectangles
    corner, edge_u, edge_v : of each [m]
    """

    count: int
    corner: mi.Point3f
    edge_u: mi.Vector3f
    edge_v: mi.Vector3f

    @classmethod
    def of(cls, scene: Scene, origin: Float[np.ndarray, "3"]) -> "Portals":
        """Return the rectangles around the largest transmitting polygons."""
        found = [
            _rectangle(surface.vertices)
            for surface in scene.surfaces
            if isinstance(surface, Polygon)
            and isinstance(scene.materials[surface.material], _TRANSMITTING)
        ]
        area = [np.linalg.norm(np.cross(u, v)) for _, u, v in found]
        largest = sorted(range(len(found)), key=lambda i: -area[i])[:MOST]
        kept = [found[i] for i in largest if area[i] >= _SMALLEST * max(area)]
        count = len(kept)
        # Without portals, one that is never aimed at
        kept = kept or [(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, 1.0, 0]))]
        corner = np.array([c for c, _, _ in kept]) - origin
        portals = cls(
            count,
            vectors(mi.Point3f, corner),
            vectors(mi.Vector3f, np.array([u for _, u, _ in kept])),
            vectors(mi.Vector3f, np.array([v for _, _, v in kept])),
        )
        dr.make_opaque(portals.corner, portals.edge_u, portals.edge_v)
        return portals

    def _view(self, number, origin) -> RectangleView:
        corner = dr.gather(mi.Point3f, self.corner, number) - origin
        edge_u = dr.gather(mi.Vector3f, self.edge_u, number)
        edge_v = dr.gather(mi.Vector3f, self.edge_v, number)
        return RectangleView.of(corner, edge_u, edge_v, mi.Bool(True))

    def _worth(self, number, origin):
        # Roughly the solid angle that a rectangle subtends
        edge_u = dr.gather(mi.Vector3f, self.edge_u, number)
        edge_v = dr.gather(mi.Vector3f, self.edge_v, number)
        middle = dr.gather(mi.Point3f, self.corner, number) + 0.5 * (edge_u + edge_v)
        across = middle - origin
        area = dr.cross(edge_u, edge_v)
        distance2 = dr.squared_norm(across) + dr.norm(area)
        return dr.norm(area) / distance2

    @dr.syntax
    def total(self, origin):
        """Return what the chances of the rectangles are relative to."""
        total = mi.Float(0)
        number = mi.UInt32(0)
        while number < self.count:
            total += self._worth(number, origin)
            number += 1
        return total

    @dr.syntax
    def aim(self, origin, total, u, v):
        """Return a direction to a point of a rectangle."""
        target = u * total
        before = mi.Float(0)
        worth = mi.Float(1)
        chosen = mi.UInt32(0)
        number = mi.UInt32(0)
        while number < self.count:
            here = self._worth(number, origin)
            take = target >= before
            chosen = dr.select(take, number, chosen)
            worth = dr.select(take, here, worth)
            rest = (target - before) / here
            u = dr.select(take, rest, u)
            before += here
            number += 1
        u = dr.clip(u, 0, 0.9999999)
        view = self._view(chosen, origin)
        x, y = view.sample(u, v)
        wide = view.right * x + view.up * y + view.axis * view.depth
        edge_u = dr.gather(mi.Vector3f, self.edge_u, chosen)
        edge_v = dr.gather(mi.Vector3f, self.edge_v, chosen)
        corner = dr.gather(mi.Point3f, self.corner, chosen)
        flat = corner + edge_u * u + edge_v * v - origin
        return dr.normalize(dr.select(view.usable, wide, flat))

    @dr.syntax
    def pdf(self, origin, direction, total, active):
        """Return the density of aiming along a direction [1/sr]."""
        density = mi.Float(0)
        number = mi.UInt32(0)
        while active & (number < self.count):
            corner = dr.gather(mi.Point3f, self.corner, number) - origin
            edge_u = dr.gather(mi.Vector3f, self.edge_u, number)
            edge_v = dr.gather(mi.Vector3f, self.edge_v, number)
            normal = dr.cross(edge_u, edge_v)
            along = dr.dot(normal, direction)
            distance = dr.dot(normal, corner) / dr.select(along == 0, 1, along)
            place = direction * distance - corner
            u = dr.dot(place, edge_u) / dr.squared_norm(edge_u)
            v = dr.dot(place, edge_v) / dr.squared_norm(edge_v)
            hit = (along != 0) & (distance > 0) & (u >= 0) & (u <= 1)
            hit &= (v >= 0) & (v <= 1)
            view = self._view(number, origin)
            by_area = dr.square(distance) / dr.maximum(dr.abs(along), 1e-20)
            here = dr.select(view.usable, 1 / view.solid_angle, by_area)
            density += dr.select(hit, here * self._worth(number, origin) / total, 0)
            number += 1
        return density


def _rectangle(vertices: Float[np.ndarray, "n 3"]):
    # A rectangle around a polygon, along its longest edge
    edges = np.roll(vertices, -1, axis=0) - vertices
    longest = edges[np.argmax(np.linalg.norm(edges, axis=1))]
    right = longest / np.linalg.norm(longest)
    fan = vertices[1:] - vertices[0]
    normal = np.cross(fan[:-1], fan[1:]).sum(axis=0)
    up = np.cross(normal / np.linalg.norm(normal), right)
    x, y = (vertices - vertices[0]) @ right, (vertices - vertices[0]) @ up
    corner = vertices[0] + x.min() * right + y.min() * up
    return corner, np.ptp(x) * right, np.ptp(y) * up
