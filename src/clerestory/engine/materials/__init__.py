"""Materials of scenes as Mitsuba BSDF plugins, usable in any Mitsuba scene.

Each plugin is a file of this folder. The file defines the plugin's name (`PLUGIN`), a
function that returns its class (`define`; each Mitsuba variant has its own base class),
and a function that sets parameters that are functions or BSDFs (`vary`). Radiance's
materials scatter alike on both sides of a surface, except `radiance_mirror` and the two
media of `radiance_dielectric`.

Parameters are opaque to the compiler, so that all instances share one kernel.
"""

from __future__ import annotations

import importlib
import pkgutil
from typing import TYPE_CHECKING

import mitsuba as mi
import numpy as np

from clerestory.engine.materials.coat import lamp_context
from clerestory.engine.materials.glossy_share import credited, glossy_context
from clerestory.engine.materials.queries import mirror_context
from clerestory.scene.material import Material

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import ModuleType

__all__ = [
    "absorber",
    "credited",
    "glossy_context",
    "lamp_context",
    "load",
    "mirror_context",
    "register",
]

_MODULES = (
    importlib.import_module(found.name)
    for found in pkgutil.iter_modules(__path__, f"{__name__}.")
)
_PLUGINS: Mapping[str, ModuleType] = {
    module.PLUGIN: module for module in _MODULES if hasattr(module, "PLUGIN")
}

_registered: set[str] = set()


def register() -> None:
    """Register the plugins for the current variant, once."""
    variant = mi.variant()
    if variant in _registered:
        return
    for name, module in _PLUGINS.items():
        mi.register_bsdf(name, module.define())
    _registered.add(variant)


def load(material: Material, origin: np.ndarray | None = None) -> mi.BSDF:
    """Return the Mitsuba BSDF of a material.

    Patterns need `origin`, the origin of translated coordinates in scene coordinates.
    """
    origin = np.zeros(3) if origin is None else origin
    plugin = material.plugin()
    plain: dict[str, object] = {"type": plugin.name}
    varied = {}
    for name, value in plugin.parameters.items():
        match value:
            case Material():
                plain[name] = load(value, origin)
            case np.ndarray():
                plain[name] = value.tolist()
            case bool() | float() | int():
                plain[name] = float(value)
            case _:
                varied[name] = value
    made = mi.load_dict(plain)
    for name, value in varied.items():
        _PLUGINS[plugin.name].vary(made, name, value, origin)
    return made


def absorber() -> mi.BSDF:
    """Return a black material, for receivers."""
    return mi.load_dict({"type": "radiance_plastic", "reflectance": [0, 0, 0]})
