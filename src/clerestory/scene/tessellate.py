"""Tessellation of scenes into one triangle mesh per material."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Faces, Vertices
from clerestory.scene.curved import curved_triangles
from clerestory.scene.model import Material, Polygon, Scene, Surface, TriangleMesh
from clerestory.scene.triangulate import Triangles, triangulate


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of one material, counter-clockwise as seen from the front.

    `surface` is the index into `Scene.surfaces` of each triangle.
    """

    material: Material
    vertices: Vertices
    faces: Faces
    surface: Int[np.ndarray, " triangles"]


@dataclass(frozen=True, eq=False)
class _Part:
    # Triangles, with the index of the surface of each triangle
    vertices: Vertices
    faces: Faces
    surface: Int[np.ndarray, " triangles"]


def meshes(scene: Scene) -> tuple[Mesh, ...]:
    """Return the surfaces of a scene as triangles, one mesh per material in use.

    Polygons are filled by the even–odd rule, with new vertices only if they intersect
    themselves; for curved surfaces see `curved`.

    Examples
    --------
    >>> from clerestory.scene.model import Light
    >>> pane = Polygon(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), "sky")
    >>> [mesh] = meshes(Scene({"sky": Light("sky", np.ones(3))}, (pane,)))
    >>> len(mesh.faces)
    2
    """
    groups: dict[str, list[int]] = {}
    for i, surface in enumerate(scene.surfaces):
        groups.setdefault(surface.material, []).append(i)
    return tuple(
        _mesh(scene.materials[key], scene.surfaces, groups[key])
        for key in scene.materials
        if key in groups
    )


def _mesh(material: Material, surfaces: Sequence[Surface], chosen: list[int]) -> Mesh:
    parts = list(_parts(surfaces, chosen))
    start = np.cumsum([0, *(len(p.vertices) for p in parts)])
    return Mesh(
        material,
        np.concatenate([p.vertices for p in parts]),
        np.concatenate(
            [p.faces + s for p, s in zip(parts, start, strict=False)]
        ).astype(np.int32),
        np.concatenate([p.surface for p in parts]).astype(np.int32),
    )


def _parts(surfaces: Sequence[Surface], chosen: list[int]) -> Iterator[_Part]:
    # Convex polygons are processed together by number of corners, other surfaces singly
    by_corners: dict[int, list[int]] = {}
    rest: list[int] = []
    for i in chosen:
        surface = surfaces[i]
        if isinstance(surface, Polygon):
            by_corners.setdefault(len(surface.vertices), []).append(i)
        else:
            rest.append(i)
    for alike in by_corners.values():
        index, corner = np.array(alike), _corners(surfaces, alike)
        convex = _convex(corner)
        rest += index[~convex].tolist()
        if convex.any():
            yield _fans(corner[convex], index[convex])
    for i in rest:
        triangles = _triangles(surfaces[i])
        origin = np.full(len(triangles.faces), i)
        yield _Part(triangles.vertices, triangles.faces, origin)


def _triangles(surface: Surface) -> Triangles:
    if isinstance(surface, Polygon):
        return triangulate(surface.vertices)
    if isinstance(surface, TriangleMesh):
        return Triangles(surface.vertices, surface.faces)
    return curved_triangles(surface)


def _corners(
    surfaces: Sequence[Surface], chosen: list[int]
) -> Float[np.ndarray, "polygons corners 3"]:
    polygons = [s for s in (surfaces[i] for i in chosen) if isinstance(s, Polygon)]
    return np.concatenate([p.vertices for p in polygons]).reshape(len(polygons), -1, 3)


def _fans(
    corner: Float[np.ndarray, "polygons corners 3"], index: Int[np.ndarray, " polygons"]
) -> _Part:
    # Triangle fan around the first corner
    count, corners = corner.shape[:2]
    fan = np.array([(0, k, k + 1) for k in range(1, corners - 1)])
    faces = (corners * np.arange(count)[:, None, None] + fan).reshape(-1, 3)
    return _Part(corner.reshape(-1, 3), faces, np.repeat(index, corners - 2))


def _convex(
    corner: Float[np.ndarray, "polygons corners 3"],
) -> Bool[np.ndarray, " polygons"]:
    # Convex: all corners turn in the sense of the polygon; seen from the first corner,
    # all corners are in order within 180°, so that the winding number is one
    if corner.shape[1] == 3:
        return np.ones(len(corner), dtype=bool)
    edge = np.roll(corner, -1, axis=1) - corner
    turn = np.cross(np.roll(edge, 1, axis=1), edge)
    spoke = corner[:, 1:] - corner[:, :1]
    fan = np.cross(spoke[:, :-1], spoke[:, 1:])
    sweep = np.cross(spoke[:, :1], spoke[:, 1:])
    whole = fan.sum(axis=1)
    share = np.einsum("pcx,px->pc", np.concatenate([turn, fan, sweep], axis=1), whole)
    size = np.einsum("px,px->p", whole, whole)
    return np.asarray(np.all(share > 1e-9 * size[:, None], axis=1))
