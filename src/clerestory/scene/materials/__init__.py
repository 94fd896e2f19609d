"""Registry of material types, discovered from the files in this folder.

Each file defines subclasses of `Material`, and a dictionary `READERS` of the functions
that read the arguments, by Radiance material type.
"""

import importlib
import pkgutil

from clerestory.checks import require
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


def read_material(given: Definition) -> Material:
    """Return the material defined by a primitive."""
    with given.located():
        kinds = ", ".join(READERS)
        require(
            given.item.kind in READERS, f"unsupported type; one of {kinds} expected"
        )
        return READERS[given.item.kind](given)
