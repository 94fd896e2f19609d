"""Colour rendering index of CIE 13.3-1995: Ra of eight test colours, and R9.

All tristimulus values are linear in the light, so light in many bands is reduced to 30
numbers, from which the indices follow. The reference is a black body below 5000 K and
daylight of CIE 15 from there on, of the same correlated colour temperature.
"""

from functools import cache
from importlib import resources
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.bands import Bands
from clerestory.spectral.band_sets import interval_integrals
from clerestory.spectral.colour_temperature import (
    black_body,
    colour_temperature,
    daylight_components,
)
from clerestory.spectral.functions import WAVELENGTH_NM, integral, spectral_function

# Colour temperature from which the reference is daylight [K]
_DAYLIGHT_FROM_K = 5000.0

# Reciprocal colour temperatures of the tabulated black bodies [1e6/K]
_MIRED = np.linspace(1e6 / 5100, 1e6 / 1000, 400)

# Number of test colours, and of those whose mean index is Ra
_COUNT, _GENERAL = 9, 8


class ColourRendering(NamedTuple):
    """General index Ra and the special index R9 of strong red."""

    general: Float[np.ndarray, "*batch"]
    red: Float[np.ndarray, "*batch"]


def rendering_weights(bands: Bands) -> Float[np.ndarray, "30 band"]:
    """Weights of light in bands in X, Y, Z of the light and of nine test colours.

    Raises
    ------
    InputError : the bands are not wavelength intervals
    """
    return np.stack([interval_integrals(one, bands) for one in _functions()])


def colour_rendering(
    tristimulus: Float[np.ndarray, " 30 *batch"],
) -> ColourRendering:
    """Colour rendering indices from the products of `rendering_weights` and light.

    NaN in the dark and where the colour temperature is not defined. CIE 13.3 applies to
    white light; 5.4·10⁻³ is its limit of the distance Duv from the reference.

    Examples
    --------
    >>> from clerestory.spectral.band_sets import band_set, light_in_bands
    >>> from clerestory.spectral.colour_temperature import daylight_spectrum
    >>> bands = band_set("81")
    >>> light = light_in_bands(daylight_spectrum(6504.0), bands)
    >>> round(float(colour_rendering(rendering_weights(bands) @ light).general), 1)
    100.0
    """
    xyz = np.asarray(tristimulus, dtype=float).reshape(30, -1)
    kelvin = colour_temperature(xyz[:3]).kelvin
    known = np.isfinite(kelvin)
    found = np.full((_COUNT, xyz.shape[1]), np.nan)
    if known.any():
        light, reference = xyz[:, known], _reference(kelvin[known])
        found[:, known] = 100 - 4.6 * _differences(light, reference)
    shape = tristimulus.shape[1:]
    general = found[:_GENERAL].mean(axis=0).reshape(shape)
    return ColourRendering(general, found[_COUNT - 1].reshape(shape))


def _differences(
    light: Float[np.ndarray, "30 point"], reference: Float[np.ndarray, "30 point"]
) -> Float[np.ndarray, "colour point"]:
    # Colour difference of each test colour in CIE 1964 U*V*W*, after adaptation by von
    # Kries (CIE 13.3, equations 5 to 8)
    (u_k, v_k), (u_r, v_r) = _uv(light[:3]), _uv(reference[:3])
    c_r, d_r = _adaptation(u_r, v_r)
    c_k, d_k = _adaptation(u_k, v_k)
    first, second = c_r / c_k, d_r / d_k
    total = np.zeros((_COUNT, light.shape[1]))
    for k in range(_COUNT):
        rows = slice(3 * k + 3, 3 * k + 6)
        u, v = _uv(light[rows])
        c, d = _adaptation(u, v)
        below = 16.518 + 1.481 * first * c - second * d
        adapted = (10.872 + 0.404 * first * c - 4 * second * d) / below, 5.520 / below
        one = _uvw(light[rows][1] / light[1], *adapted, u_r, v_r)
        own = _uv(reference[rows])
        other = _uvw(reference[rows][1] / reference[1], *own, u_r, v_r)
        total[k] = np.sqrt(np.square(one - other).sum(axis=0))
    return total


def _uvw(
    share: np.ndarray, u: np.ndarray, v: np.ndarray, u_r: np.ndarray, v_r: np.ndarray
) -> Float[np.ndarray, "3 point"]:
    lightness = 25 * np.cbrt(100 * share) - 17
    return np.stack([13 * lightness * (u - u_r), 13 * lightness * (v - v_r), lightness])


def _adaptation(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return (4 - u - 10 * v) / v, (1.708 * v + 0.404 - 1.481 * u) / v


def _uv(xyz: Float[np.ndarray, "3 point"]) -> tuple[np.ndarray, np.ndarray]:
    x, y, z = xyz
    total = x + 15 * y + 3 * z
    return 4 * x / total, 6 * y / total


def _reference(kelvin: Float[np.ndarray, " point"]) -> Float[np.ndarray, "30 point"]:
    # Tristimulus values of the reference light and of the test colours under it
    bodies = _black_bodies()
    place = np.interp(1e6 / kelvin, _MIRED, np.arange(len(_MIRED)))
    at = np.minimum(place.astype(int), len(_MIRED) - 2)
    share = place - at
    warm = bodies[:, at] * (1 - share) + bodies[:, at + 1] * share
    cold = _daylight() @ daylight_components(kelvin)
    return np.asarray(np.where(kelvin < _DAYLIGHT_FROM_K, warm, cold))


@cache
def _functions() -> Float[np.ndarray, "30 wavelength"]:
    # Colour-matching functions, alone and times the nine radiance factors
    file = resources.files("clerestory.spectral") / "data" / "test_colours.csv"
    lines = file.read_text(encoding="utf-8").splitlines()
    rows = [line.split(",") for line in lines if not line.startswith("#")][1:]
    table = np.array(rows, dtype=float)
    matching = np.stack([spectral_function(name) for name in "xyz"])
    factors = [np.interp(WAVELENGTH_NM, table[:, 0], one) for one in table[:, 1:].T]
    return np.concatenate([matching, *(matching * one for one in factors)])


@cache
def _black_bodies() -> Float[np.ndarray, "30 temperature"]:
    power = black_body(1e6 / _MIRED)
    table = np.stack([integral(power * one) for one in _functions()])
    return np.asarray(table / table[1])


@cache
def _daylight() -> Float[np.ndarray, "30 3"]:
    parts = [spectral_function(f"s{number}") for number in range(3)]
    return np.array([[integral(part * one) for part in parts] for one in _functions()])
