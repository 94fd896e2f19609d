"""Cells of sensors in a floor plan.

On a regular grid, possibly rotated, the cells are equal rectangles; otherwise they are
discs about as wide as the median distance between neighbours.
"""

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

_LONELY_SIZE = 0.5
_DISC_CORNERS = 16

# Length of the mean direction below which sensors have no common plane
_SPREAD = 0.5

# Horizontal part of a unit normal below which a surface is horizontal
_LEVEL = 1e-6


def sensor_cells(
    points: Float[np.ndarray, "sensor 2"],
) -> Float[np.ndarray, "sensor corner 2"]:
    """Corners of the cell of each sensor in the plan [m]."""
    places = np.unique(points.round(4), axis=0)
    if len(places) == 1:
        return _rectangles(points, size=(_LONELY_SIZE, _LONELY_SIZE), turn=0.0)
    distance, neighbour = cKDTree(places).query(places, k=2)
    spacing = float(np.median(distance[:, 1]))

    # On a grid, directions to neighbours differ by multiples of 90°
    towards = places[neighbour[:, 1]] - places
    phase = np.mean(np.exp(4j * np.arctan2(towards[:, 1], towards[:, 0])))
    turn = float(np.angle(phase)) / 4
    if abs(phase) > 0.9:
        straight = places @ _rotation(turn)
        columns = _lines(straight[:, 0], tolerance=0.1 * spacing)
        rows = _lines(straight[:, 1], tolerance=0.1 * spacing)
        if len(places) > 0.25 * len(columns) * len(rows):
            size = (_step(columns, spacing), _step(rows, spacing))
            return _rectangles(points, size=size, turn=turn)
    angle = np.arange(_DISC_CORNERS) * 2 * np.pi / _DISC_CORNERS
    rim = 0.45 * spacing * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return points[:, None, :] + rim


def _rotation(turn: float) -> Float[np.ndarray, "2 2"]:
    # points @ _rotation(a) rotates the points by −a
    cos, sin = np.cos(turn), np.sin(turn)
    return np.array([[cos, -sin], [sin, cos]])


def _lines(
    coordinate: Float[np.ndarray, " sensor"], *, tolerance: float
) -> Float[np.ndarray, " line"]:
    # Coordinates of the rows or columns of a grid
    ordered = np.sort(coordinate)
    return ordered[np.flatnonzero(np.diff(ordered, prepend=-np.inf) > tolerance)]


def _step(lines: Float[np.ndarray, " line"], spacing: float) -> float:
    return float(np.median(np.diff(lines))) if len(lines) > 1 else spacing


def _rectangles(
    points: Float[np.ndarray, "sensor 2"], *, size: tuple[float, float], turn: float
) -> Float[np.ndarray, "sensor 4 2"]:
    corner = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) * size
    return np.asarray(points[:, None, :] + corner @ _rotation(turn).T)


def sensor_faces(
    position: Float[np.ndarray, "sensor 3"], direction: Float[np.ndarray, "sensor 3"]
) -> Float[np.ndarray, "sensor corner 3"]:
    """Corners of the cell of each sensor, across the mean direction [m].

    Sensors of one grid have about the same direction. The corners are counter-clockwise
    as seen from the side that the sensors face.

    >>> faces = sensor_faces(np.array([[0.0, 0, 1], [0, 2, 1]]), np.eye(3)[[2, 2]])
    >>> faces[0, 0].round(6).tolist()
    [-1.0, -1.0, 1.0]
    """
    normal = direction.mean(axis=0)
    length = float(np.linalg.norm(normal))
    normal = normal / length if length > _SPREAD else np.array([0.0, 0.0, 1.0])
    # Across: horizontal, or +x for horizontal surfaces; along completes the frame
    level = np.array([-normal[1], normal[0], 0.0])
    slope = float(np.hypot(*level[:2]))
    across = level / slope if slope > _LEVEL else np.array([1.0, 0.0, 0.0])
    along = np.cross(normal, across)
    frame = np.stack([across, along], axis=-1)
    plane = position @ frame
    shift = sensor_cells(plane) - plane[:, None, :]
    return np.asarray(position[:, None, :] + shift @ frame.T)
