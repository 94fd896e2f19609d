"""What materials look like at a glance: their colour, and whether they hide things.

For drawings and for checks of a scene; light is traced by other means.
"""

import numpy as np
from jaxtyping import Float

from clerestory.scene.composite import (
    BsdfSurface,
    Illum,
    Material,
    Mirror,
    Mixture,
    Patterned,
    Textured,
    Void,
)
from clerestory.scene.emitter import Glow, Light, Spotlight
from clerestory.scene.material import (
    Dielectric,
    Glass,
    Interface,
    Metal,
    Metal2,
    Plastic,
    Plastic2,
    Trans,
    Trans2,
)


def colour(material: Material) -> Float[np.ndarray, "3"]:
    """Return the colour in which a drawing shows a material, 0…1; lamps are white.

    Patterns are left out, and mixtures that vary are taken as half and half.

    Examples
    --------
    >>> colour(Mixture("net", Plastic("", np.full(3, 0.5)), Void(), 0.5)).tolist()
    [0.75, 0.75, 0.75]
    """
    match material:
        case Plastic() | Metal() | Plastic2() | Metal2() | Trans() | Trans2():
            shown = material.reflectance
        case Glass() | Dielectric():
            shown = material.transmissivity
        case Interface():
            shown = material.inside_transmissivity
        case Mirror(alternate=None):
            shown = material.reflectance
        case Mirror(alternate=other) | Illum(alternate=other):
            shown = np.ones(3) if other is None else colour(other)
        case Mixture():
            share = material.amount if isinstance(material.amount, float) else 0.5
            shown = share * colour(material.foreground)
            shown = shown + (1 - share) * colour(material.background)
        case Patterned() | Textured():
            shown = colour(material.base)
        case BsdfSurface() | Void() | Light() | Glow() | Spotlight():
            shown = np.ones(3)
    return np.asarray(np.clip(shown, 0, 1))


def is_opaque(material: Material) -> bool:
    """Return whether no light gets through a material.

    Examples
    --------
    >>> is_opaque(Plastic("", np.ones(3))), is_opaque(Glass("", np.ones(3)))
    (True, False)
    """
    match material:
        case Plastic() | Metal() | Plastic2() | Metal2():
            return True
        case Trans() | Trans2():
            return material.transmission == 0
        case Glass() | Dielectric() | Interface() | BsdfSurface() | Void():
            return False
        case Mirror(alternate=other) | Illum(alternate=other):
            return other is None or is_opaque(other)
        case Mixture():
            return is_opaque(material.foreground) and is_opaque(material.background)
        case Patterned() | Textured():
            return is_opaque(material.base)
        case Light() | Glow() | Spotlight():
            return True
