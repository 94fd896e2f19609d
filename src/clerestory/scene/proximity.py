"""Point–triangle distances and ray–triangle intersections.

The functions evaluate one point at a time; they check sensors and do not render.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.array_types import RayValues, RayVectors, Vector


@dataclass(frozen=True, eq=False)
class Triangulation:
    """Corners [m] of triangles and index of each triangle's surface."""

    corner: Float[np.ndarray, "triangles 3 3"]
    surface: Int[np.ndarray, " triangles"]

    def __post_init__(self) -> None:
        # Bounding boxes with one array per coordinate, for fast comparisons
        for name, of in (("_low", np.min), ("_high", np.max)):
            box = np.ascontiguousarray(of(self.corner, axis=1).T)
            object.__setattr__(self, name, box)

    def of(self, chosen: Bool[np.ndarray, " surface"]) -> "Triangulation":
        """Return the triangles of chosen surfaces."""
        if chosen.all():
            return self
        kept = chosen[self.surface]
        return Triangulation(self.corner[kept], self.surface[kept])

    def near(self, point: Vector, reach: float) -> "Triangulation":
        """Return the triangles with bounding boxes within `reach` [m] of a point."""
        return self._meeting(point - reach, point + reach)

    def beneath(self, point: Vector) -> "Triangulation":
        """Return the triangles with bounding boxes vertically below a point."""
        return self._meeting(np.array([point[0], point[1], -np.inf]), point)

    def along_vertical(self, point: Vector) -> "Triangulation":
        """Return the triangles with bounding boxes below or above a point."""
        low, high = (np.array([point[0], point[1], z]) for z in (-np.inf, np.inf))
        return self._meeting(low, high)

    def _meeting(self, low: Vector, high: Vector) -> "Triangulation":
        # Triangles whose bounding boxes overlap a box, filtered by x, then y and z
        lowest, highest = self.__dict__["_low"], self.__dict__["_high"]
        left = np.flatnonzero((lowest[0] <= high[0]) & (highest[0] >= low[0]))
        for axis in (1, 2):
            meets = lowest[axis, left] <= high[axis]
            left = left[meets & (highest[axis, left] >= low[axis])]
        return Triangulation(self.corner[left], self.surface[left])


def distances(
    point: Vector, corner: Float[np.ndarray, "triangles 3 3"]
) -> Float[np.ndarray, " triangles"]:
    """Return the distances from a point to triangles [m]."""
    edge = np.roll(corner, -1, axis=1) - corner
    away = point - corner
    normal = np.cross(edge[:, 0], edge[:, 1])
    length = np.linalg.norm(normal, axis=1)

    # Distance to the nearest point of the three edges
    square = np.maximum((edge**2).sum(axis=2), 1e-300)
    share = np.clip((away * edge).sum(axis=2) / square, 0, 1)
    nearest = np.linalg.norm(away - share[..., None] * edge, axis=2).min(axis=1)

    # Distance to the plane, if the point projects into the triangle
    turn = np.einsum("tex,tx->te", np.cross(edge, away), normal)
    over = np.all(turn >= 0, axis=1) & (length > 0)
    height = np.abs((away[:, 0] * normal).sum(axis=1)) / np.maximum(length, 1e-300)
    return np.asarray(np.where(over, height, nearest))


def first_hits(
    point: Vector, direction: RayVectors, corner: Float[np.ndarray, "triangles 3 3"]
) -> RayValues:
    """Return the distances from a point to the first hit of each ray [m]; inf if none.

    References: T. Möller, B. Trumbore, Journal of Graphics Tools 2 (1), 1997.
    """
    if not len(corner):
        return np.full(len(direction), np.inf)
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    away = point - corner[:, 0]
    p = np.cross(direction[:, None], v)
    q = np.cross(away, u)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 1 / np.einsum("rtx,tx->rt", p, u)
        a = np.einsum("rtx,tx->rt", p, away) * scale
        b = np.einsum("rx,tx->rt", direction, q) * scale
        distance = np.einsum("tx,tx->t", q, v) * scale
        met = (a >= 0) & (b >= 0) & (a + b <= 1) & (distance > 0)
    return np.asarray(np.where(met, distance, np.inf).min(axis=1))
