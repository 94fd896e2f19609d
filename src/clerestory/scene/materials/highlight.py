"""Gaussian highlights of plastic, metal and trans.

One roughness value gives an isotropic highlight; two values and an up vector give an
anisotropic highlight (Radiance's plastic2, metal2, trans2).

References: G. Ward, "Measuring and modeling anisotropic reflection", SIGGRAPH 1992;
"The RADIANCE 6.0 Synthetic Imaging System" (ray.html), section 2.1.3.
"""

from typing import Protocol

import numpy as np
from jaxtyping import Float

from clerestory.scene.material import Colour, Parameter, Specification, Vector
from clerestory.scene.pattern import Pattern
from clerestory.scene.primitive import Definition

# Minimum roughness of anisotropic highlights (Radiance's FTINY)
_TINY = 1e-6

# Rms facet slope; for an anisotropic highlight, along `up` and perpendicular to it
Roughness = float | Float[np.ndarray, "2"]

# Vector in scene coordinates; pattern: vector in the coordinates of a function
Up = Vector | Pattern | None


class Glossy(Protocol):
    """A material with a Gaussian highlight."""

    @property
    def reflectance(self) -> Colour: ...
    @property
    def specularity(self) -> float: ...
    @property
    def roughness(self) -> Roughness: ...
    @property
    def up(self) -> Up: ...


def highlight_parameters(
    material: Glossy,
) -> dict[str, Parameter]:
    """Return the plugin parameters that all glossy materials have in common."""
    first, *second = np.atleast_1d(material.roughness).tolist()
    shared: dict[str, Parameter] = {
        "reflectance": material.reflectance,
        "specularity": material.specularity,
        "roughness": first,
    }
    if material.up is not None:
        shared |= {"roughness_v": second[0], "up": material.up}
    return shared


def highlight_specification(
    kind: str, material: Glossy, *further: float
) -> Specification:
    """Return the type and arguments of a glossy material.

    Parameters
    ----------
    kind : type of the material with an isotropic highlight
    further : arguments after the roughness
    """
    gloss = material.specularity, *np.atleast_1d(material.roughness).tolist()
    reals = (*material.reflectance, *gloss, *further)
    if material.up is None:
        return Specification(kind, (), reals)
    up = (material.up,) if isinstance(material.up, Pattern) else (*material.up,)
    return Specification(f"{kind}2", (*up, "."), reals)


def read_highlight(
    given: Definition, further: int
) -> tuple[tuple[Colour, float, Roughness], Up, Float[np.ndarray, " further"]]:
    """Return reflectance, specularity and roughness; up vector; further arguments.

    Parameters
    ----------
    further : number of arguments after the roughness
    """
    elliptical = given.item.kind.endswith("2")
    up = _up(given) if elliptical else None
    if not elliptical:
        given.no_strings()
    value = given.reals((6 if elliptical else 5) + further)
    reflectance = given.share("reflectance", value[:3])
    specularity = given.fraction("specularity", value[3])
    if not elliptical:
        roughness: Roughness = _roughness(given, value[4])
        return (reflectance, specularity, roughness), up, value[5:]
    if value[4:6].min() <= _TINY:
        raise given.error(f"roughness is {value[4:6].min():g}; more than 0 expected")
    roughness = np.array([_roughness(given, each) for each in value[4:6]])
    return (reflectance, specularity, roughness), up, value[6:]


def _roughness(given: Definition, value: float) -> float:
    if value < 0:
        raise given.error(f"roughness is {value:g}; 0 or more expected")
    if value > 0.4:
        given.doubt(f"roughness is {value:g}; values above 0.2 are unusual")
    return float(value)


def _up(given: Definition) -> Vector | Pattern:
    if len(given.item.strings) < 4:
        raise given.error(
            f"{len(given.item.strings)} string arguments;"
            " an up vector, a function file and a transform expected"
        )
    given.oriented(4)
    vector = given.vector(0, given.placed)
    return vector if isinstance(vector, Pattern) else given.direction(vector)
