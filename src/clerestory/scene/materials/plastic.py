"""Radiance's plastic and metal: diffuse reflection with a Gaussian highlight.

One roughness value gives an isotropic highlight; two values and an up vector give an
anisotropic highlight (Radiance's plastic2, metal2, trans2).

References: G. Ward, "Measuring and modeling anisotropic reflection", SIGGRAPH 1992;
"The RADIANCE 6.0 Synthetic Imaging System" (ray.html), section 2.1.3.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vector, Vector2
from clerestory.checks import not_negative, require, within
from clerestory.directions import unit
from clerestory.scene.material import (
    Colour,
    Material,
    Parameter,
    Plugin,
    Source,
    Specification,
)
from clerestory.scene.pattern import Pattern
from clerestory.scene.primitive import Definition, Readers
from clerestory.scene.tint import Tint

# Minimum roughness of anisotropic highlights (Radiance's FTINY)
_TINY = 1e-6

# Greatest roughness of a smooth surface, as in Radiance (normal.c, SP_PURE)
SMOOTHEST = 1e-3

# Rms facet slope; anisotropic highlight: slopes along `up` and perpendicular to it
Roughness = float | Vector2

# Up vector: constant in scene coordinates, or functions in their own coordinates
Up = Vector | Pattern | None


@dataclass(frozen=True, eq=False)
class Plastic(Material):
    """Radiance's plastic: diffuse reflection with an uncoloured Gaussian highlight.

    Attributes
    ----------
    name : key of the material in the scene
    reflectance : diffuse reflectance before multiplication by 1 − specularity
    specularity : specular reflectance, 0…1
    roughness : rms facet slope, 0 for a smooth coat; two values, along `up` and
        perpendicular to it, for an anisotropic highlight
    up : first axis of an anisotropic highlight, before projection onto the surface
    """

    name: str
    reflectance: Colour
    specularity: float = 0.0
    roughness: Roughness = 0.0
    source: Source | None = None
    up: Up = None
    tint: Tint | None = None
    takes_pattern = True
    opaque = True

    @property
    def mirrored(self) -> float:
        return smooth_specularity(self)

    @property
    def lambertian(self) -> bool:
        return self.specularity == 0

    def plugin(self) -> Plugin:
        return Plugin("radiance_plastic", highlight_parameters(self))

    def specification(self) -> Specification:
        return highlight_specification("plastic", self)


@dataclass(frozen=True, eq=False)
class Metal(Material):
    """Radiance's metal: as `Plastic`, with a highlight of the metal's colour."""

    name: str
    reflectance: Colour
    specularity: float = 0.0
    roughness: Roughness = 0.0
    source: Source | None = None
    up: Up = None
    tint: Tint | None = None
    takes_pattern = True
    opaque = True

    @property
    def mirrored(self) -> float:
        return smooth_specularity(self) * float(np.mean(self.reflectance))

    @property
    def lambertian(self) -> bool:
        return self.specularity == 0

    def plugin(self) -> Plugin:
        parameters = {"metallic": True, **highlight_parameters(self)}
        return Plugin("radiance_plastic", parameters)

    def specification(self) -> Specification:
        return highlight_specification("metal", self)


class Glossy(Protocol):
    """A material with a Gaussian highlight."""

    @property
    def reflectance(self) -> Colour: ...
    @property
    def specularity(self) -> float: ...
    @property
    def roughness(self) -> Roughness: ...
    @property
    def up(self) -> Up: ...


def smooth_specularity(material: Glossy) -> float:
    """Return the specularity of a smooth surface, or 0 for a rough surface."""
    smooth = np.max(material.roughness) <= SMOOTHEST
    return float(material.specularity) if smooth else 0.0


def highlight_parameters(material: Glossy) -> dict[str, Parameter]:
    """Return the plugin parameters of glossy materials: reflectance and highlight."""
    first, *second = np.atleast_1d(material.roughness).tolist()
    shared: dict[str, Parameter] = {
        "reflectance": material.reflectance,
        "specularity": material.specularity,
        "roughness": first,
    }
    if material.up is not None:
        shared |= {"roughness_v": second[0], "up": material.up}
    return shared


def highlight_specification(
    kind: str, material: Glossy, *further: float
) -> Specification:
    """Return the Radiance type and arguments of a glossy material.

    `kind`: Radiance type with an isotropic highlight. `further`: arguments after the
    roughness.
    """
    gloss = material.specularity, *np.atleast_1d(material.roughness).tolist()
    reals = (*material.reflectance, *gloss, *further)
    if material.up is None:
        return Specification(kind, (), reals)
    up = (material.up,) if isinstance(material.up, Pattern) else (*material.up,)
    return Specification(f"{kind}2", (*up, "."), reals)


def read_highlight(
    given: Definition, further: int
) -> tuple[tuple[Colour, float, Roughness], Up, Float[np.ndarray, " further"]]:
    """Return (reflectance, specularity, roughness), up vector and further numbers."""
    elliptical = given.item.kind.endswith("2")
    up = _up(given) if elliptical else None
    end = 6 if elliptical else 5
    value = given.reals(end + further, strings=elliptical)
    reflectance = given.share("reflectance", value[:3])
    within(value[3], "specularity", least=0, most=1)
    slope = value[4:end]
    not_negative(slope, "roughness")
    if slope.max() > 0.4:
        given.doubt(f"roughness is {slope.max():g}; values above 0.2 are unusual")
    least = f"roughness is {slope.min():g}; more than 0 expected"
    require(slope.min() > _TINY or not elliptical, least)
    roughness = slope if elliptical else float(slope[0])
    return (reflectance, float(value[3]), roughness), up, value[end:]


def _up(given: Definition) -> Vector | Pattern:
    given.strings(4, "up vector, function file and transform")
    given.oriented(4)
    vector = given.vector(0, given.placed)
    return vector if isinstance(vector, Pattern) else unit(vector)


def _read(given: Definition) -> Material:
    kind = Metal if given.item.kind.startswith("metal") else Plastic
    gloss, up, _ = read_highlight(given, 0)
    return kind(given.item.name, *gloss, given.source, up)


READERS: Readers = dict.fromkeys(("plastic", "metal", "plastic2", "metal2"), _read)
