"""Sky luminance distributions: relative luminance as a function of direction.

The Perez sky and the fifteen CIE general skies are the product of a gradation from
horizon to zenith and an indicatrix around the sun:

    L ∝ (1 + a exp(b / cos ζ)) (base + c exp(d γ) + e cos² γ)

with the angles ζ to the zenith and γ to the sun. The CIE traditional overcast sky and
the intermediate sky have other formulas.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from clerestory.array_types import Directions, Values, Vector
from clerestory.checks import require

# Smallest cos ζ, since b / cos ζ is infinite at the horizon
_LOWEST_COSINE = 1e-3


# Relative luminance as a function of sky directions and the direction to the sun
Distribution = Callable[[Directions, Vector], Values]


@dataclass(frozen=True, eq=False)
class FiveParameters:
    """Luminance distribution of the Perez sky and the CIE general skies.

    a and b define the gradation from horizon to zenith; c, d, e and base define the
    indicatrix around the sun, or around the direction `centre` if it is given.
    """

    a: float
    b: float
    c: float
    d: float
    e: float
    base: float = 1.0
    centre: Vector | None = None

    def __call__(self, direction: Directions, sun: Vector) -> Values:
        """Return the relative luminance of the given directions, clipped at 0."""
        cos_zeta = np.maximum(direction[..., 2], _LOWEST_COSINE)
        centre = sun if self.centre is None else self.centre
        cos_gamma = np.clip(direction @ centre, -1, 1)
        gradation = 1 + self.a * np.exp(self.b / cos_zeta)
        glow = self.c * np.exp(self.d * np.arccos(cos_gamma))
        indicatrix = self.base + glow + self.e * cos_gamma**2
        return np.asarray(np.maximum(gradation * indicatrix, 0))


def overcast(direction: Directions, sun: Vector) -> Values:
    """Luminance of the CIE traditional overcast sky, relative to the zenith luminance.

    L ∝ 1 + 2 cos ζ. Reference: P. Moon, D. E. Spencer, Illumination from a non-uniform
    sky, 1942.
    """
    return np.asarray((1 + 2 * direction[..., 2]) / 3)


def intermediate(direction: Directions, sun: Vector) -> Values:
    """Relative luminance of the CIE intermediate sky, as in gensky.

    Reference: J. Matsuura, T. Iwata, A model of daylight source for the daylight
    illuminance calculations on the all weather conditions, 1990.
    """
    zeta = np.arccos(np.clip(direction[..., 2], 0, 1))
    gamma = np.arccos(np.clip(direction @ sun, -1, 1))
    zenith = np.arccos(np.clip(sun[2], 0, 1))
    level = (1.35 * np.sin(5.631 - 3.59 * zeta) + 3.12) * np.sin(4.396 - 2.6 * zenith)
    level = (level + 6.37 - zeta) / 2.326
    fall = -0.563 * ((2.629 - zeta) * (1.562 - zenith) + 0.812)
    return np.asarray(level * np.exp(gamma * fall))


# ISO 15469 / CIE S 011, table 1: parameters a, b of the gradations I…VI and c, d, e of
# the indicatrices 1…6; each of the fifteen skies is a pair of them
_GRADATION = (
    (4.0, -0.7),
    (1.1, -0.8),
    (0.0, -1.0),
    (-1.0, -0.55),
    (-1.0, -0.32),
    (-1.0, -0.15),
)
_INDICATRIX = (
    (0.0, -1.0, 0.0),
    (2.0, -1.5, 0.15),
    (5.0, -2.5, 0.30),
    (10.0, -3.0, 0.45),
    (16.0, -3.0, 0.30),
    (24.0, -2.8, 0.15),
)
_TYPES = (
    (1, 1), (1, 2), (2, 1), (2, 2), (3, 1), (3, 2), (3, 3), (3, 4),
    (4, 2), (4, 3), (4, 4), (5, 4), (5, 5), (6, 5), (6, 6),
)  # fmt: skip


def cie_general(number: int) -> FiveParameters:
    """Return one of the fifteen CIE general skies by number.

    Sky 1 is overcast with steep gradation, 5 uniform, 12 clear with low turbidity.

    Reference: ISO 15469:2004 / CIE S 011, Spatial distribution of daylight.
    """
    require(
        number in range(1, 16),
        f"CIE general sky {number!r}; a number from 1 to 15 expected",
    )
    gradation, indicatrix = _TYPES[number - 1]
    a, b = _GRADATION[gradation - 1]
    c, d, e = _INDICATRIX[indicatrix - 1]
    return FiveParameters(a, b, c, d, e, base=1 - c * float(np.exp(d * np.pi / 2)))


def horizontal_integral(distribution: Distribution, *, sun: Vector) -> float:
    """Integral of relative luminance times cos ζ over the sky hemisphere [sr].

    Computed by Gauss–Legendre quadrature in sin² ζ and the midpoint rule in azimuth.
    """
    node, weight = np.polynomial.legendre.leggauss(96)
    sine = np.sqrt((node + 1) / 2)
    azimuth = (np.arange(360) + 0.5) * np.pi / 180
    across, along = np.outer(sine, np.sin(azimuth)), np.outer(sine, np.cos(azimuth))
    up = np.broadcast_to(np.sqrt(1 - sine**2)[:, None], across.shape)
    direction = np.stack([across, along, up], axis=-1)
    return float(np.pi / 2 * np.sum(weight * distribution(direction, sun).mean(axis=1)))
