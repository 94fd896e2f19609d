"""From a material of a scene to the description of its Mitsuba plugin."""

import mitsuba as mi

from clerestory.engine import bsdf_file
from clerestory.scene.model import (
    BsdfSurface,
    Dielectric,
    Glass,
    Glow,
    Illum,
    Interface,
    Light,
    Material,
    Metal,
    Metal2,
    Mirror,
    Mixture,
    Plastic,
    Plastic2,
    Spotlight,
    Trans,
    Trans2,
    Void,
)

Description = dict[str, object]


def load(material: Material) -> mi.BSDF:
    """Return the Mitsuba BSDF of a material."""
    made = plugin(material)
    return made if isinstance(made, mi.BSDF) else mi.load_dict(made)


def plugin(material: Material) -> Description | mi.BSDF:
    """Return the Mitsuba description of a material; for a BSDF file, the plugin itself.

    Surfaces that shine take part in a trace as absorbers: what they send is scored
    elsewhere. An illum and a mirror with an alternate are what replaces them.
    """
    match material:
        case Plastic() | Metal() | Plastic2() | Metal2():
            return {
                "type": "radiance_plastic",
                "metallic": isinstance(material, Metal | Metal2),
                **_sheet(material),
            }
        case Trans() | Trans2():
            return {
                "type": "radiance_trans",
                "transmission": float(material.transmission),
                "transmitted_specular": float(material.transmitted_specular),
                **_sheet(material),
            }
        case Glass():
            return {
                "type": "radiance_glass",
                "transmissivity": _rgb(material.transmissivity),
                "index": float(material.index),
            }
        case Dielectric():
            return {
                "type": "radiance_dielectric",
                "inside_transmissivity": _rgb(material.transmissivity),
                "inside_index": float(material.index),
            }
        case Interface():
            return {
                "type": "radiance_dielectric",
                "inside_transmissivity": _rgb(material.inside_transmissivity),
                "inside_index": float(material.inside_index),
                "outside_transmissivity": _rgb(material.outside_transmissivity),
                "outside_index": float(material.outside_index),
            }
        case Mirror(alternate=None):
            return {
                "type": "radiance_mirror",
                "reflectance": _rgb(material.reflectance),
            }
        case Mixture():
            return {
                "type": "radiance_mixture",
                "amount": float(material.amount),
                "foreground": plugin(material.foreground),
                "background": plugin(material.background),
            }
        case Mirror(alternate=other) | Illum(alternate=other):
            return plugin(other)
        case BsdfSurface():
            return bsdf_file.plugin(material)
        case Void():
            return {"type": "null"}
        case Glow() | Light() | Spotlight():
            return {"type": "radiance_plastic", "reflectance": [0.0, 0.0, 0.0]}


def _sheet(
    material: Plastic | Metal | Trans | Plastic2 | Metal2 | Trans2,
) -> Description:
    # What all of them share; two roughnesses make an ellipse
    shared: Description = {
        "reflectance": _rgb(material.reflectance),
        "specularity": float(material.specularity),
    }
    if isinstance(material, Plastic2 | Metal2 | Trans2):
        along, across = material.roughness
        return shared | {
            "roughness": float(along),
            "roughness_v": float(across),
            "up": _rgb(material.up),
        }
    return shared | {"roughness": float(material.roughness)}


def _rgb(colour) -> list[float]:
    return [float(c) for c in colour]
