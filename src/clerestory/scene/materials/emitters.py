"""Emitters of Radiance: light, glow, spotlight and illum.

Light is emitted from the front only; the back is black, and the reflectance is zero.

Reference: "The RADIANCE 6.0 Synthetic Imaging System" (ray.html), section 2.1.3.
"""

from dataclasses import dataclass, field

import numpy as np

from clerestory.array_types import Vector
from clerestory.checks import not_negative
from clerestory.directions import unit
from clerestory.scene.material import (
    Colour,
    Emitter,
    Material,
    Plugin,
    Source,
    Specification,
)
from clerestory.scene.materials.mixture import Void
from clerestory.scene.pattern import Pattern
from clerestory.scene.primitive import Definition, Readers
from clerestory.scene.tint import Tint


def _black(_: Emitter) -> Plugin:
    return Plugin("radiance_plastic", {"reflectance": np.zeros(3)})


@dataclass(frozen=True, eq=False)
class Light(Emitter):
    """A light source of given radiance [W/(m²·sr)], which a pattern may multiply."""

    name: str
    radiance: Colour
    source: Source | None = None
    pattern: Pattern | None = None
    tint: Tint | None = None
    opaque, plugin = True, _black

    def specification(self) -> Specification:
        return Specification("light", _even(self.pattern), (*self.radiance,))


@dataclass(frozen=True, eq=False)
class Glow(Emitter):
    """A light source that shadow rays sample only up to the distance `radius` [m].

    A radius of 0 excludes shadow rays; a negative radius also excludes indirect rays.
    """

    name: str
    radiance: Colour
    radius: float = 0.0
    source: Source | None = None
    pattern: Pattern | None = None
    tint: Tint | None = None
    opaque, plugin = True, _black

    def specification(self) -> Specification:
        return Specification("glow", _even(self.pattern), (*self.radiance, self.radius))


@dataclass(frozen=True, eq=False)
class Spotlight(Emitter):
    """A light source that emits into a cone of full angle `angle_deg` around an axis.

    `length` is the distance of the cone's apex behind the surface [m].
    """

    name: str
    radiance: Colour
    angle_deg: float
    direction: Vector
    length: float
    source: Source | None = None
    pattern: Pattern | None = None
    tint: Tint | None = None
    opaque, plugin = True, _black

    def specification(self) -> Specification:
        axis = self.direction * (self.length or 1.0)
        reals = *self.radiance, self.angle_deg, *axis
        return Specification("spotlight", _even(self.pattern), reals)


@dataclass(frozen=True, eq=False)
class Illum(Emitter):
    """A light source that the camera sees as the material `alternate`."""

    name: str
    radiance: Colour
    alternate: Material = field(default_factory=Void)
    source: Source | None = None
    pattern: Pattern | None = None
    tint: Tint | None = None

    @property
    def opaque(self) -> bool:
        return self.alternate.opaque

    def plugin(self) -> Plugin:
        return self.alternate.plugin()

    def specification(self) -> Specification:
        strings: tuple[Pattern | Material, ...]
        strings = (*_even(self.pattern), self.alternate)
        return Specification("illum", strings, (*self.radiance,))


def _radiance(value: Colour) -> Colour:
    not_negative(value, "radiance", unit="W/(m²·sr)")
    return value


def _even(pattern: Pattern | None) -> tuple[Pattern, ...]:
    return () if pattern is None else (pattern,)


def _light(given: Definition) -> Material:
    return Light(given.item.name, _radiance(given.reals(3)), given.source)


def _glow(given: Definition) -> Material:
    value = given.reals(4)
    radius = float(value[3]) * given.placed.scale
    return Glow(given.item.name, _radiance(value[:3]), radius, given.source)


def _illum(given: Definition) -> Material:
    radiance = _radiance(given.reals(3, strings=True))
    return Illum(given.item.name, radiance, given.alternate() or Void(), given.source)


def _spotlight(given: Definition) -> Material:
    value = given.reals(7)
    given.full_angle(value[3])
    axis = given.placed.vectors(value[4:])
    radiance, angle = _radiance(value[:3]), float(value[3])
    cone = angle, unit(axis), float(np.linalg.norm(axis))
    return Spotlight(given.item.name, radiance, *cone, given.source)


READERS: Readers = {
    "light": _light,
    "glow": _glow,
    "illum": _illum,
    "spotlight": _spotlight,
}
