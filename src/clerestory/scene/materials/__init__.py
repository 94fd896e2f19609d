"""Registry of materials: one file for each type, found by its presence in this folder.

A file defines its value, a `Material`, and `READERS`: for each type of Radiance's scene
language the function from its arguments to the value.
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
    """Return the material that a primitive defines."""
    if given.item.kind not in READERS:
        raise given.error(f"this type is not supported; {', '.join(READERS)} are")
    return READERS[given.item.kind](given)
