"""Radiance's materials as Mitsuba BSDF plugins, usable in anyone's scene.

Each plugin has its file, which says how it is described. They act alike on either
side of a surface, as Radiance's do, but for `radiance_mirror` and the two media of
`radiance_dielectric`. Parameters are opaque to the compiler, so that many instances
share one kernel.

`register` defines the plugins for the variant in use; Mitsuba's base class is another
one in each variant. `plugin` describes a material of a scene, `load` makes it.
"""

from __future__ import annotations

import mitsuba as mi

from clerestory.engine.materials import (
    dielectric,
    glass,
    mirror,
    mixture,
    plastic,
    textured,
    trans,
)
from clerestory.engine.materials.coat import lamp_context
from clerestory.engine.materials.credit import credited, glossy_context
from clerestory.engine.materials.describe import load, plugin

__all__ = [
    "absorber",
    "credited",
    "glossy_context",
    "lamp_context",
    "load",
    "plugin",
    "register",
]

_PLUGINS = {
    "radiance_plastic": plastic,
    "radiance_trans": trans,
    "radiance_glass": glass,
    "radiance_dielectric": dielectric,
    "radiance_mirror": mirror,
    "radiance_mixture": mixture,
    "radiance_textured": textured,
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


def absorber() -> mi.BSDF:
    """Return a material that reflects nothing, for receivers."""
    return mi.load_dict({"type": "radiance_plastic", "reflectance": [0, 0, 0]})
