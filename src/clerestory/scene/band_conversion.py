"""Conversion of scenes from RGB to other spectral bands."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from clerestory.array_types import Vector
from clerestory.bands import RGB, Bands
from clerestory.bsdf.spectral_channels import bsdf_in_bands
from clerestory.checks import not_negative, require, within
from clerestory.errors import InputError
from clerestory.scene.material import (
    Colour,
    Emitter,
    Material,
    altered,
    colour_fields,
    colours,
    error_at,
    parts,
    with_colours,
)
from clerestory.scene.materials.bsdf_surface import BsdfSurface
from clerestory.scene.materials.glass import Glass, transmissivity
from clerestory.scene.model import Scene
from clerestory.scene.tint import Tint, without_tint
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import band_means
from clerestory.spectral.functions import (
    WAVELENGTH_NM,
    integral,
    spectral_function,
)
from clerestory.spectral.light_colours import light_colour

# Wavelengths that separate blue, green and red (Radiance color.h: WLPART) [nm]
_GREEN_NM, _RED_NM = 480.0, 588.0

Rgb = Vector
Upsampling = Callable[[Rgb, Bands], Colour]


def in_bands(
    scene: Scene,
    bands: Bands,
    *,
    spectra: Mapping[str, Spectrum] | None = None,
    upsampling: Upsampling | None = None,
) -> Scene:
    """Return an RGB scene converted to other spectral bands.

    Grey materials have the same value in all bands. Coloured materials require a
    spectrum, or an `upsampling` such as `step_spectrum`, since RGB does not determine
    their spectrum. Spectra that are in the scene files (Radiance's spectrum, specfile,
    specfunc and specdata) multiply the values.

    Parameters
    ----------
    spectra : spectra of materials by name, in place of their colours: reflectances of
        plastic, metal, trans and mirrors, transmittances of glass at normal incidence
    upsampling : function that converts an RGB colour to values in given bands

    Raises
    ------
    InputError : a material is coloured without a spectrum, a spectrum names no material
        or one without a single colour, or values are outside 0…1
    """
    require(
        scene.bands == RGB, f"the scene is in the bands {scene.bands}; {RGB} expected"
    )
    spectra = spectra or {}
    named = {name.partition("#")[0] for name in scene.materials}
    for name in spectra:
        require(
            name in named,
            f'the scene has no material "{name}", for which a spectrum is given;'
            " the name of a material expected",
        )

    def converted(rgb: Rgb) -> Colour:
        if upsampling is None or np.ptp(rgb) == 0:
            return np.full(len(bands), rgb[0])
        return upsampling(rgb, bands)

    materials = {}
    for name, material in scene.materials.items():
        spectrum = spectra.get(name.partition("#")[0])
        if spectrum is not None:
            materials[name] = _with_spectrum(material, spectrum, bands)
            continue
        if upsampling is None:
            _require_grey(material)
        material = _in_bands(material, bands, converted)
        if isinstance(material, BsdfSurface):
            material = replace(material, bsdf=bsdf_in_bands(material.bsdf, bands))
        materials[name] = material
    return replace(scene, materials=materials, bands=bands)


def emitting(scene: Scene, spectrum: Spectrum, bands: Bands) -> Scene:
    """Return the light sources of an RGB scene in other bands, all of one spectrum.

    Their luminance is kept; the power is zero beyond the wavelengths of the spectrum.
    """
    known, given = spectrum.wavelength_nm, spectrum.value
    not_negative(given, "spectral power")
    power = np.interp(WAVELENGTH_NM, known, given, left=0, right=0)
    require(
        integral(power * spectral_function("y")) > 0,
        f"the spectrum has no visible light from {known[0]:g} to {known[-1]:g} nm;"
        " spectral power of a lamp expected",
    )
    colour = light_colour(power, bands)
    white = _with_radiance(scene, lambda rgb: np.full(3, float(RGB.shares @ rgb)))
    return _with_radiance(in_bands(white, bands), lambda level: level * colour)


def _with_radiance(scene: Scene, function: Callable[[Colour], Colour]) -> Scene:
    # Scene with changed radiance of its light sources
    materials = {
        name: altered(material, radiance=function(material.radiance))
        if isinstance(material, Emitter)
        else material
        for name, material in scene.materials.items()
    }
    return replace(scene, materials=materials)


def _in_bands(
    material: Material, bands: Bands, converted: Callable[[Rgb], Colour]
) -> Material:
    # A material and its component materials, with the spectra of their tints
    changed: dict[str, object] = {
        key: _in_bands(part, bands, converted)
        for key, part in vars(material).items()
        if isinstance(part, Material)
    }
    tint: Tint | None = getattr(material, "tint", None)
    for name in colour_fields(material):
        if tint is None:
            changed[name] = converted(getattr(material, name))
            continue
        light = isinstance(material, Emitter)
        changed[name] = converted(tint.plain) * tint.values(bands, light=light)
        changed["tint"] = None
    return altered(material, **changed)


def _with_spectrum(material: Material, spectrum: Spectrum, bands: Bands) -> Material:
    # Material whose reflectance or transmittance is a spectrum
    if not isinstance(material, Glass) and not hasattr(material, "reflectance"):
        kind = type(material).__name__
        raise error_at(
            material.source,
            f'the material "{material.name}" is of kind {kind}, for which no spectrum'
            " can be given; plastic, metal, trans, mirror or glass expected",
        )
    what = f'a value of the spectrum of "{material.name}"'
    within(spectrum.value, what, least=0, most=1)
    values = band_means(spectrum, bands)
    if isinstance(material, Glass):
        values = transmissivity(values, material.index)
    return with_colours(without_tint(material), lambda _: values)


def step_spectrum(rgb: Rgb, bands: Bands) -> Colour:
    """Return band means of a spectrum: blue up to 480 nm, green up to 588 nm, then red.

    Radiance's spectral rendering converts RGB in the same way (color.h: WLPART).

    Examples
    --------
    >>> two = Bands(("short", "long"), limits_nm=((400.0, 480.0), (480.0, 696.0)))
    >>> step_spectrum(np.array([0.6, 0.4, 0.1]), two).round(6).tolist()
    [0.1, 0.5]
    """
    if bands.limits_nm is None:
        raise InputError(
            f"the wavelengths of the bands {bands} are not known; limits expected"
        )
    red, green, blue = rgb
    limits = np.array(bands.limits_nm)
    integral = blue * limits + (green - blue) * np.maximum(limits - _GREEN_NM, 0)
    integral += (red - green) * np.maximum(limits - _RED_NM, 0)
    return np.asarray(np.diff(integral)[:, 0] / np.diff(limits)[:, 0])


def _require_grey(material: Material) -> None:
    tint: Tint | None = getattr(material, "tint", None)
    own = colours(material) if tint is None else [tint.plain]
    if any(np.ptp(colour) > 0 for colour in own):
        raise error_at(
            material.source,
            f'the material "{material.name}" is coloured, and RGB does not determine'
            " its spectrum; values per band or an upsampling expected",
        )
    for part in parts(material):
        _require_grey(part)
