"""Patterns: multipliers of radiance that vary with direction and position.

Patterns correspond to Radiance's brightfunc and brightdata. The arguments depend on the
emitter; directions and normals are unit vectors:

- surface of the scene: `direction` points from the surface to the viewer; `normal` is
  the surface normal, and `point` the point on the surface [m];
- source at infinity (sky, sun, ground): `direction` points to the source; `normal` and
  `point` are None.

The rendering engine tabulates patterns over directions, and over points if necessary.
"""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from clerestory.array_types import RayVectors


@runtime_checkable
class Pattern(Protocol):
    """A multiplier of radiance that varies with direction, normal and point."""

    @property
    def needs_normal(self) -> bool:
        """Whether the multiplier depends on the surface normal."""

    @property
    def needs_point(self) -> bool:
        """Whether the multiplier depends on the point of emission."""

    @property
    def grey(self) -> bool:
        """Whether the multiplier is the same in all bands."""

    def value(
        self,
        direction: RayVectors,
        normal: RayVectors | None = None,
        point: RayVectors | None = None,
    ) -> RayVectors:
        """Return the multipliers of red, green and blue radiance, 0 or more."""


@dataclass(frozen=True, eq=False)
class Product:
    """A product of patterns."""

    factors: tuple[Pattern, ...]

    @property
    def needs_normal(self) -> bool:
        """Whether one of the patterns depends on the surface normal."""
        return any(factor.needs_normal for factor in self.factors)

    @property
    def needs_point(self) -> bool:
        """Whether one of the patterns depends on the point of emission."""
        return any(factor.needs_point for factor in self.factors)

    @property
    def grey(self) -> bool:
        """Whether each pattern is the same in all bands."""
        return all(factor.grey for factor in self.factors)

    def value(
        self,
        direction: RayVectors,
        normal: RayVectors | None = None,
        point: RayVectors | None = None,
    ) -> RayVectors:
        """Return the product of the multipliers; see `Pattern.value`."""
        product = np.ones(direction.shape)
        for factor in self.factors:
            product = product * factor.value(direction, normal, point)
        return product
