"""Cells of the sphere around a point, as receivers of radiance.

The radiance of a cell is the mean over its directions, like that of a pixel. The cells
are those of the quadtree on the equal-area map of `hemisphere.sphere_square`, so that
points distributed uniformly over a cell of the map are uniform in solid angle.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from clerestory.brief_repr import brief
from clerestory.checks import has_shape


@dataclass(frozen=True, eq=False)
class SphereCells:
    """Cells of the sphere around a point.

    Attributes
    ----------
    position : the point [m]
    level : level of each cell, whose solid angle is 4π/4ⁿ
    place : row and column of each cell among the 2ⁿ × 2ⁿ cells of its level

    >>> eye = SphereCells(np.zeros(3), np.array([0]), np.array([[0, 0]]))
    >>> len(eye)
    1
    """

    position: Float[np.ndarray, "3"]
    level: Int[np.ndarray, " cell"]
    place: Int[np.ndarray, "cell 2"]

    __repr__ = brief

    def __post_init__(self) -> None:
        has_shape(self.place, (len(self.level), 2), "places of the cells")

    def __len__(self) -> int:
        return len(self.level)

    def scaled(self, factor: float) -> "SphereCells":
        """Return the cells around the point at the position times a factor."""
        return replace(self, position=self.position * factor)
