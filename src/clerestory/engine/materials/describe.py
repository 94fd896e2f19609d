"""From a material of a scene to the description of its Mitsuba plugin."""

from dataclasses import replace

import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine import bsdf_file
from clerestory.engine.materials import textured
from clerestory.engine.pattern_code import multiplier, perturbation, share
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
    Patterned,
    Plastic,
    Plastic2,
    Spotlight,
    Textured,
    Trans,
    Trans2,
    Void,
)
from clerestory.scene.pattern import Pattern

Description = dict[str, object]


_NOWHERE = np.zeros(3)


def load(material: Material, origin: Float[np.ndarray, "3"] = _NOWHERE) -> "mi.BSDF":
    """Return the Mitsuba BSDF of a material.

    Parameters
    ----------
    origin : point of the scene that lies at the device's origin [m]
    """
    made = plugin(material, origin)
    return made if isinstance(made, mi.BSDF) else mi.load_dict(made)


def plugin(
    material: Material, origin: Float[np.ndarray, "3"] = _NOWHERE
) -> "Description | mi.BSDF":
    """Return the Mitsuba description of a material.

    Where a file or a function takes part, it is the plugin itself. Surfaces that shine
    take part in a trace as absorbers: what they send is scored elsewhere. An illum and
    a mirror with an alternate are what replaces them.
    """
    match material:
        case Plastic2() | Metal2() | Trans2() if isinstance(material.up, Pattern):
            made = load(replace(material, up=np.array([0.0, 0.0, 1.0])), origin)
            made.highlight.up = perturbation(material.up, origin)
            return made
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
        case Mixture(amount=float(amount)):
            return {
                "type": "radiance_mixture",
                "amount": amount,
                "foreground": plugin(material.foreground, origin),
                "background": plugin(material.background, origin),
            }
        case Mixture():
            made = load(replace(material, amount=0.5), origin)
            made.pattern = share(material.amount, origin)
            return made
        case Patterned():
            made = load(material.base, origin)
            made.paint.pattern = multiplier(material.pattern, origin)
            return made
        case Textured():
            return textured.plugin(
                load(material.base, origin), perturbation(material.texture, origin)
            )
        case Mirror(alternate=other) | Illum(alternate=other):
            return plugin(other, origin)
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
