"""Materials of scenes as Mitsuba BSDF plugins, usable in any Mitsuba scene.

Each plugin has one file, found by its presence in this folder. The file defines the
plugin's name (`PLUGIN`), its class (`define`, because each variant of Mitsuba has a
base class of its own) and how it takes parameters that are functions or BSDFs (`vary`).
Radiance's materials act alike on both sides of a surface, except `radiance_mirror` and
the two media of `radiance_dielectric`.

Parameters are opaque to the compiler, so that many instances share one kernel.
"""

from __future__ import annotations

import importlib
import pkgutil
from typing import TYPE_CHECKING

import mitsuba as mi
import numpy as np

from clerestory.engine.materials.coat import lamp_context
from clerestory.engine.materials.glossy_share import credited, glossy_context
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
    """Define the plugins for the current variant, once."""
    variant = mi.variant()
    if variant in _registered:
        return
    for name, module in _PLUGINS.items():
        mi.register_bsdf(name, module.define())
    _registered.add(variant)


def load(material: Material, origin: np.ndarray | None = None) -> mi.BSDF:
    """Return the Mitsuba BSDF that renders a material.

    Parameters
    ----------
    origin : point of the scene that is at the device's origin [m]; None: the same point
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
    """Return a material that reflects nothing, for receivers."""
    return mi.load_dict({"type": "radiance_plastic", "reflectance": [0, 0, 0]})
