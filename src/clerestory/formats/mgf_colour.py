"""Colours of MGF: chromaticities, spectra and black-body temperatures.

MGF weights the colours of a mixture by luminance, so that only chromaticities are
needed. Spectra are therefore converted to chromaticities.

Reference: Planck's law with c₂ = 1.4388 cm·K.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.checks import not_negative, positive, require
from clerestory.colorimetry import OBSERVER, OBSERVER_NM, rgb_from_xyz

_SECOND_RADIATION_CONSTANT = 1.4388e-2  # Constant c₂ of Planck's law [m·K]
_COOLEST = 1000.0

_MOST_SAMPLES = 10_000


class Chromaticity(NamedTuple):
    """CIE 1931 chromaticity coordinates x and y."""

    x: float
    y: float


GREY = Chromaticity(1 / 3, 1 / 3)


def chromaticity(x: float, y: float) -> Chromaticity:
    """Return the chromaticity with coordinates x and y, after checking them."""
    require(
        x >= 0 and y >= 1e-4 and x + y <= 1,
        f"chromaticity {x:g}, {y:g}; x of 0 or more, y above 0, and a sum of at most 1"
        " expected",
    )
    return Chromaticity(x, y)


def from_spectrum(values: list[float]) -> Chromaticity:
    """Return the chromaticity of a spectral power distribution.

    `values`: first and last wavelength [nm], then two or more equidistant samples.
    """
    first, last, *samples = values
    require(
        2 <= len(samples) <= _MOST_SAMPLES and 0 < first < last,
        f"spectrum of {len(samples)} samples from {first:g} to {last:g} nm; two or more"
        " at increasing wavelengths expected",
    )
    known = np.linspace(first, last, len(samples))
    outside = {"left": 0.0, "right": 0.0}
    return _of_light(np.interp(OBSERVER_NM, known, samples, **outside))


def from_temperature(kelvin: float) -> Chromaticity:
    """Return the chromaticity of a black body of a temperature [K]."""
    message = f"colour temperature is {kelvin:g} K; {_COOLEST:g} K or more expected"
    require(kelvin >= _COOLEST, message)
    metres = OBSERVER_NM * 1e-9
    exponent = _SECOND_RADIATION_CONSTANT / (metres * kelvin)
    # Logarithm of the spectrum; its maximum is subtracted, to avoid overflow
    power = -5 * np.log(metres) - exponent - np.log1p(-np.exp(-exponent))
    return _of_light(np.exp(power - power.max()))


def mixed(weights: list[float], colours: list[Chromaticity]) -> Chromaticity:
    """Return the chromaticity of a mixture; `weights` are relative luminances."""
    weight = np.array(weights)
    x, y = np.array(colours).T
    total = float(np.sum(weight / y))
    not_negative(weight, "the weight of a colour")
    positive(total, "the sum of weights of colours")
    mean_x = float(np.sum(weight * x / y)) / total
    return Chromaticity(mean_x, float(weight.sum()) / total)


def rgb(colour: Chromaticity, luminance: float) -> Float[np.ndarray, "3"]:
    """Return a chromaticity with luminance Y as RGB in Radiance's primaries."""
    x, y = colour
    xyz = luminance * np.array([x / y, 1.0, (1 - x - y) / y])
    return np.asarray(rgb_from_xyz(xyz[:, None, None])[:, 0, 0])


def is_grey(colour: Chromaticity) -> bool:
    """Whether a chromaticity is nearly the equal-energy white (x = y = 1/3)."""
    return max(abs(colour.x - 1 / 3), abs(colour.y - 1 / 3)) <= 0.0103


def _of_light(power: Float[np.ndarray, " wavelength"]) -> Chromaticity:
    total = OBSERVER @ power
    visible = np.all(total >= 0) and total[1] > 0
    require(visible, "a spectrum without visible light; positive samples expected")
    x, y, _ = total / total.sum()
    return Chromaticity(float(x), float(y))
