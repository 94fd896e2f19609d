"""From the text of a material to its value: which function reads which type.

To read one more material, write its function and add it to `MATERIALS`.
"""

from collections.abc import Callable, Mapping

from clerestory.radiance import composite_materials as composite
from clerestory.radiance import surface_materials as plain
from clerestory.radiance.arguments import Definition
from clerestory.scene.composite import Material

MATERIALS: Mapping[str, Callable[[Definition], Material]] = {
    "plastic": plain.plastic,
    "metal": plain.plastic,
    "trans": plain.trans,
    "plastic2": plain.plastic2,
    "metal2": plain.plastic2,
    "trans2": plain.trans2,
    "glass": plain.glass,
    "dielectric": plain.dielectric,
    "interface": plain.interface,
    "mirror": composite.mirror,
    "mixfunc": composite.mixture,
    "mixdata": composite.mixture,
    "BSDF": composite.bsdf,
    "aBSDF": composite.bsdf,
    "light": composite.light,
    "glow": composite.glow,
    "illum": composite.illum,
    "spotlight": composite.spotlight,
}


def material(made: Definition) -> Material:
    """Return the material that a primitive defines.

    Raises
    ------
    InputError : a type that is not read, or arguments that do not fit it
    """
    if made.item.kind not in MATERIALS:
        raise made.error(f"this type is not supported; {', '.join(MATERIALS)} are")
    return MATERIALS[made.item.kind](made)
