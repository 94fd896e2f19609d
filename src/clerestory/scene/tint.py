"""Spectra that multiply the colour of a material, as Radiance's spectrum and specfile.

A scene is read before its bands are known. A tinted material has the RGB colour of the
product, and its tint keeps the colour and the spectra, so that `scene.band_conversion`
finds the values in bands.

Reference: "The RADIANCE 6.0 Synthetic Imaging System" (ray.html), section 2.1.4.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Float

from clerestory.bands import RGB, Bands
from clerestory.scene.material import (
    Colour,
    Material,
    altered,
    colour_fields,
)
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import (
    WHITE,
    band_means,
    light_in_bands,
    wavelength_bands,
)
from clerestory.spectral.functions import STEP_NM, WAVELENGTH_NM, spectral_function

# Chromaticities of the primaries and of white in Radiance's RGB (color.h)
_PRIMARIES, _WHITE = ((0.640, 0.330), (0.290, 0.600), (0.150, 0.060)), (1 / 3, 1 / 3)

# Distance between the wavelengths of both sides of a step [nm]
_STEP = 1e-6

# Intervals of 1 nm around the wavelengths of the colour-matching functions
_NANOMETRES = wavelength_bands(np.append(WAVELENGTH_NM, 781.0) - 0.5)


@dataclass(frozen=True, eq=False)
class Tint:
    """Spectra by which a colour is multiplied, and the colour without them."""

    plain: Colour
    spectra: tuple[Spectrum, ...]

    def values(self, bands: Bands, *, light: bool = False) -> Colour:
        """Product of the means of the spectra in bands; without the plain colour.

        The means are those of a material, or those of `light` that is emitted.
        """
        product = np.ones(len(bands))
        for spectrum in self.spectra:
            product = product * _means(spectrum, bands, light=light)
        return product

    def spectrum(self) -> Spectrum:
        """Product of the spectra, every nanometre."""
        each = [one.at(WAVELENGTH_NM) for one in self.spectra]
        return Spectrum(WAVELENGTH_NM, np.prod(each, axis=0))


def tinted(material: Material, spectra: tuple[Spectrum, ...]) -> Material | None:
    """Return a material whose colour is multiplied by spectra; None if not possible."""
    if not spectra:
        return material
    if not hasattr(material, "tint"):
        return None
    [name] = colour_fields(material)
    old = material.tint
    plain = getattr(material, name) if old is None else old.plain
    both = spectra if old is None else spectra + old.spectra
    shown = plain * np.prod([rgb_colour(one) for one in both], axis=0)
    return altered(material, **{name: shown, "tint": Tint(plain, both)})


def stepped(
    first_nm: float, last_nm: float, values: Float[np.ndarray, " value"]
) -> Spectrum:
    """Return a spectrum that is constant around equally spaced wavelengths [nm].

    Radiance takes each value up to the middle between two wavelengths, and as far
    beyond the first and the last one; farther out the spectrum is zero.

    Examples
    --------
    >>> coarse = stepped(500.0, 400.0, np.array([0.2, 0.3, 0.6]))
    >>> coarse.at(np.array([370.0, 400.0, 420.0, 430.0, 520.0])).tolist()
    [0.0, 0.6, 0.6, 0.3, 0.2]
    """
    known = np.linspace(first_nm, last_nm, len(values))
    if first_nm > last_nm:
        known, values = known[::-1], values[::-1]
    half = (known[1] - known[0]) / 2
    edges = np.append(known - half, known[-1] + half)
    ends = np.stack([edges[:-1] + _STEP / 2, edges[1:] - _STEP / 2], axis=1)
    low, high = edges[0] - _STEP, edges[-1] + _STEP
    return Spectrum(
        np.concatenate([[low], ends.ravel(), [high]]),
        np.concatenate([[0.0], np.repeat(values, 2), [0.0]]),
    )


def rgb_colour(spectrum: Spectrum) -> Float[np.ndarray, " 3"]:
    """Return the RGB colour of a spectrum under equal-energy white.

    Colours outside Radiance's RGB are desaturated at the same luminance.

    Examples
    --------
    >>> rgb_colour(stepped(380.0, 780.0, np.full(5, 0.4))).round(3).tolist()
    [0.4, 0.4, 0.4]
    """
    values = band_means(spectrum, _NANOMETRES)
    rgb = _rgb_matrix() @ values
    luminance = RGB.photometric(rgb) / RGB.weights.sum()
    most = max(1.0, float(values.max()))
    share = min(
        1.0,
        *(_fraction(float(x), luminance, 0.0 if x < 0 else most) for x in rgb),
    )
    return np.asarray(np.maximum(luminance + share * (rgb - luminance), 0.0))


def _fraction(value: float, grey: float, limit: float) -> float:
    # How far a channel may move from grey towards its value until the limit
    beyond = value < 0 or value > limit
    return (limit - grey) / (value - grey) if beyond and value != grey else 1.0


@cache
def _rgb_matrix() -> Float[np.ndarray, "3 wavelength"]:
    # From values at every nanometre to RGB, white in RGB for equal-energy white
    columns = np.array([[x / y, 1.0, (1 - x - y) / y] for x, y in _PRIMARIES]).T
    x, y = _WHITE
    white = np.array([x / y, 1.0, (1 - x - y) / y])
    columns = columns * np.linalg.solve(columns, white)
    matching = np.stack([spectral_function(name) * STEP_NM for name in "xyz"])
    matrix = np.linalg.solve(columns, matching / matching[1].sum())
    return np.asarray(matrix / matrix.sum(axis=1, keepdims=True))


def _means(spectrum: Spectrum, bands: Bands, *, light: bool) -> Colour:
    if light and bands.limits_nm is None:
        return light_in_bands(WHITE * band_means(spectrum, _NANOMETRES), bands)
    return band_means(spectrum, bands)


def without_tint(material: Material) -> Material:
    """Return a material that keeps its colour but not the spectra of its tint."""
    tint = getattr(material, "tint", None)
    return material if tint is None else altered(material, tint=None)
