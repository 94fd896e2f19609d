"""Tessellation of scenes into one triangle mesh per material.

A circle becomes a regular polygon of 64 sides with the area of the circle, so that the
areas of discs, rings and tube openings are exact. The lateral area of a cylinder is
0.04 % too large; points deviate from the true surface by at most 0.13 % of the radius.
A sphere becomes 1280 triangles with the exact surface area and mean projected area of
the sphere; points deviate by at most 0.5 % of the radius.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import permutations

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Faces, Vector, Vertices
from clerestory.brief_repr import brief
from clerestory.errors import located
from clerestory.scene.model import (
    Cone,
    Material,
    Polygon,
    Ring,
    Scene,
    Sphere,
    Surface,
    TriangleMesh,
)
from clerestory.scene.triangulate import Triangles, triangulate


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of one material, counter-clockwise as seen from the front.

    `surface` has the index of each triangle's surface in `Scene.surfaces`.
    """

    material: Material
    vertices: Vertices
    faces: Faces
    surface: Int[np.ndarray, " triangles"]

    __repr__ = brief


def meshes(scene: Scene) -> tuple[Mesh, ...]:
    """Return the surfaces of a scene as triangles, one mesh per material in use.

    Polygons are filled by the even–odd rule; only polygons that intersect themselves
    get new vertices. For curved surfaces see `curved_triangles`. A material whose
    surfaces have no triangles has no mesh: an outline that is run through twice is
    filled nowhere.
    """
    if not scene.surfaces:
        return ()
    parts, surface = zip(*_parts(scene.surfaces), strict=True)
    start = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    faces = np.concatenate(
        [part.faces + first for part, first in zip(parts, start, strict=True)]
    )
    number = {name: k for k, name in enumerate(scene.materials)}
    material = np.array([number[each.material] for each in scene.surfaces])
    vertices = np.concatenate([part.vertices for part in parts])
    return tuple(
        _by_material(scene, vertices, faces, np.concatenate(surface), material)
    )


def _by_material(
    scene: Scene,
    vertices: Vertices,
    faces: Faces,
    surface: Int[np.ndarray, " triangles"],
    material: Int[np.ndarray, " surfaces"],
) -> Iterator[Mesh]:
    # Triangles and their vertices in the order of the materials; `owner` has the
    # material of each vertex, but the last one for vertices without a triangle
    owner = np.full(len(vertices), len(scene.materials) - 1)
    owner[faces] = material[surface][:, None]
    place = np.argsort(owner, kind="stable")
    rank = np.empty_like(place)
    rank[place] = np.arange(len(place))
    order = np.argsort(material[surface], kind="stable")
    vertices, faces, surface = vertices[place], rank[faces[order]], surface[order]
    names = range(len(scene.materials) + 1)
    vertex_of = np.searchsorted(owner[place], names)
    face_of = np.searchsorted(material[surface], names)
    for k, name in enumerate(scene.materials):
        own = slice(face_of[k], face_of[k + 1])
        if face_of[k] < face_of[k + 1]:
            first, end = vertex_of[k], vertex_of[k + 1]
            yield Mesh(
                scene.materials[name],
                vertices[first:end],
                (faces[own] - first).astype(np.int32),
                surface[own].astype(np.int32),
            )


def _parts(
    surfaces: Sequence[Surface],
) -> Iterator[tuple[Triangles, Int[np.ndarray, " triangles"]]]:
    # Yields triangles and surface indices; convex polygons are grouped by corner count
    by_corners: dict[int, list[int]] = {}
    rest: list[int] = []
    for i, surface in enumerate(surfaces):
        if isinstance(surface, Polygon):
            by_corners.setdefault(len(surface.vertices), []).append(i)
        else:
            rest.append(i)
    for alike in by_corners.values():
        index, corner = np.array(alike), _corners(surfaces, alike)
        convex = _convex(corner)
        rest += index[~convex].tolist()
        if convex.any():
            fans = _fans(corner[convex])
            yield fans, np.repeat(index[convex], corner.shape[1] - 2)
    for i in rest:
        triangles = _triangles(surfaces[i])
        yield triangles, np.full(len(triangles.faces), i)


def _triangles(surface: Surface) -> Triangles:
    if isinstance(surface, Polygon):
        place = vars(surface.source) if surface.source else {"file": None}
        with located(**place):
            return triangulate(surface.vertices)
    if isinstance(surface, TriangleMesh):
        return Triangles(surface.vertices, surface.faces)
    return curved_triangles(surface)


def _corners(
    surfaces: Sequence[Surface], chosen: list[int]
) -> Float[np.ndarray, "polygons corners 3"]:
    polygons = [s for s in (surfaces[i] for i in chosen) if isinstance(s, Polygon)]
    return np.concatenate([p.vertices for p in polygons]).reshape(len(polygons), -1, 3)


def _fans(corner: Float[np.ndarray, "polygons corners 3"]) -> Triangles:
    # Triangle fans around the first corner of each polygon
    count, corners = corner.shape[:2]
    fan = np.array([(0, k, k + 1) for k in range(1, corners - 1)])
    faces = (corners * np.arange(count)[:, None, None] + fan).reshape(-1, 3)
    return Triangles(corner.reshape(-1, 3), faces)


def _convex(
    corner: Float[np.ndarray, "polygons corners 3"],
) -> Bool[np.ndarray, " polygons"]:
    # In a convex polygon all corners turn in the same sense; seen from the first one,
    # the others are in order within 180°, so that the winding number is one
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


SIDES = 64

# Circumradius of the regular polygon with the area of the unit circle
_CIRCUMRADIUS = np.sqrt(2 * np.pi / (SIDES * np.sin(2 * np.pi / SIDES)))


def curved_triangles(surface: Sphere | Cone | Ring) -> Triangles:
    """Return triangles that approximate a curved surface, with the same front."""
    match surface:
        case Sphere():
            ball = _unit_sphere()
            vertices = surface.centre + surface.radius * ball.vertices
            return _turned(Triangles(vertices, ball.faces), surface.inward)
        case Cone():
            axis = surface.top - surface.base
            lower = surface.base + surface.base_radius * _circle(axis)
            upper = surface.top + surface.top_radius * _circle(axis)
            return _turned(_band(lower, upper), surface.inward)
        case Ring():
            circle = _circle(surface.normal)
            inner = surface.centre + surface.inner_radius * circle
            outer = surface.centre + surface.outer_radius * circle
            return _band(outer, inner)


def _turned(triangles: Triangles, inward: bool) -> Triangles:
    if not inward:
        return triangles
    return Triangles(triangles.vertices, triangles.faces[:, ::-1])


def _circle(axis: Vector) -> Float[np.ndarray, "sides 3"]:
    # Regular polygon around an axis, the same for the opposite axis: discs fit tubes
    along = axis / np.linalg.norm(axis)
    first = np.cross(np.eye(3)[np.argmin(np.abs(along).round(9))], along)
    first = first / np.linalg.norm(first)
    second = np.cross(along, first)
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    corners = np.outer(np.cos(angle), first) + np.outer(np.sin(angle), second)
    return np.asarray(_CIRCUMRADIUS * corners)


def _band(
    lower: Float[np.ndarray, "sides 3"], upper: Float[np.ndarray, "sides 3"]
) -> Triangles:
    # Two triangles per side; one triangle if the radius of an end is zero
    i = np.arange(SIDES)
    j = (i + 1) % SIDES
    faces = np.empty((0, 3), dtype=int)
    if np.ptp(lower, axis=0).any():
        faces = np.concatenate([faces, np.stack([i, j, SIDES + j], axis=1)])
    if np.ptp(upper, axis=0).any():
        faces = np.concatenate([faces, np.stack([i, SIDES + j, SIDES + i], axis=1)])
    return Triangles(np.concatenate([lower, upper]), faces)


@cache
def _unit_sphere() -> Triangles:
    # An icosahedron; each face is divided into four triangles, three times
    golden = (1 + np.sqrt(5)) / 2
    flat = np.array([(0, s, t * golden) for s in (-1, 1) for t in (-1, 1)])
    vertices = np.concatenate([np.roll(flat, k, axis=1) for k in range(3)])
    vertices = vertices / np.linalg.norm(vertices[0])
    faces = _hull_faces(vertices)
    for _ in range(3):
        vertices, faces = _subdivided(vertices, faces)
    area = Triangles(vertices, faces).areas().sum()
    return Triangles(vertices * np.sqrt(4 * np.pi / area), faces)


def _hull_faces(vertices: Float[np.ndarray, "12 3"]) -> Int[np.ndarray, "20 3"]:
    # Triples of adjacent icosahedron vertices, counter-clockwise as seen from outside
    near = vertices @ vertices.T > 0.4
    faces = [
        (a, b, c)
        for a, b, c in permutations(range(12), 3)
        if a < min(b, c) and near[a, b] and near[b, c] and near[c, a]
        if np.linalg.det(vertices[[a, b, c]]) > 0
    ]
    return np.array(faces)


def _subdivided(
    vertices: Vertices, faces: Faces
) -> tuple[Float[np.ndarray, "more 3"], Int[np.ndarray, "fourfold 3"]]:
    a, b, c = faces.T
    edges = np.sort(
        np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    )
    unique, place = np.unique(edges, axis=0, return_inverse=True)
    middle = vertices[unique].sum(axis=1)
    middle = middle / np.linalg.norm(middle, axis=1, keepdims=True)
    ab, bc, ca = np.split(len(vertices) + place.ravel(), 3)
    quarters = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    faces = np.concatenate([np.stack(q, axis=1) for q in quarters])
    return np.concatenate([vertices, middle]), faces
