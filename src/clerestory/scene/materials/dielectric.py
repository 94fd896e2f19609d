"""Radiance's dielectric and interface: surfaces of refracting transparent solids."""

from dataclasses import dataclass

import numpy as np

from clerestory.checks import within
from clerestory.scene.material import (
    Colour,
    Material,
    Parameter,
    Plugin,
    Source,
    Specification,
)
from clerestory.scene.primitive import Definition, Readers

# Wavelength at which Radiance evaluates the index of refraction [nm]
_MIDDLE = 500.0


@dataclass(frozen=True, eq=False)
class Dielectric(Material):
    """The surface of a refracting solid; the solid is behind the surface.

    The transmissivity is per metre; the index of refraction is valid at 500 nm.
    """

    name: str
    transmissivity: Colour
    index: float
    source: Source | None = None
    opaque = False

    @property
    def mirrored(self) -> float:
        return ((self.index - 1) / (self.index + 1)) ** 2

    def plugin(self) -> Plugin:
        return Plugin(
            "radiance_dielectric",
            {"inside_transmissivity": self.transmissivity, "inside_index": self.index},
        )

    def specification(self) -> Specification:
        return Specification("dielectric", (), (*self.transmissivity, self.index, 0))


@dataclass(frozen=True, eq=False)
class Interface(Material):
    """The interface between two dielectrics; the inside is behind the surface.

    Transmissivities are per metre; indices are indices of refraction.
    """

    name: str
    inside_transmissivity: Colour
    inside_index: float
    outside_transmissivity: Colour
    outside_index: float
    source: Source | None = None
    opaque = False

    @property
    def mirrored(self) -> float:
        inside, outside = self.inside_index, self.outside_index
        return ((inside - outside) / (inside + outside)) ** 2

    def plugin(self) -> Plugin:
        media: dict[str, Parameter] = {
            "inside_transmissivity": self.inside_transmissivity,
            "inside_index": self.inside_index,
            "outside_transmissivity": self.outside_transmissivity,
            "outside_index": self.outside_index,
        }
        return Plugin("radiance_dielectric", media)

    def specification(self) -> Specification:
        inside = *self.inside_transmissivity, self.inside_index
        outside = *self.outside_transmissivity, self.outside_index
        return Specification("interface", (), (*inside, *outside))


def _dielectric(given: Definition) -> Material:
    value = given.reals(5)
    if value[4] != 0:
        given.doubt(
            f"Hartmann's constant is {value[4]:g}; dispersion is ignored and the"
            f" index at {_MIDDLE:g} nm used"
        )
    index = _index(value[3] + value[4] / _MIDDLE)
    passed = _per_metre(given, value[:3])
    return Dielectric(given.item.name, passed, index, given.source)


def _interface(given: Definition) -> Material:
    value = given.reals(8)
    inside = _per_metre(given, value[:3]), _index(value[3])
    outside = _per_metre(given, value[4:7]), _index(value[7])
    return Interface(given.item.name, *inside, *outside, given.source)


def _per_metre(given: Definition, value: Colour) -> Colour:
    # Converts transmittance per unit length of the scene file to 1/m; at most 1
    passed = np.minimum(given.share("transmissivity", value), 1)
    return np.asarray(passed ** (1 / given.placed.scale))


def _index(value: float) -> float:
    within(value, "index of refraction", least=0.1, most=10)
    return float(value)


READERS: Readers = {"dielectric": _dielectric, "interface": _interface}
