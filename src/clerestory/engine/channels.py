"""Whether a scene treats all channels alike, so that one channel says all."""

import numpy as np

from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.radiance.function_pattern import FunctionPattern
from clerestory.scene.material import Emitter, Material, colours, parts
from clerestory.scene.model import BsdfSurface, Illum, Patterned, Scene
from clerestory.scene.pattern import Pattern, Product


def channels_of(scene: Scene) -> int:
    """Return the channels that traces through a scene need: one, or three."""
    return 1 if all(is_grey(m) for m in scene.materials.values()) else 3


def is_grey(material: Material) -> bool:
    """Whether a material treats all channels alike; what it sends does not count."""
    if isinstance(material, Emitter):
        return not isinstance(material, Illum) or is_grey(material.alternate)
    if not all(is_grey(part) for part in parts(material)):
        return False
    if isinstance(material, Patterned) and not _is_grey_pattern(material.pattern):
        return False
    if isinstance(material, BsdfSurface) and any(
        material.bsdf.in_colour(name) for name in FUNCTIONS if material.bsdf.has(name)
    ):
        return False
    return all(bool(np.ptp(colour) == 0) for colour in colours(material))


def _is_grey_pattern(pattern: Pattern) -> bool:
    match pattern:
        case FunctionPattern():
            return len(pattern.expressions) == 1
        case Product():
            return all(_is_grey_pattern(factor) for factor in pattern.factors)
        case _:
            return False
