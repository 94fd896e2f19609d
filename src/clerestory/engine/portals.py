"""Portals: rectangles around windows and sunlit areas, for path guiding.

Daylight enters a room through a few openings. Directions towards them are sampled in
addition to BSDF sampling; the density of each technique is known for every direction,
so the combination is unbiased even if rectangles are missing.

Rectangles are sampled by the solid angle they subtend (`spherical_rectangle`), around
windows and around sunlit areas (`sun_patches`). Sampling probabilities are learned per
cell of the room (`path_guiding`), separately for continued paths and for rays towards
sunlit surfaces.
"""

from dataclasses import astuple, dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Bool, Float

from clerestory.engine.guiding_cells import GuidingCells
from clerestory.engine.origin import Origin
from clerestory.engine.spherical_rectangle import Parallelograms
from clerestory.engine.upload import on_device, vectors
from clerestory.scene.model import (
    BsdfSurface,
    FunctionSheet,
    Glass,
    Illum,
    Polygon,
    Scene,
    Trans,
)
from clerestory.scene.surface import area_vector

# Largest number of rectangles; further, smaller ones cost more time than they save.
MOST = 12

# Polygons below this fraction of the largest polygon are not used as portals.
_SMALLEST = 1e-3

# The loop over rectangles is unrolled, as a loop that fetches rectangles from memory is
# five times slower. There is one kernel for each multiple of this number of rectangles.
_TOGETHER = 4

# Probability of sampling a portal before probabilities are learned.
_UNIFORM_CHANCE = 0.35

_TRANSMITTING = (Glass, BsdfSurface, FunctionSheet, Illum, Trans)


@dataclass
class Rectangles:
    """Rectangles as NumPy arrays: one corner and two edge vectors each [m]."""

    corner: Float[np.ndarray, "n 3"]
    edge_u: Float[np.ndarray, "n 3"]
    edge_v: Float[np.ndarray, "n 3"]

    def __len__(self) -> int:
        return len(self.corner)

    def __add__(self, other: "Rectangles") -> "Rectangles":
        parts = zip(astuple(self), astuple(other), strict=True)
        return Rectangles(*(np.concatenate(pair) for pair in parts))

    @classmethod
    def none(cls, count: int = 0) -> "Rectangles":
        """Return an empty set of rectangles, or `count` placeholder rectangles."""
        return cls(*(np.tile(edge, (count, 1)) for edge in np.eye(3)))

    def some(self, chosen: Bool[np.ndarray, " n"]) -> "Rectangles":
        """Return the rectangles chosen by a mask."""
        return Rectangles(self.corner[chosen], self.edge_u[chosen], self.edge_v[chosen])


@dataclass
class Portals:
    """Dr.Jit arrays of rectangles, with their sampling probabilities by guiding cell.

    Attributes
    ----------
    slots : number of rectangle slots in kernels; surplus slots are empty
    facing : normal times area, edge_u × edge_v [m²]
    planes : of each slot, as single values, which kernels read faster than elements of
        arrays: `facing`, corner, and edges divided by their squared lengths [1/m]
    share, sunlit : probability of each rectangle for continued paths, and for rays
        towards sunlit surfaces
    chance : probability that a path continues towards any rectangle
    sunny : whether any rectangle contains sunlit surfaces
    """

    count: int
    slots: int
    rectangles: Parallelograms
    facing: mi.Vector3f
    planes: list[tuple[mi.Vector3f, ...]]
    cells: GuidingCells
    share: mi.Float
    sunlit: mi.Float
    chance: mi.Float
    sunny: bool

    @classmethod
    def of(
        cls,
        rectangles: Rectangles,
        cells: GuidingCells,
        share: Float[np.ndarray, "cell rectangle"],
        sunlit: Float[np.ndarray, "cell rectangle"],
        chance: Float[np.ndarray, " cell"],
    ) -> "Portals":
        """Return portals with their sampling probabilities by guiding cell."""
        count = len(rectangles)
        slots = -(-count // _TOGETHER) * _TOGETHER
        empty = ((0, 0), (0, slots - count))
        every = rectangles + Rectangles.none(slots - count)
        facing = np.cross(every.edge_u, every.edge_v)
        across, upwards = _inverse(every.edge_u), _inverse(every.edge_v)
        return cls(
            count,
            slots,
            Parallelograms.of(*astuple(every)),
            vectors(mi.Vector3f, facing),
            [
                tuple(vectors(mi.Vector3f, row[None]) for row in plane)
                for plane in zip(facing, every.corner, across, upwards, strict=True)
            ],
            cells,
            on_device(mi.Float, np.pad(share, empty)),
            on_device(mi.Float, np.pad(sunlit, empty)),
            on_device(mi.Float, chance),
            bool(sunlit.any()),
        )

    @classmethod
    def uniform(cls, rectangles: Rectangles) -> "Portals | None":
        """Return portals of equal probabilities; None if there are no rectangles."""
        if len(rectangles) == 0:
            return None
        cells = GuidingCells.around(np.zeros((0, 3)))
        even = np.full((cells.count, len(rectangles)), 1 / len(rectangles))
        chance = np.full(cells.count, _UNIFORM_CHANCE)
        return cls.of(rectangles, cells, even, even, chance)

    def towards(self, number, origin, u, v):
        """Sample a direction to a point of a rectangle."""
        rectangle = self.rectangles.take(number)
        view = rectangle.seen_from(origin, mi.Bool(True))
        x, y = view.sample(u, v)
        wide = view.right * x + view.up * y + view.axis * view.depth
        flat = rectangle.point(u, v) - origin
        return dr.normalize(dr.select(view.usable, wide, flat))

    def density(self, number, origin, direction):
        """Return the density [1/sr] of sampling a ray to the rectangle by `towards`."""
        rectangle = self.rectangles.take(number)
        facing = dr.gather(mi.Vector3f, self.facing, number)
        along = dr.dot(facing, direction)
        distance = dr.dot(facing, rectangle.corner - origin)
        distance /= dr.select(along == 0, 1, along)
        by_area = dr.square(distance) / dr.maximum(dr.abs(along), 1e-20)
        view = rectangle.seen_from(origin, mi.Bool(True))
        return dr.select(view.usable, 1 / view.solid_angle, by_area)

    def met(self, origin, direction):
        """Return the rectangles hit by a ray, as bits of 32-bit integers."""
        found = mi.UInt32(0)
        for number, (facing, start, across, upwards) in enumerate(self.planes):
            corner = start - origin
            along = dr.dot(facing, direction)
            distance = dr.dot(facing, corner) / dr.select(along == 0, 1, along)
            place = direction * distance - corner
            u, v = dr.dot(place, across), dr.dot(place, upwards)
            hit = (along != 0) & (distance > 0)
            hit &= (u >= 0) & (u <= 1) & (v >= 0) & (v <= 1)
            found |= dr.select(hit, mi.UInt32(1 << number), 0)
        return found

    def sample(self, shares, origin, cell, u, v):
        """Sample a direction towards a portal by the probabilities of a cell.

        `shares`: probabilities of portals per cell. Also return a mask that is false if
        all probabilities of the cell are zero.
        """
        target, before = mi.Float(u), mi.Float(0)
        chosen, valid = mi.UInt32(0), mi.Bool(False)
        for number in range(self.slots):
            here = dr.gather(mi.Float, shares, cell * self.slots + number)
            take = (target >= before) & (here > 0)
            chosen = dr.select(take, number, chosen)
            u = dr.select(take, (target - before) / here, u)
            valid |= take
            before += here
        return self.towards(chosen, origin, dr.clip(u, 0, 0.9999999), v), valid

    @dr.syntax
    def pdf(self, origin, cell, direction, active):
        """Return the densities of sampling a direction towards portals [1/sr].

        The first density is for continued paths, the second for rays towards sunlit
        surfaces.
        """
        onward, sunlit = mi.Float(0), mi.Float(0)
        left = dr.select(active, self.met(origin, direction), 0)
        while active & (left != 0):
            number = dr.tzcnt(left)
            at = cell * self.slots + number
            density = self.density(number, origin, direction)
            onward += dr.gather(mi.Float, self.share, at) * density
            sunlit += dr.gather(mi.Float, self.sunlit, at) * density
            left &= left - 1
        return onward, sunlit


def _inverse(edges: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    return edges / np.sum(np.square(edges), axis=1, keepdims=True)


def window_rectangles(scene: Scene, origin: Origin) -> Rectangles:
    """Return rectangles around the largest panes, relative to the point `origin`."""
    panes = (
        surface.vertices
        for surface in scene.surfaces
        if isinstance(surface, Polygon)
        and isinstance(scene.materials[surface.material], _TRANSMITTING)
    )
    found = [_rectangle(pane) for pane in panes if area_vector(pane).any()]
    area = [np.linalg.norm(np.cross(u, v)) for _, u, v in found]
    largest = sorted(range(len(found)), key=lambda i: -area[i])[:MOST]
    kept = [found[i] for i in largest if area[i] >= _SMALLEST * max(area)]
    corner, edge_u, edge_v = np.array(kept).reshape(-1, 3, 3).transpose(1, 0, 2)
    return Rectangles(corner - origin, edge_u, edge_v)


def _rectangle(vertices: Float[np.ndarray, "n 3"]):
    # Bounding rectangle of a polygon, aligned with its longest edge
    edges = np.roll(vertices, -1, axis=0) - vertices
    longest = edges[np.argmax(np.linalg.norm(edges, axis=1))]
    right = longest / np.linalg.norm(longest)
    fan = vertices[1:] - vertices[0]
    normal = np.cross(fan[:-1], fan[1:]).sum(axis=0)
    up = np.cross(normal / np.linalg.norm(normal), right)
    x, y = (vertices - vertices[0]) @ right, (vertices - vertices[0]) @ up
    corner = vertices[0] + x.min() * right + y.min() * up
    return corner, np.ptp(x) * right, np.ptp(y) * up
