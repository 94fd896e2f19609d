"""Points inside polygons, by the even–odd rule."""

import numpy as np
from jaxtyping import Bool, Float


def inside_polygon(
    points: Float[np.ndarray, "point 2"], corners: Float[np.ndarray, "corner 2"]
) -> Bool[np.ndarray, " point"]:
    """Return whether points lie inside a polygon of the plane.

    >>> square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    >>> inside_polygon(np.array([[1.0, 1], [3, 1]]), square).tolist()
    [True, False]
    """
    x, y = points.T
    found = np.zeros(len(points), dtype=bool)
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if y0 != y1:
            crosses = (y0 > y) != (y1 > y)
            found ^= crosses & (x < x0 + (y - y0) / (y1 - y0) * (x1 - x0))
    return found
