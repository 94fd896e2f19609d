"""Modifiers of honeybee models: materials and BSDFs.

The defaults are honeybee-radiance's generic modifier set.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import final

import numpy as np

from clerestory.checks import require
from clerestory.errors import located
from clerestory.formats.hbjson_checks import check_modifiers
from clerestory.formats.hbjson_schema import ModifierItem, ModifierSet, Radiance
from clerestory.scene.materials.emitters import Glow, Light
from clerestory.scene.materials.mixture import Void
from clerestory.scene.model import Glass, Material, Metal, Mirror, Plastic, Trans

# Reflectances and transmissivities of honeybee's generic modifiers
_GENERIC_GREY = {
    "wall_set": 0.5,
    "floor_set": 0.2,
    "roof_ceiling_set": 0.8,
    "door_set": 0.5,
    "shade_set.exterior_modifier": 0.35,
    "shade_set.interior_modifier": 0.5,
    "context_modifier": 0.2,
}
_GENERIC_GLASS = {
    "aperture_set.window_modifier": 0.6975761815384331,
    "aperture_set.skylight_modifier": 0.6975761815384331,
    "aperture_set.interior_modifier": 0.9584154328610596,
    "aperture_set.operable_modifier": 0.6975761815384331,
    "door_set.exterior_glass_modifier": 0.6975761815384331,
    "door_set.interior_glass_modifier": 0.9584154328610596,
}


@final
@dataclass(frozen=True, eq=False)
class BsdfModifier:
    """A BSDF modifier: XML text of the BSDF file, and up vector."""

    name: str
    xml: str
    up: np.ndarray


Modifier = Material | BsdfModifier


@dataclass
class Modifiers:
    """Modifiers and modifier sets of a model, and descriptions of unsupported ones.

    `unread` is the type of each modifier that is not supported.
    """

    named: dict[str, Modifier] = field(default_factory=dict)
    sets: dict[str, ModifierSet] = field(default_factory=dict)
    standard: ModifierSet = field(default_factory=ModifierSet)
    unsupported: list[str] = field(default_factory=list)
    unread: dict[str, str] = field(default_factory=dict)

    def of(
        self, name: str | None, place: str, room_set: str = "", *, owner: str
    ) -> Modifier:
        """Return the modifier of an object: its own, its room's, or the default.

        `name`: name of the object's own modifier, if any. `place`: key in a modifier
        set, such as `wall_set.exterior_modifier`. `room_set`: name of the room's
        modifier set, if any. `owner`: identifier of the object, for messages.
        """
        if name:
            return self._known(name, owner)
        for chosen in (self.sets.get(room_set), self.standard):
            found: object = chosen.model_extra if chosen else None
            for key in place.split("."):
                found = found.get(key) if isinstance(found, dict) else None
            if isinstance(found, dict):
                found = found.get("identifier")
            if isinstance(found, str):
                return self._known(found, owner)
        return _generic(place)

    def _known(self, name: str, owner: str) -> Modifier:
        named = f'modifier "{name}" of "{owner}"'
        kind = self.unread.get(name)
        types = "Plastic, Metal, Glass, Trans, Mirror, Light, Glow, BSDF or Void"
        require(kind is None, f"{named} is of type {kind}; {types} expected")
        message = f"{named} is not in the model; one of its modifiers expected"
        require(name in self.named, message)
        return self.named[name]


def read_modifiers(radiance: Radiance, file: str | Path) -> Modifiers:
    """Return the modifiers in the radiance properties of a model."""
    standard = radiance.global_modifier_set
    sets = {one.identifier: one for one in radiance.modifier_sets}
    found = Modifiers(sets=sets, standard=standard)
    held = [item for one in radiance.modifier_sets for item in _held(one.model_extra)]
    items = (*standard.modifiers, *radiance.modifiers, *held)
    check_modifiers((item.identifier, item) for item in items)
    for item in items:
        if item.identifier in found.named or item.identifier in found.unread:
            continue
        with located(file=file, subject=f'modifier "{item.identifier}"'):
            modifier = _modifier(item, found.unsupported)
        if modifier is None:
            found.unread[item.identifier] = item.type
        else:
            found.named[item.identifier] = modifier
    return found


def _held(value: object) -> Iterator[ModifierItem]:
    # Modifiers that a set holds in full instead of their names
    if isinstance(value, dict):
        if isinstance(value.get("identifier"), str) and "type" in value:
            yield ModifierItem.model_validate(value)
        else:
            for member in value.values():
                yield from _held(member)


def _generic(place: str) -> Material:
    if place in _GENERIC_GLASS:
        value = _GENERIC_GLASS[place]
        return Glass(f"generic_{place.replace('.', '_')}", np.full(3, value))
    grey = _GENERIC_GREY.get(place, _GENERIC_GREY.get(place.partition(".")[0], 0.5))
    return Plastic(f"generic_{grey:.2f}", np.full(3, grey))


def _modifier(item: ModifierItem, unsupported: list[str]) -> Modifier | None:
    void = isinstance(item.modifier, dict) and item.modifier.get("type") == "Void"
    if item.modifier not in (None, "void") and not void:
        unsupported.append(f'the pattern or texture under modifier "{item.identifier}"')
    name = item.identifier or "modifier"
    gloss = item.specularity, item.roughness
    match item.type.capitalize():
        case "Plastic":
            return Plastic(name, item.colour("reflectance"), *gloss)
        case "Metal":
            return Metal(name, item.colour("reflectance"), *gloss)
        case "Glass":
            return Glass(name, item.colour("transmissivity"), item.refraction_index)
        case "Trans":
            # Transmitted fractions: arguments 6 and 7 of Radiance's trans
            shares = item.transmitted_diff, item.transmitted_spec
            return Trans(name, item.colour("reflectance"), *gloss, *shares)
        case "Mirror":
            return Mirror(name, item.colour("reflectance"))
        case "Light":
            return Light(name, item.colour("emittance"))
        case "Glow":
            return Glow(name, item.colour("emittance"), item.max_radius)
        case "Void":
            return Void(name)
        case "Bsdf":
            return _bsdf(name, item, unsupported)
    unsupported.append(f'modifier "{item.identifier}" of type {item.type}')
    return None


def _bsdf(name: str, item: ModifierItem, unsupported: list[str]) -> BsdfModifier:
    if item.thickness != 0:
        unsupported.append(f'the thickness of BSDF "{name}": it is a flat sheet')
    if item.transform is not None:
        unsupported.append(f'the transform of BSDF "{name}"')
    return BsdfModifier(name, item.bsdf_data, np.array(item.up_orientation))
