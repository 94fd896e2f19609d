"""Spectral channels of the engine: bands that share paths, or are traced by threes.

BSDFs have three channels. If the colour c of each surface enters its BSDF linearly,
f(c) = f(0) + c (f(1) − f(0)), two channels determine all bands, and the paths of a
matrix carry the throughput of every band. All other scenes are traced once per group
of three bands, with the same seed. One channel is enough for grey materials.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from clerestory.bands import RGB, Bands
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.spectral_channels import band_groups_of, has_bands, is_spectral
from clerestory.checks import require
from clerestory.scene.material import (
    Colour,
    Emitter,
    Material,
    colours,
    parts,
    with_colours,
)
from clerestory.scene.materials.mirror import Mirror
from clerestory.scene.materials.modified import Textured
from clerestory.scene.model import (
    BsdfSurface,
    Illum,
    Metal,
    Patterned,
    Plastic,
    Scene,
)

# Number of channels in a group
GROUP = 3

# Largest number of bands along one path; kernels grow with the number
_MOST_BANDS = 81


def channels_of(scene: Scene) -> int:
    """Return the number of channels of matrices: one per band, or one if grey."""
    grey = all(is_grey(m) for m in scene.materials.values())
    return 1 if grey else len(scene.bands)


def band_groups(scene: Scene) -> tuple[Scene, ...]:
    """Return scenes of three channels each that together contain all bands of a scene.

    The last group repeats the last band if fewer than three remain. A scene in RGB is
    returned unchanged.
    """
    return (scene,) if scene.bands == RGB else _groups(scene)


def bands_share_paths(scene: Scene) -> bool:
    """Whether two reflectances determine the light in all bands of a scene."""
    return (
        scene.bands != RGB
        and len(scene.bands) > GROUP
        and channels_of(scene) > 1
        and all(is_grey(m) or _is_linear(m) for m in scene.materials.values())
    )


@lru_cache(maxsize=1)
def shared_groups(scene: Scene) -> tuple[Scene, ...]:
    """Return scenes with the bands of a scene that share paths, at most 81 each."""
    count = len(scene.bands)
    if count <= _MOST_BANDS:
        return (scene,)
    number = -(-count // _MOST_BANDS)
    limits = np.linspace(0, count, number + 1).round().astype(int)
    return tuple(
        _in_some_bands(scene, slice(first, end)) for first, end in pairwise(limits)
    )


def _in_some_bands(scene: Scene, chosen: slice) -> Scene:
    def some(colour: Colour) -> Colour:
        return colour[chosen] if len(colour) == len(scene.bands) else colour

    materials = {n: with_colours(m, some) for n, m in scene.materials.items()}
    return replace(scene, materials=materials, bands=scene.bands[chosen])


def at_two_reflectances(scene: Scene) -> Scene:
    """Return a scene in which coloured surfaces are black in the first channel.

    The other two channels have the reflectance of the brightest band.
    """
    materials = {n: two_reflectances(m) for n, m in scene.materials.items()}
    return replace(scene, materials=materials, bands=RGB)


def two_reflectances(material: Material) -> Material:
    """Return a material that is black in the first channel if it is coloured."""

    def black_and_brightest(colour: Colour) -> Colour:
        most = colour.max()
        return np.array([most if np.ptp(colour) == 0 else 0.0, most, most])

    return with_colours(material, black_and_brightest)


def shares_of_brightest(material: Material, count: int) -> Colour:
    """Return the colour of a material in all bands, relative to the brightest band."""
    for colour in colours(material):
        if np.ptp(colour) > 0:
            return np.asarray(colour / colour.max())
    for part in parts(material):
        return shares_of_brightest(part, count)
    return np.ones(count)


def _is_linear(material: Material) -> bool:
    # Whether a single colour multiplies a part of the reflected light
    match material:
        case Plastic() | Metal() | Mirror(alternate=None):
            return True
        case Patterned(base=base, pattern=pattern):
            return pattern.grey and _is_linear(base)
        case Textured(base=base):
            return _is_linear(base)
    return False


@lru_cache(maxsize=1)
def _groups(scene: Scene) -> tuple[Scene, ...]:
    # Cache the groups of the last scene, so that its jobs share one lowered scene
    for material in scene.materials.values():
        _refuse_rgb(material, scene.bands)
    tables = {
        name: band_groups_of(material.bsdf, scene.bands)
        for name, material in scene.materials.items()
        if isinstance(material, BsdfSurface)
    }
    return tuple(_group(scene, n, tables) for n in range(0, len(scene.bands), GROUP))


def _group(scene: Scene, first: int, tables: Mapping[str, Sequence[Bsdf]]) -> Scene:
    # The scene in the three bands from index `first` on
    count = len(scene.bands)
    chosen = np.minimum(np.arange(first, first + GROUP), count - 1)

    def group(colour: Colour) -> Colour:
        return colour[chosen if len(colour) == count else np.zeros(GROUP, dtype=int)]

    materials = {n: with_colours(m, group) for n, m in scene.materials.items()}
    for name, layers in tables.items():
        bsdf = layers[min(first // GROUP, len(layers) - 1)]
        if isinstance(material := materials[name], BsdfSurface):
            materials[name] = replace(material, bsdf=bsdf)
    return replace(scene, materials=materials, bands=RGB)


def is_grey(material: Material) -> bool:
    """Whether a material reflects and transmits equally in all bands."""
    if isinstance(material, Emitter):
        return not isinstance(material, Illum) or is_grey(material.alternate)
    if isinstance(material, BsdfSurface) and is_spectral(material.bsdf):
        return False
    return (
        not _has_rgb(material)
        and all(is_grey(part) for part in parts(material))
        and all(bool(np.ptp(colour) == 0) for colour in colours(material))
    )


def _refuse_rgb(material: Material, bands: Bands) -> None:
    spectral = isinstance(material, BsdfSurface) and has_bands(material.bsdf, bands)
    require(
        spectral or not _has_rgb(material),
        f'the material "{material.name}" has a pattern or BSDF in red, green and blue;'
        " a colourless one expected in a scene with other bands",
    )
    for part in parts(material):
        _refuse_rgb(part, bands)


def _has_rgb(material: Material) -> bool:
    # Whether a material has a coloured pattern or BSDF; both are defined in RGB only
    if isinstance(material, BsdfSurface):
        bsdf = material.bsdf
        return any(bsdf.in_colour(name) for name in FUNCTIONS if bsdf.has(name))
    if isinstance(material, Patterned | Emitter) and material.pattern is not None:
        return not material.pattern.grey
    return False
