"""Transmittances and reflectances of both sides of a sheet or a stack."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.bsdf.scattering_function import FUNCTIONS, Function, Side


@final
@dataclass(frozen=True, eq=False)
class Optics:
    """Transmittances and reflectances as arrays of equal shape.

    Attributes
    ----------
    transmission_front, transmission_back, reflection_front, reflection_back : fractions
        of the flux incident on the named side; the front is the outdoor side

    Examples
    --------
    >>> round(Optics.alike(0.8, 0.1).absorption("front").item(), 12)
    0.1
    """

    transmission_front: Float[np.ndarray, "*batch"]
    transmission_back: Float[np.ndarray, "*batch"]
    reflection_front: Float[np.ndarray, "*batch"]
    reflection_back: Float[np.ndarray, "*batch"]

    @classmethod
    def alike(cls, transmission: float, reflection: float) -> "Optics":
        """Return optics with equal values on both sides."""
        t, r = np.array(float(transmission)), np.array(float(reflection))
        return cls(t, t, r, r)

    @classmethod
    def gather(cls, part: Callable[[Function], Values]) -> "Optics":
        """Return optics with each property computed by `part` from its name."""
        return cls(**{name: part(name) for name in FUNCTIONS})

    def of(self, name: Function) -> Values:
        """Return one of the four properties by its name."""
        return np.asarray(getattr(self, name))

    def map(
        self, change: Callable[[Float[np.ndarray, "*batch"]], Float[np.ndarray, "*new"]]
    ) -> "Optics":
        """Return the four properties, each transformed by the same function."""
        return Optics.gather(lambda name: change(self.of(name)))

    def swapped(self) -> "Optics":
        """Return the same sheet seen from the other side."""
        return Optics(
            self.transmission_back,
            self.transmission_front,
            self.reflection_back,
            self.reflection_front,
        )

    def absorption(self, side: Side) -> Values:
        """Absorptance: fraction that is neither transmitted nor reflected."""
        if side == "front":
            return np.asarray(1 - self.transmission_front - self.reflection_front)
        return np.asarray(1 - self.transmission_back - self.reflection_back)
