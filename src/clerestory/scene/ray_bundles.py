"""Bundles of given rays, as receivers of radiance.

The radiance of a bundle is the mean over its rays, like that of a pixel over the rays
that `vwrays -c` sends through it.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from clerestory.array_types import Vector
from clerestory.brief_repr import brief
from clerestory.checks import finite, has_shape
from clerestory.directions import unit


@dataclass(frozen=True, eq=False)
class RayBundles:
    """Bundles of equally many rays.

    Attributes
    ----------
    origin : origins of the rays [m]
    direction : directions of the rays; normalized to unit length. A ray of direction
        zero has no radiance, as those of `vwrays` outside the circle of a view

    Raises
    ------
    InputError : shapes do not match, or a number is not finite

    >>> up = RayBundles(np.zeros((1, 2, 3)), np.array([[[0.0, 0, 2], [0, 1, 1]]]))
    >>> len(up), up.rays, up.direction[0, 0].tolist()
    (1, 2, [0.0, 0.0, 1.0])
    """

    origin: Float[np.ndarray, "bundle ray 3"]
    direction: Float[np.ndarray, "bundle ray 3"]

    __repr__ = brief

    def __post_init__(self) -> None:
        has_shape(self.direction, self.origin.shape, "directions of the rays")
        finite(self.origin, "the coordinate of a ray", unit="m")
        finite(self.direction, "the direction of a ray")
        given = self.valid[..., None]
        direction = unit(np.where(given, self.direction, 1)) * given
        object.__setattr__(self, "direction", direction)

    def __len__(self) -> int:
        return len(self.origin)

    @property
    def rays(self) -> int:
        """Number of rays of each bundle."""
        return int(self.origin.shape[1])

    @property
    def valid(self) -> Bool[np.ndarray, "bundle ray"]:
        """Mask of the rays whose direction is not zero."""
        return np.asarray(self.direction.any(axis=-1))

    @property
    def position(self) -> Vector:
        """Mean of the origins of valid rays [m]."""
        own = self.origin[self.valid]
        return np.asarray(own.mean(axis=0)) if len(own) else np.zeros(3)

    def scaled(self, factor: float) -> "RayBundles":
        """Return the bundles with all lengths multiplied."""
        return replace(self, origin=self.origin * factor)

    def select(self, part: slice) -> "RayBundles":
        """Return some of the bundles."""
        return RayBundles(self.origin[part], self.direction[part])
