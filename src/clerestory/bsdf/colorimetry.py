"""Conversion between CIE XYZ of BSDF files and Radiance RGB."""

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Points2

# Chromaticities x, y of Radiance's red, green, blue and white (Radiance color.h).
_PRIMARIES = np.array([[0.640, 0.330], [0.290, 0.600], [0.150, 0.060]])
_WHITE = np.array([1 / 3, 1 / 3])


def _xyz(chromaticity: Points2) -> Directions:
    # Tristimulus values of unit luminance
    x, y = np.moveaxis(chromaticity, -1, 0)
    return np.stack([x / y, np.ones_like(y), (1 - x - y) / y], axis=-1)


def rgb_to_xyz() -> Float[np.ndarray, "3 3"]:
    """Matrix from Radiance RGB to XYZ; equal RGB values are white."""
    primaries = _xyz(_PRIMARIES).T
    return primaries * np.linalg.solve(primaries, _xyz(_WHITE))


def rgb_from_xyz(
    xyz: Float[np.ndarray, "3 row column"],
) -> Float[np.ndarray, "3 row column"]:
    """RGB in the primaries of Radiance; colours outside the gamut are desaturated.

    >>> rgb_from_xyz(np.full((3, 1, 1), 0.5)).ravel().round(6).tolist()
    [0.5, 0.5, 0.5]
    """
    rgb = np.tensordot(np.linalg.inv(rgb_to_xyz()), xyz, axes=1)

    # Desaturate at constant luminance until no primary is negative
    luminance, least = xyz[1], rgb.min(axis=0)
    share = np.divide(
        luminance, luminance - least, out=np.ones_like(least), where=least < 0
    )
    inside: Float[np.ndarray, "3 row column"] = np.maximum(
        luminance + share * (rgb - luminance), 0
    )
    return inside
