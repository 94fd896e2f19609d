"""Materials of MGF as materials of the scene.

MGF gives shares of light and leaves the model to the program. The choice between
plastic, metal, trans, glass and dielectric is Radiance's (mgf2rad), so that geometry
that went from Radiance to MGF comes back as it was.
"""

import numpy as np
from jaxtyping import Float

from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.errors import InputError
from clerestory.formats.mgf_colour import is_grey, rgb
from clerestory.formats.mgf_context import MgfMaterial
from clerestory.scene.material import Source
from clerestory.scene.materials.dielectric import Dielectric
from clerestory.scene.materials.glass import Glass
from clerestory.scene.materials.plastic import Metal, Plastic
from clerestory.scene.materials.trans import Trans
from clerestory.scene.model import Light, Material

# Exitance from which a surface is a lamp [lm/m²].
_LEAST_EMITTANCE = 0.1

# Thickness that the transmittance of a solid is given for [m].
_SOLID_THICKNESS = 0.005

# Shares below this are rounding errors of a translator.
_NEGLIGIBLE = 0.01

# Shares may add up to this, as files round them.
_MOST_LIGHT = 1.001


def scene_material(given: MgfMaterial, name: str, source: Source | None) -> Material:
    """Return the material of the scene that acts like one of MGF.

    Examples
    --------
    >>> scene_material(MgfMaterial(diffuse_reflectance=0.5), "grey", None).reflectance
    array([0.5, 0.5, 0.5])
    """
    if given.emittance > _LEAST_EMITTANCE:
        radiance = given.emittance / (np.pi * LUMINOUS_EFFICACY)
        return Light(name, rgb(given.chromaticity("ed"), radiance), source)
    reflected = given.diffuse_reflectance + given.specular_reflectance
    passed = given.diffuse_transmittance + given.specular_transmittance
    if reflected + passed > _MOST_LIGHT:
        raise InputError(
            f'material "{name}" reflects and transmits {reflected + passed:.3f} of the'
            " light; 1 at most expected"
        )
    if _is_clear(given):
        return _clear(given, name, source)
    if max(given.diffuse_transmittance, given.specular_transmittance) > _NEGLIGIBLE:
        return _trans(given, name, source)
    rs, rd = given.specular_reflectance, given.diffuse_reflectance
    if rs < 0.08 and (rs < 0.1 * rd or is_grey(given.chromaticity("rs"))):
        colour = rgb(given.chromaticity("rd"), rd / (1 - rs))
        return Plastic(name, colour, rs, given.reflected_roughness, source)
    colour = rgb(given.chromaticity("rd"), rd) + rgb(given.chromaticity("rs"), rs)
    share = rs / (rd + rs) if rs > 0 else 0.0
    return Metal(name, colour, share, given.reflected_roughness, source)


def _is_clear(given: MgfMaterial) -> bool:
    small = (
        given.diffuse_transmittance,
        given.diffuse_reflectance,
        given.reflected_roughness,
        given.transmitted_roughness,
    )
    return (
        given.index > 1.1
        and given.specular_transmittance > 0.25
        and given.specular_reflectance <= 0.125
        and max(small) <= _NEGLIGIBLE
    )


def _clear(given: MgfMaterial, name: str, source: Source | None) -> Material:
    # Two sides make a pane, one side the surface of a solid
    passed = rgb(given.chromaticity("ts"), given.specular_transmittance)
    if given.one_sided:
        share = given.specular_transmittance + given.specular_reflectance
        inner = rgb(given.chromaticity("ts"), share) ** (1 / _SOLID_THICKNESS)
        return Dielectric(name, inner, given.index, source)
    return Glass(name, _between_faces(passed, given.index), given.index, source)


def _between_faces(
    passed: Float[np.ndarray, "3"], index: float
) -> Float[np.ndarray, "3"]:
    # Share left after one passage, from that which a pane passes along the normal, as
    # rad2mgf wrote it; mgf2rad takes ts + rs for it, 0.014 too much for t = 0.65
    face = ((index - 1) / (index + 1)) ** 2
    clear = (1 - face) ** 2
    root = np.sqrt(clear**2 + (2 * face * passed) ** 2)
    inner: Float[np.ndarray, 3] = 2 * passed / (clear + root)
    return np.asarray(np.minimum(inner, 1))


def _trans(given: MgfMaterial, name: str, source: Source | None) -> Trans:
    rd, td, ts = (
        given.diffuse_reflectance,
        given.diffuse_transmittance,
        given.specular_transmittance,
    )
    rs, both = given.specular_reflectance, rd + td + ts
    parts = {"rd": rd, "td": td, "ts": ts}
    colour = np.sum(
        [rgb(given.chromaticity(key), share) for key, share in parts.items()], axis=0
    )
    rough = rs * given.reflected_roughness + ts * given.transmitted_roughness
    return Trans(
        name,
        # Shares are of all light; trans takes the highlight off first
        colour / (1 - rs) if td + ts < 0.999 * both else colour,
        rs,
        rough / (rs + ts) if rs + ts > 1e-4 else 0.0,
        (td + ts) / both,
        ts / (ts + td),
        source,
    )
