"""Registry of material types, discovered from the files in this folder.

Each file defines subclasses of `Material`, and a dictionary `READERS` of the functions
that read the arguments, by Radiance material type.
"""

import importlib
import pkgutil
from collections.abc import Mapping

from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.scene.material import Material
from clerestory.scene.primitive import Definition, Readers

_MODULES = [
    importlib.import_module(found.name)
    for found in pkgutil.iter_modules(__path__, f"{__name__}.")
]
READERS: Readers = {
    kind: reader
    for module in _MODULES
    for kind, reader in getattr(module, "READERS", {}).items()
}

_BY_FUNCTION = "a BSDF file (bsdf2ttree makes one from a function) in the type BSDF, or"

# What to use instead of each of Radiance's types that is not supported
INSTEAD: Mapping[str, str] = {
    "plasfunc": f"{_BY_FUNCTION} plastic",
    "metfunc": f"{_BY_FUNCTION} metal",
    "transfunc": f"{_BY_FUNCTION} trans",
    **dict.fromkeys(
        ("plasdata", "metdata", "transdata"),
        "a BSDF file (clerestory gonio makes one from a measurement) in the type BSDF",
    ),
    **dict.fromkeys(
        ("prism1", "prism2"),
        "a BSDF file (clerestory bsdf generate makes one from the prism's geometry)",
    ),
    "ashik2": "plastic2 or metal2",
    "WGMDfunc": "plastic, metal or trans",
    "specpict": "spectrum or specfile without a picture",
    "antimatter": "the remaining surfaces without antimatter",
    "mist": "a scene without participating media",
    "colorpict": "colordata or colorfunc, or a plain colour",
    "brighttext": "brightdata or brightfunc, or a plain colour",
    "colortext": "colordata or colorfunc, or a plain colour",
    "mixtext": "mixdata or mixfunc",
    "mixpict": "mixdata or mixfunc",
}


def read_material(given: Definition) -> Material:
    """Return the material defined by a primitive."""
    kind = given.item.kind
    with given.located():
        if kind in INSTEAD:
            raise InputError(f"unsupported type; {INSTEAD[kind]} expected")
        require(
            kind in READERS, f"unsupported type; one of {', '.join(READERS)} expected"
        )
        return READERS[kind](given)
