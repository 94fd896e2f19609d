"""Modifiers of honeybee models: materials and BSDFs.

The defaults are honeybee-radiance's generic modifier set.
"""

from dataclasses import dataclass, field
from typing import final

import numpy as np

from clerestory.errors import located
from clerestory.formats.json_item import Item
from clerestory.scene.materials.emitters import Glow, Light
from clerestory.scene.model import Glass, Material, Metal, Mirror, Plastic, Trans

# Reflectances and transmissivities of honeybee's generic modifiers
_GENERIC_GREY = {
    "wall_set": 0.5,
    "floor_set": 0.2,
    "roof_ceiling_set": 0.8,
    "door_set": 0.5,
    "shade_set.exterior_modifier": 0.35,
    "shade_set.interior_modifier": 0.5,
    "context": 0.2,
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
    """A modifier given by a BSDF.

    Attributes
    ----------
    name : name of the modifier
    xml : content of the BSDF file
    up : up vector of the BSDF
    """

    name: str
    xml: str
    up: np.ndarray


Modifier = Material | BsdfModifier


@dataclass
class Modifiers:
    """Modifiers and modifier sets of a model, and descriptions of unsupported ones."""

    named: dict[str, Modifier] = field(default_factory=dict)
    sets: dict[str, Item] = field(default_factory=dict)
    standard: Item | None = None
    unsupported: list[str] = field(default_factory=list)

    def of(self, own: Item, place: str, room_set: str = "") -> Modifier:
        """Return the modifier of an object: its own, its room's, or the default.

        Parameters
        ----------
        own : radiance properties of the object
        place : key in a modifier set, such as `wall_set.exterior_modifier`
        room_set : name of the room's modifier set; empty if it has none
        """
        name = own.text("modifier", "")
        if name:
            return self.called(name, own)
        for chosen in (self.sets.get(room_set), self.standard):
            if chosen is None:
                continue
            table, _, key = place.partition(".")
            found = chosen.item(table).text(key, "") if key else chosen.text(table, "")
            if found and found in self.named:
                return self.named[found]
        return _generic(place)

    def called(self, name: str, item: Item) -> Modifier:
        """Return the modifier with a given name."""
        if name not in self.named:
            raise item.wrong("modifier", "the identifier of a modifier of the model")
        return self.named[name]


def read_modifiers(radiance: Item) -> Modifiers:
    """Return the modifiers in the radiance properties of a model."""
    found = Modifiers()
    standard = radiance.item("global_modifier_set")
    for item in (*standard.items("modifiers"), *radiance.items("modifiers")):
        modifier = _modifier(item, found.unsupported)
        if modifier is not None:
            found.named[item.text("identifier")] = modifier
    for item in radiance.items("modifier_sets"):
        found.sets[item.text("identifier")] = item
    found.standard = standard if standard.value else None
    return found


def _generic(place: str) -> Material:
    if place in _GENERIC_GLASS:
        value = _GENERIC_GLASS[place]
        return Glass(f"generic_{place.replace('.', '_')}", np.full(3, value))
    grey = _GENERIC_GREY.get(place, _GENERIC_GREY.get(place.partition(".")[0], 0.5))
    return Plastic(f"generic_{grey:.2f}", np.full(3, grey))


def _modifier(item: Item, unsupported: list[str]) -> Modifier | None:
    name, kind = item.text("identifier"), item.text("type")
    if item.value.get("modifier") not in (None, "void") and not _is_void(item):
        unsupported.append(f'the pattern or texture under modifier "{name}"')
    plain = _name(name)
    with located(file=item.file, subject=item.where):
        match kind:
            case "Plastic":
                return Plastic(plain, _colour(item, "reflectance"), *_gloss(item))
            case "Metal":
                return Metal(plain, _colour(item, "reflectance"), *_gloss(item))
            case "Glass":
                index = item.number("refraction_index", 1.52)
                return Glass(plain, _colour(item, "transmissivity"), index)
            case "Trans":
                return _trans(plain, item)
            case "Mirror":
                return Mirror(plain, _colour(item, "reflectance"))
            case "Light":
                return Light(plain, _colour(item, "emittance"))
            case "Glow":
                radius = item.number("max_radius", 0.0)
                return Glow(plain, _colour(item, "emittance"), radius)
            case "BSDF":
                return _bsdf(plain, item, unsupported)
    unsupported.append(f'modifier "{name}" of type {kind}')
    return None


def _is_void(item: Item) -> bool:
    value = item.value.get("modifier")
    return isinstance(value, dict) and value.get("type") == "Void"


def _name(identifier: str) -> str:
    # Names in Radiance contain no spaces
    return "_".join(identifier.split()) or "modifier"


def _colour(item: Item, word: str) -> np.ndarray:
    return np.array([item.number(f"{channel}_{word}", 0.0) for channel in "rgb"])


def _gloss(item: Item) -> tuple[float, float]:
    return item.number("specularity", 0.0), item.number("roughness", 0.0)


def _trans(name: str, item: Item) -> Trans:
    # Diffuse and specular transmitted fractions: arguments 6 and 7 of Radiance's trans
    share = item.number("transmitted_diff", 0.0)
    straight = item.number("transmitted_spec", 0.0)
    return Trans(name, _colour(item, "reflectance"), *_gloss(item), share, straight)


def _bsdf(name: str, item: Item, unsupported: list[str]) -> BsdfModifier:
    if item.number("thickness", 0.0) != 0:
        unsupported.append(f'the thickness of BSDF "{name}": it is a flat sheet')
    if item.value.get("transform") is not None:
        unsupported.append(f'the transform of BSDF "{name}"')
    up = item.vector("up_orientation", (0.0, 0.0, 1.0))
    return BsdfModifier(name, item.text("bsdf_data"), up)
