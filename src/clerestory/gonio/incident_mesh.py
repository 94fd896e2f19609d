"""Triangulation of incident directions.

Stereographic projection preserves circles, so that a Delaunay triangulation in the
plane is also a Delaunay triangulation on the sphere. The position in a triangle ABC is
given by the fraction s of the way from A to B and the fraction t of the way from the
point at s to C. Directions outside the mesh are projected onto its border.

For isotropic layers the mesh is a chain of edges along a meridian.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import Delaunay, QhullError

from clerestory.array_types import Directions, Indices, Mask, Values, Vector, Vector2
from clerestory.errors import InputError
from clerestory.gonio.angles import angle_between, from_degrees

# Smallest barycentric coordinate of directions that count as inside a triangle.
_INSIDE = -1e-9

_SIDES = ((0, 1), (0, 2), (1, 2))  # corner numbers of each side of a triangle
_THINNEST = 1e-6  # smallest volume spanned by the corner vectors of a triangle


@dataclass(frozen=True, eq=False)
class Mesh:
    """Incident directions and their triangulation."""

    vertices: Float[np.ndarray, "vertices 3"]  # unit vectors with z ≥ 0
    # Vertex indices of the corners of each triangle, in ascending order
    triangles: Int[np.ndarray, "triangles 3"]
    # Vertex indices of both ends of each edge, in ascending order
    edges: Int[np.ndarray, "edges 2"]
    # True for border edges, which belong to one triangle only
    rim: Bool[np.ndarray, " edges"]

    @property
    def arc(self) -> bool:
        """Whether the mesh is a meridian arc without triangles."""
        return bool(len(self.triangles) == 0)

    def only(self, kept: Bool[np.ndarray, " triangles"]) -> "Mesh":
        """Mesh of selected triangles, with the border edges of the whole mesh."""
        corners = self.triangles[kept]
        ends = [len(self.vertices), 1]
        used = np.isin(self.edges @ ends, corners[:, _SIDES].reshape(-1, 2) @ ends)
        return Mesh(self.vertices, corners, self.edges[used], self.rim[used])


@dataclass(frozen=True, eq=False)
class Place:
    """Positions of directions in a mesh."""

    # Index of the triangle, or of the edge if `on_edge`
    simplex: Int[np.ndarray, " directions"]
    # Whether the direction lies on an arc mesh or outside the mesh
    on_edge: Bool[np.ndarray, " directions"]
    # Fraction of the way from the first corner to the second
    s: Float[np.ndarray, " directions"]
    # Fraction of the way from the edge point `s` to the third corner; 0 if `on_edge`
    t: Float[np.ndarray, " directions"]
    # Directions inside the mesh; others are projected onto the border
    found: Float[np.ndarray, "directions 3"]


def triangulate(vertices: Directions) -> Mesh:
    """Return the Delaunay mesh of directions on the hemisphere."""
    flat = vertices[:, :2] / (1 + vertices[:, 2:])
    try:
        corners = np.sort(Delaunay(flat).simplices, axis=1)
    except (QhullError, ValueError) as error:
        raise InputError(
            f"all {len(vertices)} incident directions lie in one plane; directions in"
            " several planes expected unless the layer is isotropic"
        ) from error
    volume = np.abs(np.linalg.det(vertices[corners]))
    corners = corners[volume > _THINNEST].astype(int)
    every = corners[:, _SIDES].reshape(-1, 2)
    edges, sides = np.unique(every, axis=0, return_counts=True)
    return Mesh(vertices, corners, edges, sides == 1)


def arc_mesh(theta: Values) -> Mesh:
    """Return the mesh of an isotropic layer: an arc of ascending polar angles [rad]."""
    vertices = from_degrees(np.degrees(theta), 0.0)
    number = np.arange(len(theta) - 1)
    edges = np.stack([number, number + 1], axis=-1)
    none = np.zeros((0, 3), dtype=int)
    return Mesh(vertices, none, edges, np.ones(len(edges), dtype=bool))


def locate(mesh: Mesh, direction: Directions) -> Place:
    """Find the triangle of each direction, or the nearest point of the border."""
    simplex, s, t = (np.zeros(len(direction)) for _ in range(3))
    outside = np.ones(len(direction), dtype=bool)
    found = direction.copy()
    if not mesh.arc:
        simplex, s, t, outside = _in_triangles(mesh, direction)
    if np.any(outside):
        number, share, point = _on_rim(mesh, direction[outside])
        simplex[outside], s[outside], found[outside] = number, share, point
        t[outside] = 0
    return Place(simplex.astype(int), outside, s, t, found)


def flat_weights(corners: Directions, direction: Vector) -> tuple[Vector, Vector2]:
    """Barycentric coordinates of a direction in the unit disc, and interpolated point.

    In a triangle the point is the projected direction; on an edge it is the nearest
    point of the edge.

    >>> corners = from_degrees(np.array([0.0, 90]), np.array([0.0, 0]))
    >>> weights, place = flat_weights(corners, from_degrees(30.0, 0.0))
    >>> weights.round(6).tolist(), place.round(6).tolist()
    ([0.5, 0.5, 0.0], [0.5, 0.0])
    """
    disc = corners[:, :2]
    sides = (disc[1:] - disc[0]).T
    share, *_ = np.linalg.lstsq(sides, direction[:2] - disc[0], rcond=_THINNEST)
    weights = np.zeros(3)
    weights[0], weights[1 : len(corners)] = 1 - share.sum(), share
    return weights, weights[: len(corners)] @ disc


def _in_triangles(
    mesh: Mesh, direction: Directions
) -> tuple[Values, Values, Values, Mask]:
    corner = mesh.vertices[mesh.triangles]
    inverse = np.linalg.inv(corner.transpose(0, 2, 1))
    simplex, least = np.zeros(len(direction), dtype=int), np.zeros(len(direction))
    step = max(1, 1_000_000 // len(corner))
    for start in range(0, len(direction), step):
        part = slice(start, start + step)
        share = np.einsum("tij,dj->dti", inverse, direction[part]).min(axis=2)
        simplex[part] = share.argmax(axis=1)
        least[part] = share.max(axis=1)
    a, b, c = corner[simplex].transpose(1, 0, 2)
    share = np.einsum("dij,dj->di", inverse[simplex], direction)
    share = np.maximum(share, 0)
    from_c = share[:, :1] * a + share[:, 1:2] * b
    length = np.linalg.norm(from_c, axis=1, keepdims=True)
    point = np.where(length > 1e-12, from_c / np.maximum(length, 1e-300), a)
    s = angle_between(a, point) / angle_between(a, b)
    t = angle_between(point, direction) / angle_between(point, c)
    return simplex.astype(float), np.clip(s, 0, 1), np.clip(t, 0, 1), least < _INSIDE


def _on_rim(mesh: Mesh, direction: Directions) -> tuple[Indices, Values, Directions]:
    # Find the nearest point on the great circle of each border edge
    rim = np.flatnonzero(mesh.rim)
    a, b = mesh.vertices[mesh.edges[rim]].transpose(1, 0, 2)
    angle = angle_between(a, b)
    across = b - np.sum(a * b, axis=1, keepdims=True) * a
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    turn = np.arctan2(direction @ across.T, direction @ a.T)
    turn = np.clip(turn, 0, angle)
    point = np.cos(turn)[..., None] * a + np.sin(turn)[..., None] * across
    nearest = np.einsum("dei,di->de", point, direction).argmax(axis=1)
    row = np.arange(len(direction))
    return rim[nearest], turn[row, nearest] / angle[nearest], point[row, nearest]
