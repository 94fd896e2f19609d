"""Parameters of plugins, made opaque to the compiler.

Each value of a literal parameter would require a separate kernel; all instances with
opaque parameters share one kernel. An instance with a pattern has code of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import drjit as dr
import mitsuba as mi


class Paint:
    """A colour with an optional pattern.

    The pattern is a function of an interaction that returns a multiplier of the colour.
    """

    def __init__(self, props, name: str, default: float):
        self.colour = colour(props, name, default)
        self.pattern: Callable[[Any], mi.Color3f] | None = None

    def at(self, si) -> mi.Color3f:
        """Return the colour at a point of the surface."""
        if self.pattern is None:
            return self.colour
        return self.colour * self.pattern(si)


def colour(props, name: str, default: float):
    """Return an RGB parameter, given as three numbers or as Mitsuba's rgb."""
    value = props.get(name, [default] * 3)
    if isinstance(value, mi.Texture):
        value = value.mean_rgb()
    made = mi.Color3f([float(each) for each in value])
    dr.make_opaque(made)
    return made


def number(props, name: str, default: float):
    """Return a scalar parameter."""
    made = mi.Float(float(props.get(name, default)))
    dr.make_opaque(made)
    return made
