"""Conversion of MGF materials to scene materials.

MGF defines reflectances and transmittances, but no reflection model. Plastic, metal,
trans, glass or dielectric is chosen as in mgf2rad, so that conversion from Radiance to
MGF and back preserves materials.
"""

import numpy as np
from jaxtyping import Float

from clerestory.checks import require
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.formats.mgf_colour import is_grey, rgb
from clerestory.formats.mgf_definitions import MgfMaterial
from clerestory.scene.material import Source
from clerestory.scene.materials.dielectric import Dielectric
from clerestory.scene.materials.glass import Glass
from clerestory.scene.materials.plastic import Metal, Plastic
from clerestory.scene.materials.trans import Trans
from clerestory.scene.model import Light, Material

# Minimum luminous exitance of an emitter [lm/m²]
_LEAST_EMITTANCE = 0.1

# Thickness to which the transmittance of a solid refers [m]
_SOLID_THICKNESS = 0.005

# Largest reflectance or transmittance that counts as a rounding error
_NEGLIGIBLE = 0.01

# Maximum sum of reflectances and transmittances, above 1 because files round them
_MOST_LIGHT = 1.001


def scene_material(given: MgfMaterial, name: str, source: Source | None) -> Material:
    """Return the scene material for an MGF material."""
    emitted = given.share("ed")
    if emitted.value > _LEAST_EMITTANCE:
        radiance = emitted.value / (np.pi * LUMINOUS_EFFICACY)
        return Light(name, rgb(emitted.colour, radiance), source)
    rd, td, rs, ts = (given.share(keyword) for keyword in ("rd", "td", "rs", "ts"))
    total = rd.value + td.value + rs.value + ts.value
    require(
        total <= _MOST_LIGHT,
        f'material "{name}" reflects and transmits {total:.3f} of the light; at most 1'
        " expected",
    )
    if _is_clear(given):
        return _clear(given, name, source)
    if max(td.value, ts.value) > _NEGLIGIBLE:
        return _trans(given, name, source)
    if rs.value < 0.08 and (rs.value < 0.1 * rd.value or is_grey(rs.colour)):
        colour = rgb(rd.colour, rd.value / (1 - rs.value))
        return Plastic(name, colour, rs.value, rs.roughness, source)
    colour = rgb(rd.colour, rd.value) + rgb(rs.colour, rs.value)
    share = rs.value / (rd.value + rs.value) if rs.value > 0 else 0.0
    return Metal(name, colour, share, rs.roughness, source)


def _is_clear(given: MgfMaterial) -> bool:
    rd, td, rs, ts = (given.share(keyword) for keyword in ("rd", "td", "rs", "ts"))
    return (
        given.index > 1.1
        and ts.value > 0.25
        and rs.value <= 0.125
        and max(td.value, rd.value, rs.roughness, ts.roughness) <= _NEGLIGIBLE
    )


def _clear(given: MgfMaterial, name: str, source: Source | None) -> Material:
    # Two-sided materials are panes of glass, one-sided ones surfaces of solids
    through = given.share("ts")
    if given.one_sided:
        share = through.value + given.share("rs").value
        inner = rgb(through.colour, share) ** (1 / _SOLID_THICKNESS)
        return Dielectric(name, inner, given.index, source)
    passed = rgb(through.colour, through.value)
    return Glass(name, _between_faces(passed, given.index), given.index, source)


def _between_faces(
    passed: Float[np.ndarray, "3"], index: float
) -> Float[np.ndarray, "3"]:
    # Internal transmittance of one pass, from a pane's transmittance at normal
    # incidence (inverse of rad2mgf); ts + rs, as in mgf2rad, is 0.014 too high at 0.65
    face = ((index - 1) / (index + 1)) ** 2
    clear = (1 - face) ** 2
    root = np.sqrt(clear**2 + (2 * face * passed) ** 2)
    inner: Float[np.ndarray, 3] = 2 * passed / (clear + root)
    return np.asarray(np.minimum(inner, 1))


def _trans(given: MgfMaterial, name: str, source: Source | None) -> Trans:
    diffused = [given.share(keyword) for keyword in ("rd", "td", "ts")]
    colour = np.sum([rgb(part.colour, part.value) for part in diffused], axis=0)
    (rd, td, ts), mirrored = (part.value for part in diffused), given.share("rs")
    rs, both = mirrored.value, rd + td + ts
    rough = rs * mirrored.roughness + ts * diffused[2].roughness
    return Trans(
        name,
        # Fractions in trans, unlike in MGF, exclude specularly reflected flux
        colour / (1 - rs) if td + ts < 0.999 * both else colour,
        rs,
        rough / (rs + ts) if rs + ts > 1e-4 else 0.0,
        (td + ts) / both,
        ts / (ts + td),
        source,
    )
