"""Scaling of scenes, windows, sensors and views to another unit of length.

Radiance and irradiance do not depend on the unit of length. Besides coordinates,
thicknesses, radii and transmissivities per metre of materials are converted.
"""

from dataclasses import fields, is_dataclass, replace
from functools import lru_cache
from typing import Literal, Protocol, TypeVar, runtime_checkable

import numpy as np

from clerestory.checks import positive
from clerestory.scene.material import Material, altered
from clerestory.scene.materials.bsdf_surface import BsdfSurface
from clerestory.scene.materials.dielectric import Dielectric, Interface
from clerestory.scene.materials.emitters import Glow, Spotlight
from clerestory.scene.model import Scene
from clerestory.scene.pattern import Pattern, Product
from clerestory.scene.sensors import Sensors
from clerestory.scene.surface import transformed
from clerestory.scene.transform import Transform
from clerestory.scene.view import View
from clerestory.scene.window import Window

_Scaled = TypeVar("_Scaled")

# Units of length of models [m]
Unit = Literal["metres", "centimetres", "millimetres", "feet", "inches"]
METRES: dict[Unit, float] = {
    "metres": 1.0,
    "centimetres": 0.01,
    "millimetres": 0.001,
    "feet": 0.3048,
    "inches": 0.0254,
}


@runtime_checkable
class WithLengths(Protocol):
    """A value that can be scaled."""

    def scaled(self, factor: float) -> object:
        """Return the value with all lengths multiplied by a factor."""


# Fields of materials that are lengths [m], and that are transmissivities [1/m]
_LENGTHS = {BsdfSurface: "thickness", Glow: "radius", Spotlight: "length"}
_TRANSMISSIVITIES: dict[type[Material], tuple[str, ...]] = {
    Dielectric: ("transmissivity",),
    Interface: ("inside_transmissivity", "outside_transmissivity"),
}


def scaled(value: _Scaled, factor: float) -> _Scaled:
    """Return a scene, window, sensors or a view with all lengths times a factor.

    Tuples are scaled item by item; values without lengths are returned unchanged.

    >>> desk = Sensors(np.array([[10.0, 20.0, 2.5]]), np.array([[0.0, 0.0, 1.0]]))
    >>> scaled(desk, 0.3048).position.round(3).tolist()
    [[3.048, 6.096, 0.762]]
    """
    positive(factor, "scale")
    if factor == 1:
        return value
    result: object = value
    match value:
        case Scene():
            result = _scene(value, factor)
        case Window():
            move = _transform(factor)
            polygons = tuple(transformed(p, move) for p in value.polygons)
            result = replace(value, polygons=polygons)
        case Sensors():
            result = replace(value, position=value.position * factor)
        case View():
            lengths = ["position", "fore", "aft"]
            lengths += ["horizontal", "vertical"] if value.kind == "parallel" else []
            changed = {name: getattr(value, name) * factor for name in lengths}
            result = replace(value, **changed)
        case WithLengths():
            result = value.scaled(factor)
        case tuple():
            result = tuple(scaled(item, factor) for item in value)
    return result  # type: ignore[return-value]


@lru_cache(maxsize=4)
def _scene(scene: Scene, factor: float) -> Scene:
    # Cached, since scenes that are built for tracing are compared by identity
    move = _transform(factor)
    return replace(
        scene,
        materials={key: _material(m, factor) for key, m in scene.materials.items()},
        surfaces=tuple(transformed(surface, move) for surface in scene.surfaces),
    )


def _transform(factor: float) -> Transform:
    return Transform(np.diag([factor, factor, factor, 1.0]), factor)


def _material(material: Material, factor: float) -> Material:
    changed: dict[str, object] = {}
    for known in fields(material):  # type: ignore[arg-type]
        value = getattr(material, known.name)
        if isinstance(value, Material):
            changed[known.name] = _material(value, factor)
        elif isinstance(value, Pattern):
            changed[known.name] = _pattern(value, factor)
    for kind, name in _LENGTHS.items():
        if isinstance(material, kind):
            changed[name] = getattr(material, name) * factor
    for name in _TRANSMISSIVITIES.get(type(material), ()):
        changed[name] = getattr(material, name) ** (1 / factor)
    return altered(material, **changed) if changed else material


def _pattern(pattern: Pattern, factor: float) -> Pattern:
    # Patterns that depend on the point have a transform from their own coordinates
    if isinstance(pattern, Product):
        return Product(tuple(_pattern(part, factor) for part in pattern.factors))
    own = getattr(pattern, "transform", None)
    if not (isinstance(own, Transform) and is_dataclass(pattern)):
        return pattern
    if not pattern.needs_point:
        return pattern
    return replace(pattern, transform=own.then(_transform(factor)))
