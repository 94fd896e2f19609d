"""Transmittances and reflectances of both sides of a sheet or a stack."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.brief_repr import brief
from clerestory.bsdf.scattering_function import FUNCTIONS, OF_SIDE, Function, Side


@final
@dataclass(frozen=True, eq=False)
class Optics:
    """Transmittances and reflectances as arrays of equal shape.

    They are fractions of the flux that is incident on the named side; the front is the
    outdoor side.
    """

    transmission_front: Float[np.ndarray, "*batch"]
    transmission_back: Float[np.ndarray, "*batch"]
    reflection_front: Float[np.ndarray, "*batch"]
    reflection_back: Float[np.ndarray, "*batch"]

    __repr__ = brief

    @classmethod
    def alike(cls, transmission: float, reflection: float) -> "Optics":
        """Return optics with equal values on both sides."""
        t, r = np.array(float(transmission)), np.array(float(reflection))
        return cls(t, t, r, r)

    @classmethod
    def gather(cls, part: Callable[[Function], Values]) -> "Optics":
        """Return optics whose transmittances and reflectances are `part(name)`."""
        return cls(**{name: part(name) for name in FUNCTIONS})

    def of(self, name: Function) -> Values:
        """Return the transmittance or reflectance with a given name."""
        return np.asarray(getattr(self, name))

    def map(
        self, change: Callable[[Float[np.ndarray, "*batch"]], Float[np.ndarray, "*new"]]
    ) -> "Optics":
        """Return transmittances and reflectances, each transformed by a function."""
        return Optics.gather(lambda name: change(self.of(name)))

    def plus(self, other: "Optics") -> "Optics":
        """Return optics with the transmittances and reflectances of `other` added."""
        return Optics.gather(lambda name: self.of(name) + other.of(name))

    def averaged(self, weight: Values) -> "Optics":
        """Return weighted sums of transmittances and reflectances over axis 0."""
        return self.map(lambda share: np.asarray(np.tensordot(weight, share, axes=1)))

    def swapped(self) -> "Optics":
        """Return the same sheet seen from the other side."""
        return Optics(
            self.transmission_back,
            self.transmission_front,
            self.reflection_back,
            self.reflection_front,
        )

    def absorption(self, side: Side) -> Values:
        """Absorptance of flux incident on one side: 1 − transmittance − reflectance."""
        passed, reflected = (self.of(name) for name in OF_SIDE[side])
        return np.asarray(1 - passed - reflected)
