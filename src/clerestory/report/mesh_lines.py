"""Lines of triangle meshes: feature edges, and the walls of a floor plan."""

import numpy as np
from jaxtyping import Float, Int

# Cosine of the smallest angle between the normals of two faces that form an edge
_CREASE = np.cos(np.radians(15))

# Height added to the section plane to avoid coplanar surfaces such as desk tops [m]
_CLEARANCE = 0.011
_SHORTEST = 0.002
_DIRECTIONS = 90
_FARTHEST = 60.0


def weld(
    corners: Float[np.ndarray, "triangle 3 3"],
) -> tuple[Float[np.ndarray, "vertex 3"], Int[np.ndarray, "triangle 3"]]:
    """Merge corners within 0.1 mm; return vertices, and triangles as vertex indices."""
    points = corners.reshape(-1, 3).round(4)
    vertices, inverse = np.unique(points, axis=0, return_inverse=True)
    return vertices, inverse.reshape(-1, 3)


def feature_edges(
    vertices: Float[np.ndarray, "vertex 3"], faces: Int[np.ndarray, "face 3"]
) -> Int[np.ndarray, "edge 4"]:
    """Boundary and crease edges: indices of two vertices and of two adjacent faces.

    A boundary edge has one adjacent face, which is listed twice.
    """
    if not len(faces):
        return np.zeros((0, 4), dtype=int)
    normal = np.cross(
        vertices[faces[:, 1]] - vertices[faces[:, 0]],
        vertices[faces[:, 2]] - vertices[faces[:, 0]],
    )
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)

    # Sort triangle sides so that sides with equal vertices are adjacent
    sides = np.sort(
        np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    )
    owner = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort((sides[:, 1], sides[:, 0]))
    sides, owner = sides[order], owner[order]
    _, first, count = np.unique(sides, axis=0, return_index=True, return_counts=True)
    one, other = owner[first], owner[first + count - 1]
    flat = np.abs(np.sum(normal[one] * normal[other], axis=1)) > _CREASE
    kept = (count != 2) | ~flat
    return np.asarray(np.column_stack([sides[first], one, other])[kept])


def horizontal_section(
    corners: Float[np.ndarray, "triangle 3 3"], *, height: float
) -> Float[np.ndarray, "segment 2 2"]:
    """Segments in which triangles intersect the plane at `height` [m]."""
    above = corners[:, :, 2] > height + _CLEARANCE
    lone_side = above.sum(axis=1) == 1
    cut = lone_side | (above.sum(axis=1) == 2)
    corners, above, lone_side = corners[cut], above[cut], lone_side[cut]

    # In each cut triangle, one corner lies alone on one side of the plane
    lone = np.argmax(above == lone_side[:, None], axis=1)
    row = np.arange(len(corners))
    apex = corners[row, lone]
    ends = []
    for turn in (1, 2):
        other = corners[row, (lone + turn) % 3]
        share = (height + _CLEARANCE - apex[:, 2]) / (other[:, 2] - apex[:, 2])
        ends.append((apex + share[:, None] * (other - apex))[:, :2])
    segments = np.stack(ends, axis=1)
    long_enough = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1) > _SHORTEST
    return np.asarray(segments[long_enough])


def visible_extent(
    segments: Float[np.ndarray, "segment 2 2"], points: Float[np.ndarray, "point 2"]
) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]]:
    """Bounding rectangle of the region visible from the points: two corners [m].

    The segments are walls, which block the view. Directions without a wall within 60 m
    are ignored.
    """
    seen = [points]
    angle = np.arange(_DIRECTIONS) * 2 * np.pi / _DIRECTIONS + 0.01
    ray = np.stack([np.cos(angle), np.sin(angle)], axis=-1)[:, None, :]
    along = segments[:, 1] - segments[:, 0]
    for point in points[:: max(1, len(points) // 6)]:
        # Intersect every ray with every segment: t ray = start + s along
        start = segments[:, 0] - point
        with np.errstate(divide="ignore", invalid="ignore"):
            cross = ray[..., 0] * along[:, 1] - ray[..., 1] * along[:, 0]
            t = (start[:, 0] * along[:, 1] - start[:, 1] * along[:, 0]) / cross
            s = (start[:, 0] * ray[..., 1] - start[:, 1] * ray[..., 0]) / cross
        t = np.where((s >= 0) & (s <= 1) & (t > 0), t, np.inf)
        nearest = t.min(axis=1, initial=np.inf)
        hit = nearest < _FARTHEST
        seen.append(point + nearest[hit, None] * ray[hit, 0])
    everything = np.concatenate(seen)
    return everything.min(axis=0), everything.max(axis=0)
