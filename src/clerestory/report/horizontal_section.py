"""Horizontal section of a scene: the walls of a floor plan."""

import numpy as np
from jaxtyping import Float

# Offset of the section plane, which avoids coplanar surfaces such as desk tops [m]
_CLEARANCE = 0.011
_SHORTEST = 0.002
_DIRECTIONS = 90
_FARTHEST = 60.0


def horizontal_section(
    corners: Float[np.ndarray, "triangle 3 3"], *, height: float
) -> Float[np.ndarray, "segment 2 2"]:
    """Segments in which triangles intersect the plane at `height` [m].

    Examples
    --------
    >>> wall = np.array([[[0.0, 0, 0], [4, 0, 0], [4, 0, 3]]])
    >>> horizontal_section(wall, height=1.489).round(6).tolist()
    [[[2.0, 0.0], [4.0, 0.0]]]
    """
    above = corners[:, :, 2] > height + _CLEARANCE
    lone_side = above.sum(axis=1) == 1
    cut = lone_side | (above.sum(axis=1) == 2)
    corners, above, lone_side = corners[cut], above[cut], lone_side[cut]

    # The plane separates one corner of a triangle from the other two
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
    """Low and high corner of the region visible from the points in the plane [m].

    The region covers the room of the sensors without its surroundings. Directions
    without an obstruction within 60 m are ignored.
    """
    seen = [points]
    angle = np.arange(_DIRECTIONS) * 2 * np.pi / _DIRECTIONS + 0.01
    ray = np.stack([np.cos(angle), np.sin(angle)], axis=-1)[:, None, :]
    along = segments[:, 1] - segments[:, 0]
    for point in points[:: max(1, len(points) // 6)]:
        # Intersect every ray with every segment: point + t ray = start + s along
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
