"""Where light enters a room, as rectangles to aim at.

Light comes through few places: panes, blinds, skylights. Directions towards them are
proposed beside those of the materials; every proposal's density is known for every
direction, so both together stay unbiased whatever the rectangles leave out.

Windows are aimed at by the solid angle they subtend (see `windows`). Places that the
sun shines on directly join them as small bright patches (see `sun_patches`), aimed at
by their area.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Bool, Float

from clerestory.engine.upload import some, vectors
from clerestory.engine.windows import RectangleView
from clerestory.scene.model import BsdfSurface, Glass, Illum, Polygon, Scene, Trans

# Rectangles beyond the largest ones only cost time.
MOST = 12

# Polygons smaller than this share of the largest are no place to aim at.
_SMALLEST = 1e-3

# Radiance of a window compared with the mean from all directions, where it is unknown.
_TYPICAL = 20.0

_TRANSMITTING = (Glass, BsdfSurface, Illum, Trans)


@dataclass
class Rectangles:
    """Rectangles as plain values.

    Attributes
    ----------
    corner, edge_u, edge_v : of each [m]
    """

    corner: Float[np.ndarray, "n 3"]
    edge_u: Float[np.ndarray, "n 3"]
    edge_v: Float[np.ndarray, "n 3"]

    def __len__(self) -> int:
        return len(self.corner)

    def some(self, chosen: Bool[np.ndarray, " n"]) -> "Rectangles":
        """Return the chosen rectangles."""
        return Rectangles(self.corner[chosen], self.edge_u[chosen], self.edge_v[chosen])


@dataclass
class Portals:
    """Rectangles, for kernels.

    Attributes
    ----------
    count : of rectangles
    windows : how many of them are windows; the others are patches with one side
    corner, edge_u, edge_v : of each [m]
    brightness : radiance of each, compared with the mean from all directions
    """

    count: int
    windows: int
    corner: mi.Point3f
    edge_u: mi.Vector3f
    edge_v: mi.Vector3f
    brightness: mi.Float

    @classmethod
    def of(
        cls,
        windows: Rectangles,
        patches: Rectangles | None = None,
        brightness: Float[np.ndarray, " n"] | None = None,
    ) -> "Portals":
        """Return windows and patches, of typical brightness unless said otherwise."""
        kinds = [windows] if patches is None else [windows, patches]
        count = sum(len(kind) for kind in kinds)
        corner, edge_u, edge_v = (
            np.concatenate([getattr(kind, name) for kind in kinds])
            for name in ("corner", "edge_u", "edge_v")
        )
        if brightness is None:
            brightness = np.full(count, _TYPICAL)
        portals = cls(
            count,
            len(windows),
            vectors(mi.Point3f, corner),
            vectors(mi.Vector3f, edge_u),
            vectors(mi.Vector3f, edge_v),
            mi.Float(some(brightness.astype(np.float32))),
        )
        dr.make_opaque(
            portals.corner, portals.edge_u, portals.edge_v, portals.brightness
        )
        return portals

    def _view(self, number, origin) -> RectangleView:
        corner = dr.gather(mi.Point3f, self.corner, number) - origin
        edge_u = dr.gather(mi.Vector3f, self.edge_u, number)
        edge_v = dr.gather(mi.Vector3f, self.edge_v, number)
        return RectangleView.of(corner, edge_u, edge_v, number < self.windows)

    def _worth(self, number, origin, normal):
        # Roughly the solid angle that a rectangle subtends, times its brightness;
        # nothing where it lies behind, or shows its back
        edge_u = dr.gather(mi.Vector3f, self.edge_u, number)
        edge_v = dr.gather(mi.Vector3f, self.edge_v, number)
        middle = dr.gather(mi.Point3f, self.corner, number) + 0.5 * (edge_u + edge_v)
        across = middle - origin
        facing = dr.cross(edge_u, edge_v)
        area = dr.norm(facing)
        reach = dr.abs(dr.dot(edge_u, normal)) + dr.abs(dr.dot(edge_v, normal))
        before = dr.dot(across, normal) + 0.5 * reach > 0
        before &= (number < self.windows) | (dr.dot(across, facing) < 0)
        brightness = dr.gather(mi.Float, self.brightness, number)
        size = area / (dr.squared_norm(across) + area)
        return dr.select(before, brightness * size, 0)

    @dr.syntax
    def total(self, origin, normal):
        """Return what the chances of the rectangles are relative to."""
        total = mi.Float(0)
        number = mi.UInt32(0)
        while number < self.count:
            total += self._worth(number, origin, normal)
            number += 1
        return total

    @dr.syntax
    def aim(self, origin, normal, total, u, v):
        """Return a direction to a point of a rectangle; only where the total is not 0.

        Parameters
        ----------
        normal : of the hemisphere that light is gathered from
        """
        target = u * total
        before = mi.Float(0)
        worth = mi.Float(1)
        chosen = mi.UInt32(0)
        number = mi.UInt32(0)
        while number < self.count:
            here = self._worth(number, origin, normal)
            take = (target >= before) & (here > 0)
            chosen = dr.select(take, number, chosen)
            worth = dr.select(take, here, worth)
            u = dr.select(take, (target - before) / here, u)
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
    def pdf(self, origin, normal, direction, total, active):
        """Return the density of aiming along a direction [1/sr]."""
        density = mi.Float(0)
        number = mi.UInt32(0)
        while active & (number < self.count):
            corner = dr.gather(mi.Point3f, self.corner, number) - origin
            edge_u = dr.gather(mi.Vector3f, self.edge_u, number)
            edge_v = dr.gather(mi.Vector3f, self.edge_v, number)
            facing = dr.cross(edge_u, edge_v)
            along = dr.dot(facing, direction)
            distance = dr.dot(facing, corner) / dr.select(along == 0, 1, along)
            place = direction * distance - corner
            u = dr.dot(place, edge_u) / dr.squared_norm(edge_u)
            v = dr.dot(place, edge_v) / dr.squared_norm(edge_v)
            hit = (along != 0) & (distance > 0) & (u >= 0) & (u <= 1)
            hit &= (v >= 0) & (v <= 1)
            if hit:
                by_area = dr.square(distance) / dr.maximum(dr.abs(along), 1e-20)
                if number < self.windows:
                    view = self._view(number, origin)
                    by_area = dr.select(view.usable, 1 / view.solid_angle, by_area)
                worth = self._worth(number, origin, normal)
                density += dr.select(total > 0, by_area * worth / total, 0)
            number += 1
        return density


def window_rectangles(scene: Scene, origin: Float[np.ndarray, "3"]) -> Rectangles:
    """Return rectangles around the largest transmitting polygons, from an origin."""
    found = [
        _rectangle(surface.vertices)
        for surface in scene.surfaces
        if isinstance(surface, Polygon)
        and isinstance(scene.materials[surface.material], _TRANSMITTING)
    ]
    area = [np.linalg.norm(np.cross(u, v)) for _, u, v in found]
    largest = sorted(range(len(found)), key=lambda i: -area[i])[:MOST]
    kept = [found[i] for i in largest if area[i] >= _SMALLEST * max(area)]
    corner, edge_u, edge_v = np.array(kept).reshape(-1, 3, 3).transpose(1, 0, 2)
    return Rectangles(corner - origin, edge_u, edge_v)


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
