"""Colour of pictures: from CIE XYZ, or from other primaries, to Radiance's RGB.

Radiance's primaries are those of an old monitor with an equal-energy white (color.h).
Another white is adapted by von Kries' rule in the sharpened space of Süsstrunk, Holm
and Finlayson, "Chromatic adaptation performance of different RGB sensors", Proc. SPIE
4300 (2001), as Radiance does.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError

_SHARP = np.array(
    [
        [1.2694, -0.0988, -0.1706],
        [-0.8364, 1.8006, 0.0357],
        [0.0297, -0.0315, 1.0018],
    ]
)


@dataclass(frozen=True)
class Primaries:
    """Chromaticities x, y of red, green, blue and white.

    Raises
    ------
    InputError : they span no colour space
    """

    red: tuple[float, float]
    green: tuple[float, float]
    blue: tuple[float, float]
    white: tuple[float, float]

    def __post_init__(self) -> None:
        points = np.array([self.red, self.green, self.blue, self.white])
        if not np.isfinite(points).all() or (points[3] <= 0).any():
            raise InputError("a white point of the primaries is not positive")
        corners = np.column_stack([points[:3], 1 - points[:3].sum(axis=1)])
        if np.linalg.cond(corners) > 1e6 or not self._scale().all():
            raise InputError("the primaries span no colour space; a triangle expected")

    def _corners(self) -> Float[np.ndarray, "3 3"]:
        xy = np.array([self.red, self.green, self.blue], dtype=float)
        return np.column_stack([xy, 1 - xy.sum(axis=1)]).T

    def _scale(self) -> Float[np.ndarray, "3"]:
        # How much of each primary makes white with Y = 1
        scale: np.ndarray = np.linalg.solve(self._corners(), xyz_of(self.white))
        return scale

    def to_xyz(self) -> Float[np.ndarray, "3 3"]:
        """Matrix from red, green, blue to XYZ in which white has Y = 1."""
        matrix: np.ndarray = self._corners() * self._scale()
        return matrix


def xyz_of(white: tuple[float, float]) -> Float[np.ndarray, "3"]:
    """XYZ of a chromaticity with Y = 1."""
    x, y = white
    return np.array([x / y, 1.0, (1 - x - y) / y])


def adaptation(
    source: tuple[float, float], target: tuple[float, float]
) -> Float[np.ndarray, "3 3"]:
    """Matrix in XYZ that takes one white point to another."""
    ratio = (_SHARP @ xyz_of(target)) / (_SHARP @ xyz_of(source))
    matrix: np.ndarray = np.linalg.solve(_SHARP, ratio[:, None] * _SHARP)
    return matrix


RADIANCE = Primaries((0.640, 0.330), (0.290, 0.600), (0.150, 0.060), (1 / 3, 1 / 3))

# ITU-R BT.709 and sRGB (IEC 61966-2-1)
SRGB = Primaries((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), (0.3127, 0.3290))


def conversion(source: Primaries, target: Primaries) -> Float[np.ndarray, "3 3"]:
    """Matrix from the red, green and blue of one set of primaries to another.

    >>> (conversion(RADIANCE, RADIANCE) @ np.ones(3)).round(9).tolist()
    [1.0, 1.0, 1.0]
    """
    white = adaptation(source.white, target.white)
    matrix: np.ndarray = np.linalg.solve(target.to_xyz(), white @ source.to_xyz())
    return matrix


def xyz_to_rgb() -> Float[np.ndarray, "3 3"]:
    """Matrix from XYZ to Radiance's red, green and blue."""
    matrix: np.ndarray = np.linalg.inv(RADIANCE.to_xyz())
    return matrix
