"""Interface of all material types.

Each material type has one file in `scene.materials` with a dataclass, functions that
read and write its Radiance arguments (`READERS`, `specification`), and the name and
parameters of its Mitsuba plugin.

A field of the type `Colour` has one value per band of the scene. If all values are
equal (grey), the colour is valid for any number of bands.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import ClassVar, TypeVar

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.bsdf import Bsdf
from clerestory.errors import InputError
from clerestory.scene.pattern import Pattern

Colour = Float[np.ndarray, " band"]


@dataclass(frozen=True)
class Source:
    """File and line of a definition in a scene file."""

    file: str
    line: int


@dataclass(frozen=True)
class Plugin:
    """Name and parameters of a Mitsuba plugin."""

    name: str
    parameters: "Mapping[str, Parameter]" = field(default_factory=dict)


def error_at(source: Source | None, message: str) -> InputError:
    """Return an error with the file and line of a definition, if known."""
    place = vars(source) if source else {}
    return InputError(message, **place)


@dataclass(frozen=True, eq=False)
class Specification:
    """Type and arguments of a material in Radiance's scene language.

    String arguments that are materials or BSDFs are written as names or file names.
    """

    kind: str
    strings: "tuple[Argument, ...]" = ()
    reals: tuple[float, ...] = ()


class Material(ABC):
    """A material of a scene; its name is its key in the scene.

    `takes_pattern` tells whether a pattern may multiply the colour.
    """

    name: str
    source: Source | None
    takes_pattern: ClassVar[bool] = False

    @property
    @abstractmethod
    def opaque(self) -> bool:
        """Whether the material transmits no light."""

    @property
    def mirrored(self) -> float:
        """Reflectance of mirror reflection near normal incidence, on flat surfaces."""
        return 0.0

    @property
    def lambertian(self) -> bool:
        """Whether all light is reflected diffusely or absorbed."""
        return False

    @abstractmethod
    def plugin(self) -> Plugin:
        """Return the Mitsuba plugin; the surface of a light source is black."""

    @abstractmethod
    def specification(self) -> Specification | None:
        """Return Radiance type and arguments; None if the material is not writable."""


class Emitter(Material, ABC):
    """A material that emits light from its front, with a radiance [W/(m²·sr)].

    `pattern` multiplies the radiance, depending on direction and point; None is 1.
    """

    radiance: Colour
    pattern: Pattern | None


# Largest numbers of materials in a nested material, and of materials of one name
_MOST_PARTS, _MOST_DEFINITIONS = 100, 200

Argument = str | float | Material | Pattern | Bsdf
Parameter = float | np.ndarray | Material | Pattern | Bsdf
_AnyMaterial = TypeVar("_AnyMaterial", bound=Material)


def parts(material: Material) -> Iterator[Material]:
    """Yield the materials of which a material is composed."""
    return (part for part in vars(material).values() if isinstance(part, Material))


def colours(material: Material) -> Iterator[Colour]:
    """Yield the colours of a material, but not of its component materials."""
    return (getattr(material, name) for name in colour_fields(material))


def colour_fields(material: Material) -> tuple[str, ...]:
    """Names of the fields of a material that are colours."""
    known = fields(material)  # type: ignore[arg-type]
    return tuple(f.name for f in known if f.type is Colour)


def with_colours(
    material: _AnyMaterial, change: Callable[[Colour], Colour]
) -> _AnyMaterial:
    """Return a material with all colours converted, also in component materials."""
    changed: dict[str, object] = {}
    for known in fields(material):  # type: ignore[arg-type]
        value = getattr(material, known.name)
        if known.type is Colour:
            changed[known.name] = change(value)
        elif isinstance(value, Material):
            changed[known.name] = with_colours(value, change)
    return altered(material, **changed)


def require_few_parts(material: Material) -> None:
    """Raise an error if a material is composed of more than 100 materials.

    Each occurrence of a material in nested mixtures is counted.
    """
    waiting, count = [material], 0
    while waiting:
        count += 1
        if count > _MOST_PARTS:
            raise error_at(
                material.source,
                f'the material "{material.name}" is composed of more than'
                f" {_MOST_PARTS:,} materials; fewer nested mixtures expected",
            )
        waiting += parts(waiting.pop())


def insert_material(materials: dict[str, Material], material: Material) -> str:
    """Add a material under its name, numbered if the name is in use; return the key.

    The material is not added if an equal material (source aside) has the same name.
    """
    require_few_parts(material)
    stem = material.name.rpartition("#")[0] if "#" in material.name else material.name
    key, count = material.name, 1
    while key in materials:
        if same_material(materials[key], material):
            return key
        count += 1
        key = f"{stem}#{count}"
        if count > _MOST_DEFINITIONS:
            raise error_at(
                material.source,
                f'the material "{stem}" has more than {_MOST_DEFINITIONS} different'
                " definitions; different names expected",
            )
    materials[key] = material if key == material.name else altered(material, name=key)
    return key


def altered(material: _AnyMaterial, **values: object) -> _AnyMaterial:
    """Return a copy of a material with new values of some fields."""
    return replace(material, **values)  # type: ignore[type-var]


def same_material(one: object, other: object) -> bool:
    """Whether two materials are equal, apart from their names and sources."""
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(
            same_material(one[k], other[k]) for k in one
        )
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        return len(one) == len(other) and all(map(same_material, one, other))
    if is_dataclass(one) and not isinstance(one, type):
        ignored = ("name", "source") if isinstance(one, Material) else ()
        return all(
            same_material(getattr(one, f.name), getattr(other, f.name))
            for f in fields(one)
            if f.name not in ignored
        )
    return bool(np.array_equal(one, other))  # type: ignore[arg-type]
