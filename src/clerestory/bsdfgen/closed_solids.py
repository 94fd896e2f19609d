"""Check that dielectrics are closed solids with outward normals."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.bsdfgen.area import SampleArea
from clerestory.bsdfgen.naming import item
from clerestory.scene.model import Dielectric, Interface, Scene
from clerestory.scene.tessellate import Mesh, meshes

# Tolerance of equal corners as a share of the size of the system.
_SAME = 1e-6


def open_solids(scene: Scene, area: SampleArea) -> Iterator[str]:
    """Yield dielectrics with open edges or inward normals.

    Every edge of a solid belongs to two faces that use it in opposite senses. Edges in
    the sides of a periodic unit cell may be open.
    """
    for mesh in meshes(scene):
        if not isinstance(mesh.material, Dielectric | Interface):
            continue
        corner, faces = _welded(mesh, _SAME * float(np.ptp(area.bounds, axis=0).max()))
        edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        lone = _lone(edges)
        if area.periodic:
            lone &= ~_in_sides(corner[edges], area)
        name = f'{type(mesh.material).__name__.lower()} "{mesh.material.name}"'
        if lone.any():
            owner = np.tile(mesh.surface, 3)[lone]
            surface = scene.surfaces[int(owner[0])]
            yield (
                f"{item(surface)} has an open edge: {name} does not enclose a solid"
                f" ({int(lone.sum())} edges without a second face); closed surfaces"
                " with their fronts outwards expected"
            )
        elif _volume(corner, faces) < 0:
            yield (f"{name} is inside out; faces whose fronts point outwards expected")


def _welded(
    mesh: Mesh, distance: float
) -> tuple[Float[np.ndarray, "corner 3"], Int[np.ndarray, "face 3"]]:
    place = np.round(mesh.vertices / max(distance, 1e-12)).astype(np.int64)
    _, first, which = np.unique(place, axis=0, return_index=True, return_inverse=True)
    faces = which.ravel()[mesh.faces]
    solid = (
        (faces[:, 0] != faces[:, 1])
        & (faces[:, 1] != faces[:, 2])
        & (faces[:, 2] != faces[:, 0])
    )
    return mesh.vertices[first], np.where(solid[:, None], faces, 0)


def _lone(edges: Int[np.ndarray, "edge 2"]) -> Bool[np.ndarray, " edge"]:
    # Edges that are not used equally often in both senses
    count = int(edges.max()) + 1
    forth = edges[:, 0].astype(np.int64) * count + edges[:, 1]
    back = edges[:, 1].astype(np.int64) * count + edges[:, 0]
    keys, number = np.unique(forth, return_counts=True)
    place = np.minimum(np.searchsorted(keys, back), len(keys) - 1)
    reverse = np.where(keys[place] == back, number[place], 0)
    own = number[np.searchsorted(keys, forth)]
    lone: Bool[np.ndarray, " edge"] = (own != reverse) & (edges[:, 0] != edges[:, 1])
    return lone


def _in_sides(
    ends: Float[np.ndarray, "edge 2 3"], area: SampleArea
) -> Bool[np.ndarray, " edge"]:
    # Edges in or beyond a side of the unit cell
    near = _SAME * float(area.size.max())
    low, high = area.bounds[0, :2] + near, area.bounds[1, :2] - near
    beyond = np.concatenate([ends[..., :2] <= low, ends[..., :2] >= high], axis=-1)
    return np.asarray(beyond.all(axis=1).any(axis=-1))


def _volume(
    corner: Float[np.ndarray, "corner 3"], faces: Int[np.ndarray, "face 3"]
) -> float:
    # Volume by Gauss' theorem on (0, 0, z): vertical faces do not contribute
    a, b, c = np.moveaxis(corner[faces] - corner.mean(axis=0), 1, 0)
    upwards = np.cross(b - a, c - a)[:, 2] / 2
    return float(upwards @ (a + b + c)[:, 2] / 3)
