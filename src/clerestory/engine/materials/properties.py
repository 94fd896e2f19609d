"""Parameters of plugins, made opaque to the compiler.

Literal parameters would give each instance its own code; opaque ones let any number
of instances share one kernel.
"""

import drjit as dr
import mitsuba as mi


def colour(props, name: str, default: float):
    """Return an RGB parameter, given as three numbers or as Mitsuba's rgb."""
    value = props.get(name, [default] * 3)
    if isinstance(value, mi.Texture):
        value = value.mean_rgb()
    made = mi.Color3f([float(each) for each in value])
    dr.make_opaque(made)
    return made


def number(props, name: str, default: float):
    """Return a parameter that is one number."""
    made = mi.Float(float(props.get(name, default)))
    dr.make_opaque(made)
    return made
