"""Radiance's plastic and metal: diffuse reflection with a Gaussian highlight."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from clerestory.scene.material import Colour, Material, Plugin, Source, Specification
from clerestory.scene.materials.highlight import (
    Roughness,
    Up,
    highlight_parameters,
    highlight_specification,
    read_highlight,
)
from clerestory.scene.primitive import Definition


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
    takes_pattern = True
    opaque = True

    def display_colour(self) -> Colour:
        return self.reflectance

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
    takes_pattern = True
    opaque = True

    def display_colour(self) -> Colour:
        return self.reflectance

    def plugin(self) -> Plugin:
        parameters = {"metallic": True, **highlight_parameters(self)}
        return Plugin("radiance_plastic", parameters)

    def specification(self) -> Specification:
        return highlight_specification("metal", self)


def _read(given: Definition) -> Material:
    kind = Metal if given.item.kind.startswith("metal") else Plastic
    gloss, up, _ = read_highlight(given, 0)
    return kind(given.item.name, *gloss, given.source, up)


READERS: Mapping[str, Callable[[Definition], Material]] = dict.fromkeys(
    ("plastic", "metal", "plastic2", "metal2"), _read
)
