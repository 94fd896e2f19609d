"""Regular sensor grid above horizontal or sloping polygons, such as floors of rooms.

The grid follows the longest edge of the polygons, and its outermost points have equal
distances to opposite sides of their bounding rectangle.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from clerestory.array_types import Vector
from clerestory.checks import positive
from clerestory.scene.surface import area_vector

# Smallest distance from a sensor to the outline of the polygon [m]
_MARGIN = 0.1

# Fineness of the search for the innermost point, per side of the bounding rectangle
_FINE = 32

Loop = Float[np.ndarray, "_ 3"]
_Plan = Float[np.ndarray, "_ 2"]


def polygon_grid(
    polygons: Sequence[Loop], *, spacing: float, height: float
) -> Float[np.ndarray, "point 3"]:
    """Return points of a regular grid above polygons [m].

    Polygons are filled by the even–odd rule, with seams to their holes. Points are at
    least 0.1 m from the outlines; if there are none, the innermost point of the largest
    polygon is returned. Without a polygon of any horizontal area, there are no points.

    >>> floor = np.array([[0.0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]])
    >>> polygon_grid([floor], spacing=1, height=0.8).tolist()
    [[0.5, 0.5, 0.8], [1.5, 0.5, 0.8]]
    """
    positive(spacing, "spacing", unit="m")
    floors = [p for p in polygons if abs(area_vector(p)[2]) > _MARGIN**2]
    if not floors:
        return np.zeros((0, 3))
    along = _direction(floors)
    turn = np.array([along, [-along[1], along[0]]]).T
    plans = [p[:, :2] @ turn for p in floors]
    every = np.concatenate(plans)
    axes = [_places(every[:, k], spacing) for k in (0, 1)]
    lattice = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    found = []
    for floor, plan in zip(floors, plans, strict=True):
        chosen = lattice[inside(lattice, plan) & (_clearance(lattice, plan) >= _MARGIN)]
        found.append(_above(chosen, floor, turn, height))
    points = np.concatenate(found)
    if len(points):
        return points
    largest = int(np.argmax([abs(area_vector(p)[2]) for p in floors]))
    return _above(_innermost(plans[largest]), floors[largest], turn, height)


def inside(points: _Plan, outline: _Plan) -> Bool[np.ndarray, " points"]:
    """Whether points of a plane are in a polygon, by the even–odd rule.

    >>> triangle = np.array([[0.0, 0], [2, 0], [0, 2]])
    >>> inside(np.array([[0.5, 0.5], [1.5, 1.5]]), triangle).tolist()
    [True, False]
    """
    odd = np.zeros(len(points), dtype=bool)
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        crosses = (a[1] > points[:, 1]) != (b[1] > points[:, 1])
        if crosses.any():
            at = a[0] + (points[:, 1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1])
            odd ^= crosses & (points[:, 0] < at)
    return odd


def _direction(floors: Sequence[Loop]) -> Float[np.ndarray, "2"]:
    # Unit vector of the longest horizontal edge, turned into the first quadrant
    edges = np.concatenate([(np.roll(p, -1, axis=0) - p)[:, :2] for p in floors])
    length = np.linalg.norm(edges, axis=1)
    x, y = edges[int(length.argmax())] / length.max()
    while not (x > 1e-9 and y >= -1e-9):
        x, y = -y, x
    return np.array([x, max(y, 0.0)])


def _places(
    coordinate: Float[np.ndarray, " n"], spacing: float
) -> Float[np.ndarray, " m"]:
    low, width = float(coordinate.min()), float(np.ptp(coordinate))
    count = max(1, int(width / spacing + 1e-6))
    return low + (width - (count - 1) * spacing) / 2 + spacing * np.arange(count)


def _clearance(points: _Plan, outline: _Plan) -> Float[np.ndarray, " points"]:
    # Distance to the nearest edge, without the seams, which are passed both ways
    nearest = np.full(len(points), np.inf)
    ends = [
        (*a, *b) for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True)
    ]
    for end in ends:
        if (*end[2:], *end[:2]) in ends:
            continue
        a, b = np.array(end[:2]), np.array(end[2:])
        edge = b - a
        along = np.clip((points - a) @ edge / max(float(edge @ edge), 1e-12), 0, 1)
        away = np.linalg.norm(points - a - along[:, None] * edge, axis=1)
        nearest = np.minimum(nearest, away)
    return nearest


def _innermost(plan: _Plan) -> Float[np.ndarray, "1 2"]:
    low, high = plan.min(axis=0), plan.max(axis=0)
    share = (np.arange(_FINE + 1)) / _FINE
    axes = [low[k] + share * (high[k] - low[k]) for k in (0, 1)]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    away = np.where(inside(points, plan), _clearance(points, plan), -1)
    return points[[int(away.argmax())]]


def _above(
    points: _Plan, floor: Loop, turn: Float[np.ndarray, "2 2"], height: float
) -> Float[np.ndarray, "_ 3"]:
    # Points at a height above the plane of a polygon
    normal: Vector = area_vector(floor)
    flat = points @ turn.T
    rise = ((floor[0, :2] - flat) @ normal[:2]) / normal[2]
    return np.column_stack([flat, floor[0, 2] + rise + height])
