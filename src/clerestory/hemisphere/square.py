"""Shirley and Chiu's map between the unit square and the unit disc.

It takes rings of squares to rings of the disc, keeps shares of area and leaves
neighbours neighbours. The disc is the hemisphere seen from above: equal areas of
it are equal projected solid angles, so the cells of a square grid cut the
hemisphere into patches of equal Λ.

Reference: P. Shirley, K. Chiu, "A low distortion map between disk and square",
Journal of Graphics Tools 2 (3), 1997, 45–52.
"""

import numpy as np
from jaxtyping import Float


def square_from_disc(
    x: Float[np.ndarray, "*batch"], y: Float[np.ndarray, "*batch"]
) -> tuple[Float[np.ndarray, "*batch"], Float[np.ndarray, "*batch"]]:
    """Points of the square [0, 1]² for points of the unit disc.

    Opposite points of the disc lie opposite in the square: −x, −y go to 1 − a, 1 − b.

    >>> a, b = square_from_disc(np.array([0.0, 1.0]), np.array([0.0, 0.0]))
    >>> a.tolist(), b.tolist()
    ([0.5, 1.0], [0.5, 0.5])
    """
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)

    # The radius becomes the larger coordinate, the angle the other
    steep = np.abs(y) > np.abs(x)
    far, near = np.where(steep, y, x), np.where(steep, x, y)
    edge = np.copysign(0.5 * np.sqrt(x * x + y * y), far)
    angle = np.arctan(near / np.where(far == 0, 1.0, far))
    along = edge * angle * (4 / np.pi)
    return 0.5 + np.where(steep, along, edge), 0.5 + np.where(steep, edge, along)


def disc_from_square(
    a: Float[np.ndarray, "*batch"], b: Float[np.ndarray, "*batch"]
) -> tuple[Float[np.ndarray, "*batch"], Float[np.ndarray, "*batch"]]:
    """Points of the unit disc for points of the square [0, 1]².

    >>> x, y = disc_from_square(np.array(0.5), np.array(1.0))
    >>> round(float(x), 12), round(float(y), 12)
    (0.0, 1.0)
    """
    a, b = 2 * np.asarray(a, dtype=float) - 1, 2 * np.asarray(b, dtype=float) - 1
    steep = np.abs(b) > np.abs(a)
    radius, along = np.where(steep, b, a), np.where(steep, a, b)
    angle = (np.pi / 4) * along / np.where(radius == 0, 1.0, radius)
    far, near = radius * np.cos(angle), radius * np.sin(angle)
    return np.where(steep, near, far), np.where(steep, far, near)
