"""Registry of material types, discovered from the files in this folder.

Each file defines subclasses of `Material`, and a dictionary `READERS` from Radiance
material types to functions that read the arguments of the type.
"""

import importlib
import pkgutil
from collections.abc import Callable, Mapping

from clerestory.scene.material import Material
from clerestory.scene.primitive import Definition

READERS: Mapping[str, Callable[[Definition], Material]] = {
    kind: reader
    for found in pkgutil.iter_modules(__path__, f"{__name__}.")
    for kind, reader in getattr(
        importlib.import_module(found.name), "READERS", {}
    ).items()
}


def read_material(given: Definition) -> Material:
    """Return the material defined by a primitive."""
    if given.item.kind not in READERS:
        raise given.error(f"unsupported type; one of {', '.join(READERS)} expected")
    return READERS[given.item.kind](given)
