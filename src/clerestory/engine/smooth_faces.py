"""Faces of a scene that reflect like a mirror, grouped by plane or orientation."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.scene.tessellate import Mesh

# Largest number of planes or orientations (curved meshes have many); light by way of
# the smallest surfaces is found by BSDF sampling only.
MOST = 256

# Largest number of grid cells of normals and offsets that are grouped, in order of
# reflected power; factors that combine the indices of a cell into one number.
_CELLS = 1 << 14
_STRIDES = np.array([1, 1 << 15, 1 << 30, 1 << 45])

# Tolerances of equal normals [rad], and of equal offsets of parallel planes [m].
_SLOPE, _DISTANCE = 3e-4, 2e-3


@dataclass
class Boxes:
    """Boxes around surfaces: centres, unit axes, and half lengths along them [m]."""

    centre: Float[np.ndarray, "box 3"]
    axes: Float[np.ndarray, "box 3 3"]
    half: Float[np.ndarray, "box 3"]


@dataclass(frozen=True, eq=False)
class Planes:
    """Planes, or orientations, of flat smooth surfaces, the most reflecting first.

    `of_face` has 1 + the index of the plane for every face of the scene, or 0.
    `weight` is a sampling weight (sum at most 1), `reflectance` the mean reflectance
    near normal incidence; `apart` tells whether an orientation has several planes, so
    that it can reflect light that it has reflected before. `boxes` contain the faces.
    """

    normal: Float[np.ndarray, "plane 3"]
    offset: Float[np.ndarray, " plane"]
    weight: Float[np.ndarray, " plane"]
    reflectance: Float[np.ndarray, " plane"]
    apart: Bool[np.ndarray, " plane"]
    of_face: Int[np.ndarray, " scene_face"]
    boxes: Boxes


@dataclass
class SmoothFaces:
    """Triangles with mirror reflection.

    Attributes
    ----------
    count : number of faces of the scene
    face : index of each triangle in the scene
    corner : corners of each triangle [m]
    normal, offset : unit normals, of one sign for both sides, and distances from the
        origin of the planes [m]
    area : areas [m²]
    reflectance : reflectances near normal incidence
    """

    count: int
    face: Int[np.ndarray, " face"]
    corner: Float[np.ndarray, "face 3 3"]
    normal: Float[np.ndarray, "face 3"]
    offset: Float[np.ndarray, " face"]
    area: Float[np.ndarray, " face"]
    reflectance: Float[np.ndarray, " face"]

    @property
    def power(self) -> Float[np.ndarray, " face"]:
        """Area times reflectance of each face [m²]."""
        return self.area * self.reflectance

    @classmethod
    def of(
        cls, count: int, found: list[tuple[int, Mesh]], origin: Float[np.ndarray, "3"]
    ) -> "SmoothFaces":
        """Return the smooth faces of meshes, each with the index of its first face."""
        corner = [mesh.vertices[mesh.faces] - origin for _, mesh in found]
        number = [np.arange(len(mesh.faces)) + first for first, mesh in found]
        share = [np.full(len(mesh.faces), mesh.material.mirrored) for _, mesh in found]
        corners = np.concatenate([np.zeros((0, 3, 3)), *corner])
        a, b, c = np.moveaxis(corners, 1, 0)
        cross = np.cross(b - a, c - a)
        length = np.linalg.norm(cross, axis=1)
        kept = length > 0
        normal = cross[kept] / length[kept, None]
        normal *= _sign(normal)[:, None]
        middle = (a + b + c)[kept] / 3
        return cls(
            count,
            np.concatenate([np.zeros(0, int), *number])[kept],
            corners[kept],
            normal,
            np.sum(normal * middle, axis=1),
            length[kept] / 2,
            np.concatenate([np.zeros(0), *share])[kept],
        )

    def planes(self, *, distant: bool) -> Planes:
        """Return the planes of largest area times reflectance.

        For distant sources: the orientations.
        """
        group = self.clusters(distant=distant)
        of_face, power = np.zeros(self.count, dtype=int), self.power
        of_face[self.face] = group + 1
        count = int(group.max(initial=-1)) + 1
        chosen = [group == number for number in range(count)]
        normal = [power[c] @ self.normal[c] for c in chosen]
        normal = np.reshape([n / np.linalg.norm(n) for n in normal], (-1, 3))
        offset = [np.average(self.offset[c], weights=power[c]) for c in chosen]
        apart = [np.ptp(self.offset[c]) > _DISTANCE for c in chosen]
        weight = np.array([power[c].sum() for c in chosen])
        return Planes(
            normal,
            np.zeros(count) if distant else np.array(offset),
            weight / max(self.area.sum(), 1e-30),
            weight / np.array([self.area[c].sum() for c in chosen]),
            np.array(apart, dtype=bool) & distant,
            of_face,
            _boxes([self.corner[c][np.argsort(-self.area[c])] for c in chosen]),
        )

    def clusters(self, *, distant: bool) -> Int[np.ndarray, " face"]:
        """Return the plane or orientation of each face; -1 beyond the largest ones."""
        if distant:
            return _clusters(self.normal, self.power, _SLOPE)
        scaled = self.offset * (_SLOPE / _DISTANCE)
        place = np.column_stack([self.normal, scaled])
        return _clusters(place, self.power, _SLOPE)


def _boxes(groups: list[Float[np.ndarray, "face 3 3"]]) -> Boxes:
    # Box around the triangles of each group, aligned with that edge of the first
    # triangle for which it is smallest
    found = []
    for corner in groups:
        edges = np.roll(corner[0], -1, axis=0) - corner[0]
        edges /= np.linalg.norm(edges, axis=1, keepdims=True)
        normal = np.cross(edges[0], edges[1])
        normal /= np.linalg.norm(normal)
        axes = np.array([[u, np.cross(normal, u), normal] for u in edges])
        place = np.einsum("kij,fvj->kfvi", axes, corner)
        low, high = place.min(axis=(1, 2)), place.max(axis=(1, 2))
        best = int(np.argmin(np.prod((high - low)[:, :2], axis=1)))
        middle, half = (low + high)[best] / 2, (high - low)[best] / 2
        found.append([middle @ axes[best], *axes[best], half])
    made = np.reshape(found, (-1, 5, 3))
    return Boxes(made[:, 0], made[:, 1:4], made[:, 4])


def _sign(normal: Float[np.ndarray, "face 3"]) -> Float[np.ndarray, " face"]:
    # Opposite signs for opposite normals; few surfaces are near the change of sign
    return np.where(normal @ [0.5377, 0.6123, 0.5796] < 0, -1.0, 1.0)


def _clusters(
    place: Float[np.ndarray, "face axes"],
    power: Float[np.ndarray, " face"],
    size: float,
) -> Int[np.ndarray, " face"]:
    # Cluster of each face, numbered by decreasing power; -1 for faces that are in none
    # of the MOST clusters
    cell = np.round(place / (0.1 * size)).astype(np.int64)
    _, first, member = np.unique(
        cell @ _STRIDES[: cell.shape[1]], return_index=True, return_inverse=True
    )
    strength = np.bincount(member, power, minlength=len(first))
    strongest = np.argsort(-strength, kind="stable")[:_CELLS]
    kept = cell[first[strongest]]
    group = np.full(len(kept), -1)
    for number in range(MOST):
        free = np.flatnonzero(group < 0)
        if not len(free):
            break
        near = np.abs(kept[free] - kept[free[0]]).max(axis=1) <= 10
        group[free[near]] = number
    of_cell = np.full(len(first), -1)
    of_cell[strongest] = group
    return np.asarray(of_cell[member])
