"""Feature edges of triangle meshes."""

import numpy as np
from jaxtyping import Float, Int

# Cosine of the smallest angle between faces that form an edge
_CREASE = np.cos(np.radians(15))


def weld(
    corners: Float[np.ndarray, "triangle 3 3"],
) -> tuple[Float[np.ndarray, "vertex 3"], Int[np.ndarray, "triangle 3"]]:
    """Return vertices merged within 0.1 mm, and faces as vertex indices."""
    points = corners.reshape(-1, 3).round(4)
    vertices, inverse = np.unique(points, axis=0, return_inverse=True)
    return vertices, inverse.reshape(-1, 3)


def feature_edges(
    vertices: Float[np.ndarray, "vertex 3"], faces: Int[np.ndarray, "face 3"]
) -> Int[np.ndarray, "edge 4"]:
    """Boundary and crease edges, each as two vertices and the two adjacent faces.

    The face of a boundary edge is listed twice.
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
