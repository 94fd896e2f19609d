"""Conversion of scenes from RGB to other spectral bands."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from clerestory.array_types import Vector
from clerestory.bands import RGB, Bands
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.scene.material import (
    Colour,
    Material,
    colours,
    error_at,
    parts,
    with_colours,
)
from clerestory.scene.model import Scene

# Wavelengths that separate blue, green and red (Radiance color.h: WLPART) [nm]
_GREEN_NM, _RED_NM = 480.0, 588.0

Rgb = Vector
Upsampling = Callable[[Rgb, Bands], Colour]


def in_bands(
    scene: Scene, bands: Bands, *, upsampling: Upsampling | None = None
) -> Scene:
    """Return an RGB scene converted to other spectral bands.

    Grey materials have the same value in all bands. Coloured materials require an
    `upsampling`, such as `step_spectrum`, since RGB does not determine their spectrum.

    Parameters
    ----------
    upsampling : function that converts an RGB colour to values in given bands
    """
    require(
        scene.bands == RGB, f"the scene is in the bands {scene.bands}; {RGB} expected"
    )
    if upsampling is None:
        for material in scene.materials.values():
            _require_grey(material)

    def converted(rgb: Rgb) -> Colour:
        if upsampling is None or np.ptp(rgb) == 0:
            return np.full(len(bands), rgb[0])
        return upsampling(rgb, bands)

    given = scene.materials.items()
    materials = {name: with_colours(m, converted) for name, m in given}
    return replace(scene, materials=materials, bands=bands)


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
    if any(np.ptp(colour) > 0 for colour in colours(material)):
        raise error_at(
            material.source,
            f'the material "{material.name}" is coloured, and RGB does not determine'
            " its spectrum; values per band or an upsampling expected",
        )
    for part in parts(material):
        _require_grey(part)
