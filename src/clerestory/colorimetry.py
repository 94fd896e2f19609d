"""Colorimetry: the CIE 1931 observer, RGB primaries and chromatic adaptation.

The white point of Radiance's primaries is equal-energy white (color.h). Other white
points are adapted by the von Kries transform in the sharpened space of Süsstrunk, Holm
and Finlayson, "Chromatic adaptation performance of different RGB sensors", Proc. SPIE
4300 (2001).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.checks import finite, positive, require
from clerestory.spectral.functions import WAVELENGTH_NM, spectral_function

# CIE 1931 colour-matching functions x, y, z every 10 nm
OBSERVER_NM = WAVELENGTH_NM[::10]
OBSERVER: Float[np.ndarray, "3 wavelength"] = np.stack(
    [spectral_function(name)[::10] for name in "xyz"]
)

_SHARP = np.array(
    [
        [1.2694, -0.0988, -0.1706],
        [-0.8364, 1.8006, 0.0357],
        [0.0297, -0.0315, 1.0018],
    ]
)


@dataclass(frozen=True)
class Primaries:
    """Chromaticities x, y of red, green, blue and white."""

    red: tuple[float, float]
    green: tuple[float, float]
    blue: tuple[float, float]
    white: tuple[float, float]

    def __post_init__(self) -> None:
        points = np.array([self.red, self.green, self.blue, self.white])
        finite(points, "a chromaticity")
        positive(self.white, "the chromaticity of the white point")
        require(
            np.linalg.cond(self._corners()) <= 1e6 and self._scale().all(),
            "the chromaticities of the primaries lie on a line; a triangle expected",
        )

    def _corners(self) -> Float[np.ndarray, "3 3"]:
        xy = np.array([self.red, self.green, self.blue], dtype=float)
        return np.column_stack([xy, 1 - xy.sum(axis=1)]).T

    def _scale(self) -> Float[np.ndarray, "3"]:
        # Amounts of the primaries that add up to white with Y = 1
        return np.asarray(np.linalg.solve(self._corners(), xyz_of(self.white)))

    def to_xyz(self) -> Float[np.ndarray, "3 3"]:
        """Matrix from RGB to XYZ; white (1, 1, 1) has Y = 1."""
        return np.asarray(self._corners() * self._scale())


def xyz_of(white: tuple[float, float]) -> Float[np.ndarray, "3"]:
    """XYZ of a white point given by its chromaticity x, y, with Y = 1."""
    x, y = white
    return np.array([x / y, 1.0, (1 - x - y) / y])


def adaptation(
    source: tuple[float, float], target: tuple[float, float]
) -> Float[np.ndarray, "3 3"]:
    """Chromatic adaptation matrix for XYZ, from one white point to another."""
    ratio = (_SHARP @ xyz_of(target)) / (_SHARP @ xyz_of(source))
    return np.asarray(np.linalg.solve(_SHARP, ratio[:, None] * _SHARP))


RADIANCE = Primaries((0.640, 0.330), (0.290, 0.600), (0.150, 0.060), (1 / 3, 1 / 3))

# ITU-R BT.709 and sRGB (IEC 61966-2-1)
SRGB = Primaries((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), (0.3127, 0.3290))


def conversion(source: Primaries, target: Primaries) -> Float[np.ndarray, "3 3"]:
    """Matrix from the RGB of one set of primaries to the RGB of another.

    >>> (conversion(RADIANCE, RADIANCE) @ np.ones(3)).round(9).tolist()
    [1.0, 1.0, 1.0]
    """
    white = adaptation(source.white, target.white)
    return np.asarray(np.linalg.solve(target.to_xyz(), white @ source.to_xyz()))


def xyz_to_rgb() -> Float[np.ndarray, "3 3"]:
    """Matrix from XYZ to Radiance's RGB."""
    return np.asarray(np.linalg.inv(RADIANCE.to_xyz()))


def rgb_from_xyz(
    xyz: Float[np.ndarray, "3 row column"],
) -> Float[np.ndarray, "3 row column"]:
    """Convert XYZ to Radiance's RGB; colours outside the gamut are desaturated.

    >>> rgb_from_xyz(np.full((3, 1, 1), 0.5)).ravel().round(6).tolist()
    [0.5, 0.5, 0.5]
    """
    rgb = np.tensordot(xyz_to_rgb(), xyz, axes=1)

    # Mix with grey of the same luminance Y until no primary is negative
    luminance, least = xyz[1], rgb.min(axis=0)
    share = np.divide(
        luminance, luminance - least, out=np.ones_like(least), where=least < 0
    )
    inside: Float[np.ndarray, "3 row column"] = np.maximum(
        luminance + share * (rgb - luminance), 0
    )
    return inside
