"""Reading of materials given by a formula: plastic, metal, trans, glass, dielectric."""

import numpy as np
from jaxtyping import Float

from clerestory.radiance.arguments import Definition
from clerestory.radiance.function_pattern import FunctionPattern, constant_vector
from clerestory.radiance.pattern_reader import read_vector
from clerestory.scene.composite import Material
from clerestory.scene.material import (
    Dielectric,
    Glass,
    Interface,
    Metal,
    Metal2,
    Plastic,
    Plastic2,
    Trans,
    Trans2,
)

# Radiance's FTINY: elliptical highlights must be rougher than this
_TINY = 1e-6

# Radiance takes the index of a dielectric at this wavelength [nm]
_MIDDLE = 500.0


def plastic(made: Definition) -> Material:
    """Return a plastic or a metal."""
    made.no_strings()
    value = made.reals(5)
    kind = Metal if made.item.kind == "metal" else Plastic
    return kind(
        made.item.name,
        made.share("reflectance", value[:3]),
        made.fraction("specularity", value[3]),
        _roughness(made, value[4]),
        made.source,
    )


def trans(made: Definition) -> Material:
    """Return a translucent sheet."""
    made.no_strings()
    value = made.reals(7)
    return Trans(
        made.item.name,
        made.share("reflectance", value[:3]),
        made.fraction("specularity", value[3]),
        _roughness(made, value[4]),
        made.fraction("transmission", value[5]),
        made.fraction("transmitted specularity", value[6]),
        made.source,
    )


def plastic2(made: Definition) -> Material:
    """Return a plastic or a metal with an elliptical highlight."""
    up = _up(made)
    value = made.reals(6)
    kind = Metal2 if made.item.kind == "metal2" else Plastic2
    return kind(
        made.item.name,
        made.share("reflectance", value[:3]),
        made.fraction("specularity", value[3]),
        _two_roughnesses(made, value[4:6]),
        up,
        made.source,
    )


def trans2(made: Definition) -> Material:
    """Return a translucent sheet with elliptical highlights."""
    up = _up(made)
    value = made.reals(8)
    return Trans2(
        made.item.name,
        made.share("reflectance", value[:3]),
        made.fraction("specularity", value[3]),
        _two_roughnesses(made, value[4:6]),
        made.fraction("transmission", value[6]),
        made.fraction("transmitted specularity", value[7]),
        up,
        made.source,
    )


def glass(made: Definition) -> Material:
    """Return a thin pane."""
    made.no_strings()
    value = made.reals(3, 4)
    index = float(value[3]) if len(value) == 4 else 1.52
    if index < 1:
        raise made.error(f"index of refraction is {index:g}; 1 or more expected")
    colour = made.share("transmissivity", value[:3])
    return Glass(made.item.name, colour, index, made.source)


def dielectric(made: Definition) -> Material:
    """Return a solid that refracts; its dispersion is left out, with a warning."""
    made.no_strings()
    value = made.reals(5)
    if value[4] != 0:
        made.doubt(
            f"Hartmann's constant is {value[4]:g}; light is not dispersed,"
            f" the index is that at {_MIDDLE:g} nm"
        )
    return Dielectric(
        made.item.name,
        _per_metre(made, value[:3]),
        _index(made, value[3] + value[4] / _MIDDLE),
        made.source,
    )


def interface(made: Definition) -> Material:
    """Return the surface between two dielectrics."""
    made.no_strings()
    value = made.reals(8)
    return Interface(
        made.item.name,
        _per_metre(made, value[:3]),
        _index(made, value[3]),
        _per_metre(made, value[4:7]),
        _index(made, value[7]),
        made.source,
    )


def _roughness(made: Definition, value: float) -> float:
    if value < 0:
        raise made.error(f"roughness is {value:g}; 0 or more expected")
    if value > 0.4:
        made.doubt(f"roughness is {value:g}; values above 0.2 are unusual")
    return float(value)


def _two_roughnesses(
    made: Definition, value: Float[np.ndarray, "2"]
) -> Float[np.ndarray, "2"]:
    if value.min() <= _TINY:
        raise made.error(f"roughness is {value.min():g}; more than 0 expected")
    return np.array([_roughness(made, each) for each in value])


def _up(made: Definition) -> Float[np.ndarray, "3"] | FunctionPattern:
    # Unit vector in the scene, or how it varies
    if len(made.item.strings) < 4:
        raise made.error(
            f"{len(made.item.strings)} string arguments;"
            " an up vector, a function file and a transform expected"
        )
    made.oriented(4)
    vector = read_vector(made, made.placed, 0)
    constant = constant_vector(vector)
    return vector if constant is None else made.direction(constant)


def _per_metre(
    made: Definition, value: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "3"]:
    # What passes 1 unit of the file passes 1/scale as many metres; nothing gains light
    passed = np.minimum(made.share("transmissivity", value), 1)
    return np.asarray(passed ** (1 / made.placed.scale))


def _index(made: Definition, value: float) -> float:
    if not 0.1 <= value <= 10:
        raise made.error(f"index of refraction is {value:g}; 0.1 to 10 expected")
    return float(value)
