"""Correlated colour temperature of light, and spectra of daylight.

The correlated colour temperature is that of the black body whose chromaticity is
nearest in CIE 1960 (u, v); Duv is the distance, positive above the Planckian locus. See
Y. Ohno, "Practical use and calculation of CCT and Duv", Leukos 10 (2014). Daylight is
the sum of the components S0, S1 and S2 of CIE 15:2018.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from clerestory.bands import Bands
from clerestory.checks import within
from clerestory.spectral.band_sets import interval_integrals
from clerestory.spectral.functions import (
    MAXIMUM_EFFICACY,
    WAVELENGTH_NM,
    integral,
    spectral_function,
)

# Second radiation constant [nm·K] (CODATA 2018)
_C2 = 1.438776877e7

# Range of correlated colour temperatures that are computed [K]
_LOWEST_K, _HIGHEST_K = 1000.0, 100_000.0

# Range of colour temperatures of daylight (CIE 15:2018) [K]
DAYLIGHT_K = (4000.0, 25_000.0)

# Polynomials of 1000/T for x of daylight, below and above 7000 K (CIE 15:2018)
_BELOW_7000 = (0.244063, 0.09911, 2.9678, -4.6070)
_ABOVE_7000 = (0.237040, 0.24748, 1.9018, -2.0064)


class ColourTemperature(NamedTuple):
    """Correlated colour temperature [K] and distance Duv from the Planckian locus."""

    kelvin: Float[np.ndarray, "*batch"]
    duv: Float[np.ndarray, "*batch"]


def tristimulus(
    values: Float[np.ndarray, " band *batch"], bands: Bands
) -> Float[np.ndarray, " 3 *batch"]:
    """Relative tristimulus values X, Y, Z of light in narrow wavelength intervals.

    Raises
    ------
    InputError : the bands are not wavelength intervals
    """
    tables = [spectral_function(name) for name in "xyz"]
    weights = np.stack([interval_integrals(table, bands) for table in tables])
    return np.tensordot(weights, values, axes=1)


def colour_temperature(xyz: Float[np.ndarray, " 3 *batch"]) -> ColourTemperature:
    """Correlated colour temperature [K] and Duv from tristimulus values.

    Both are NaN for black, and where the colour is farther than 0.05 from the locus,
    for which the colour temperature is not defined (CIE 15:2018).

    Examples
    --------
    >>> a = [1.09850, 1.0, 0.35585]  # illuminant A
    >>> found = colour_temperature(np.array(a))
    >>> round(float(found.kelvin)), abs(round(float(found.duv), 4))
    (2855, 0.0)
    """
    x, y, z = xyz
    total = x + 15 * y + 3 * z
    lit = total > 0
    safe = np.where(lit, total, 1.0)
    point = np.stack([4 * x / safe, 6 * y / safe])
    mired, locus = _locus()
    flat = point.reshape(2, -1)
    _, nearest = _tree().query(flat.T)
    nearest = np.clip(nearest, 1, len(mired) - 2)
    found, distance = _between(flat, mired, locus, nearest)
    found, distance = found.reshape(x.shape), distance.reshape(x.shape)
    undefined = ~lit | (np.abs(distance) > 0.05)
    kelvin = np.where(undefined, np.nan, 1e6 / found)
    return ColourTemperature(kelvin, np.where(undefined, np.nan, distance))


def _between(
    point: np.ndarray, mired: np.ndarray, locus: np.ndarray, at: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    # Foot of the perpendicular on the parabola through three points of the locus,
    # expressed by the reciprocal temperature, and the signed distance
    before, middle, after = locus[:, at - 1], locus[:, at], locus[:, at + 1]
    slope, bend = (after - before) / 2, (after + before) / 2 - middle
    t = np.zeros(at.shape)
    for _ in range(4):
        offset = middle + slope * t + bend * t * t - point
        speed = slope + 2 * bend * t
        gradient = (offset * speed).sum(axis=0)
        curvature = (speed * speed + 2 * bend * offset).sum(axis=0)
        t = np.clip(t - gradient / curvature, -1.0, 1.0)
    offset = point - (middle + slope * t + bend * t * t)
    distance = np.sqrt(np.square(offset).sum(axis=0))
    step = mired[1] - mired[0]
    return mired[at] + t * step, np.where(offset[1] >= 0, distance, -distance)


@cache
def _locus() -> tuple[np.ndarray, np.ndarray]:
    # Reciprocal temperatures [1e6/K] and (u, v) of black bodies
    mired = np.linspace(1e6 / _HIGHEST_K, 1e6 / _LOWEST_K, 1981)
    power = black_body(1e6 / mired)
    x, y, z = (integral(power * spectral_function(name)) for name in "xyz")
    total = x + 15 * y + 3 * z
    return mired, np.stack([4 * x / total, 6 * y / total])


@cache
def _tree() -> cKDTree:
    return cKDTree(_locus()[1].T)


def black_body(
    kelvin: Float[np.ndarray, " temperature"],
) -> Float[np.ndarray, "temperature wavelength"]:
    """Relative spectral power of black bodies, at `WAVELENGTH_NM`.

    >>> warm = black_body(np.array([2856.0]))[0]
    >>> round(float(warm[180] / warm[70]), 2)  # 560 nm over 450 nm
    3.02
    """
    exponent = _C2 / (kelvin[:, None] * WAVELENGTH_NM)
    return np.asarray(1 / (WAVELENGTH_NM**5 * np.expm1(exponent)))


def daylight_components(
    kelvin: Float[np.ndarray, "*batch"],
) -> Float[np.ndarray, " 3 *batch"]:
    """Factors of S0, S1 and S2 of daylight with a luminance of 1 cd/m².

    The spectral radiance in W/(m²·sr·nm) is the sum of factors times the functions
    "s0", "s1" and "s2". Colour temperatures are limited to 4000 to 25000 K, where the
    method of CIE 15:2018 is defined.

    Examples
    --------
    >>> factors = daylight_components(np.array(6504.0))
    >>> (factors / factors[0]).round(3).tolist()  # D65: M1 and M2
    [1.0, -0.294, -0.689]
    """
    reciprocal = 1000 / np.clip(kelvin, *DAYLIGHT_K)
    low, high = (
        np.polynomial.polynomial.polyval(reciprocal, table)
        for table in (_BELOW_7000, _ABOVE_7000)
    )
    x = np.where(reciprocal >= 1 / 7, low, high)
    y = -3.000 * x * x + 2.870 * x - 0.275
    scale = 0.0241 + 0.2562 * x - 0.7341 * y
    first = (-1.3515 - 1.7703 * x + 5.9114 * y) / scale
    second = (0.0300 - 31.4424 * x + 30.0717 * y) / scale
    factors = np.stack([np.ones_like(first), first, second])
    lumen = [integral(_component(k) * spectral_function("y")) for k in range(3)]
    return factors / (MAXIMUM_EFFICACY * np.tensordot(lumen, factors, axes=1))


def daylight_spectrum(kelvin: float) -> Float[np.ndarray, " wavelength"]:
    """Spectral radiance of daylight of 1 cd/m² [W/(m²·sr·nm)], at `WAVELENGTH_NM`.

    Raises
    ------
    InputError : the colour temperature is outside 4000 to 25000 K
    """
    least, most = DAYLIGHT_K
    within(kelvin, "colour temperature of daylight", least=least, most=most, unit="K")
    factors = daylight_components(np.array(kelvin))
    return np.asarray(sum(factors[k] * _component(k) for k in range(3)))


def _component(number: int) -> Float[np.ndarray, " wavelength"]:
    return spectral_function(f"s{number}")
