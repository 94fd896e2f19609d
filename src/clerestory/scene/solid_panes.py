"""Panes that are modelled as solids or as several parallel faces.

Modelling programs export a pane as a box of six faces, or double glazing as parallel
faces. A window is one face of them, that towards the room: the BSDF describes the light
between the outermost and the innermost plane.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import cKDTree

from clerestory.array_types import Vertices
from clerestory.directions import unit
from clerestory.scene.surface import area_vectors
from clerestory.scene.window import Window

# Largest distance between the faces of a pane, and smallest one of two planes [m]
THICKEST, _THINNEST = 0.1, 1e-4

# Distance below which vertices of two faces coincide [m]
_SAME = 1e-3

# Cosine of the largest angle between parallel faces, sine of that between a face and
# the normal of an edge
_PARALLEL, _ACROSS = np.cos(np.radians(0.5)), np.sin(np.radians(2.0))

# Share of a face that another one covers if they belong to the same pane
_COVERED = 0.5


def edges_of_panes(outlines: Sequence[Vertices]) -> Bool[np.ndarray, " face"]:
    """Whether polygons [m] are edges of solid panes.

    All vertices of an edge coincide with those of two parallel faces, which are at most
    0.1 m apart and perpendicular to the edge.
    """
    if not outlines:
        return np.zeros(0, bool)
    count = np.array([len(outline) for outline in outlines])
    first = np.concatenate([[0], np.cumsum(count)])
    points = np.concatenate(list(outlines))
    normal = unit(area_vectors(points, first))
    owner = np.repeat(np.arange(len(outlines)), count)
    near = cKDTree(points).query_ball_point(points, _SAME)
    neighbours = [set(owner[each].tolist()) for each in near]
    return np.array(
        [
            _is_edge(k, outline, normal, outlines, neighbours[start : start + size])
            for k, (outline, start, size) in enumerate(
                zip(outlines, first, count, strict=False)
            )
        ]
    )


def _is_edge(
    k: int,
    outline: Vertices,
    normal: Float[np.ndarray, "face 3"],
    outlines: Sequence[Vertices],
    neighbours: Sequence[set[int]],
) -> bool:
    # Whether a face connects two of the faces that have vertices in common with it
    around = sorted(
        n for n in set.union(*neighbours) if abs(normal[n] @ normal[k]) < _ACROSS
    )
    for n in around:
        deep = outline @ normal[n] - outlines[n][0] @ normal[n]
        behind = [
            other
            for other in around
            if abs(normal[other] @ normal[n]) >= _PARALLEL
            and _THINNEST
            < abs((outlines[other][0] - outlines[n][0]) @ normal[n])
            <= THICKEST
        ]
        reached = all(
            n in each if abs(depth) <= _SAME else not each.isdisjoint(behind)
            for each, depth in zip(neighbours, deep, strict=True)
        )
        if behind and reached and np.ptp(deep) > _THINNEST:
            return True
    return False


def faces_behind_others(windows: Sequence[Window]) -> Bool[np.ndarray, " face"]:
    """Whether other faces of the same pane lie between faces and the room.

    `windows` [m] have one polygon each, and their normals point into the room. Half of
    a face or more is covered by parallel faces at most 0.1 m closer to the room.
    """
    normal = np.array([window.frame.normal for window in windows]).reshape(-1, 3)
    corners = [
        np.concatenate([t.vertices[t.faces] for t in window.triangles()])
        for window in windows
    ]
    place = np.array([corner[0, 0] for corner in corners]).reshape(-1, 3)
    found = np.zeros(len(windows), bool)
    for k, corner in enumerate(corners):
        ahead = (place - place[k]) @ normal[k]
        front = (ahead > _THINNEST) & (ahead <= THICKEST)
        front &= normal @ normal[k] >= _PARALLEL
        cover = [corners[n] for n in np.flatnonzero(front)]
        if cover:
            share = _covered(corner, np.concatenate(cover), normal[k])
            found[k] = share >= _COVERED
    return found


def _covered(
    face: Float[np.ndarray, "triangle 3 3"],
    cover: Float[np.ndarray, "other 3 3"],
    normal: Float[np.ndarray, "3"],
) -> float:
    # Share of the area of triangles whose centroid is behind other triangles
    a, b, c = (cover[:, k] for k in range(3))
    twice = np.cross(b - a, c - a) @ normal
    centre = face.mean(axis=1)[:, None]
    parts = [
        np.cross(q - p, centre - p) @ normal * np.sign(twice)
        for p, q in ((a, b), (b, c), (c, a))
    ]
    inside = (np.array(parts) >= -1e-9).all(axis=0) & (np.abs(twice) > 0)
    area = np.linalg.norm(
        np.cross(face[:, 1] - face[:, 0], face[:, 2] - face[:, 0]), axis=1
    )
    return float(area @ inside.any(axis=1) / area.sum())
