"""Primitives of the scene language as values: one function for each type.

To read one more material, write its function and add it to `MATERIALS`.
"""

import warnings
from collections.abc import Callable, Mapping

import numpy as np
from jaxtyping import Float

from clerestory.directions import unit
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.scene.model import (
    Cone,
    DistantSource,
    Glass,
    Glow,
    Light,
    Material,
    Plastic,
    Ring,
    Simple,
    Source,
    Sphere,
)
from clerestory.scene.statements import Primitive
from clerestory.scene.xform import LARGEST

# Radiance's FTINY: what is shorter has no length
_TINY = 1e-6


def material(item: Primitive, *, file: str) -> Material:
    """Return the material that a primitive defines.

    Raises
    ------
    InputError : a type that is not read yet, or arguments that do not fit it
    """
    if item.kind not in MATERIALS:
        raise _error(
            item, file, f"this type is not supported; {', '.join(MATERIALS)} are"
        )
    return MATERIALS[item.kind](item, file)


def surface(item: Primitive, *, file: str) -> Simple | None:
    """Return the surface that a primitive other than a polygon describes.

    Returns None, with a warning, where it has no extent.

    Raises
    ------
    InputError : a type that is not read, or arguments that do not fit it
    """
    if item.kind not in SURFACES:
        known = ", ".join(["polygon", *SURFACES])
        raise _error(item, file, f"this type is not supported; {known} are")
    return SURFACES[item.kind](item, file)


def _plastic(item: Primitive, file: str) -> Material:
    value = _reals(item, file, 5)
    colour = _share(item, file, "reflectance", value[:3])
    specularity, roughness = value[3:]
    if not 0 <= specularity <= 1:
        raise _error(item, file, f"specularity is {specularity:g}; 0 to 1 expected")
    if roughness < 0:
        raise _error(item, file, f"roughness is {roughness:g}; 0 or more expected")
    if roughness > 0.4:
        _doubt(item, file, f"roughness is {roughness:g}; values above 0.2 are unusual")
    return Plastic(
        item.name, colour, float(specularity), float(roughness), Source(file, item.line)
    )


def _glass(item: Primitive, file: str) -> Material:
    value = _reals(item, file, 3, 4)
    index = float(value[3]) if len(value) == 4 else 1.52
    if index < 1:
        raise _error(
            item, file, f"index of refraction is {index:g}; 1 or more expected"
        )
    colour = _share(item, file, "transmissivity", value[:3])
    return Glass(item.name, colour, index, Source(file, item.line))


def _glow(item: Primitive, file: str) -> Material:
    value = _reals(item, file, 4)
    colour = _radiance(item, file, value[:3])
    return Glow(item.name, colour, float(value[3]), Source(file, item.line))


def _light(item: Primitive, file: str) -> Material:
    colour = _radiance(item, file, _reals(item, file, 3))
    return Light(item.name, colour, Source(file, item.line))


def _sphere(item: Primitive, file: str) -> Simple | None:
    value = _reals(item, file, 4)
    radius, inward = float(value[3]), item.kind == "bubble"
    if abs(radius) <= _TINY:
        _doubt(item, file, "its radius is zero; it is left out")
        return None
    if radius < 0:
        _doubt(item, file, f"radius is {radius:g}; its front is turned, as in Radiance")
        radius, inward = -radius, not inward
    source = Source(file, item.line)
    return Sphere(value[:3], radius, inward, item.modifier, item.name, source)


def _cone(item: Primitive, file: str) -> Simple | None:
    straight = item.kind in ("cylinder", "tube")
    value = _reals(item, file, 7 if straight else 8)
    radii, inward = value[6:], item.kind in ("cup", "tube")
    if np.abs(radii).max() <= _TINY or radii.min() < -_TINY < _TINY < radii.max():
        given = ", ".join(f"{r:g}" for r in radii)
        raise _error(item, file, f"radius is {given}; a positive number expected")
    if radii.min() < -_TINY:
        _doubt(
            item,
            file,
            f"radius is {radii.min():g}; its front is turned, as in Radiance",
        )
        radii, inward = -radii, not inward
    if np.linalg.norm(value[3:6] - value[:3]) <= _TINY:
        _doubt(item, file, "its two ends coincide; it is left out")
        return None
    first, last = float(abs(radii[0])), float(abs(radii[-1]))
    source = Source(file, item.line)
    return Cone(
        value[:3], value[3:6], first, last, inward, item.modifier, item.name, source
    )


def _ring(item: Primitive, file: str) -> Simple | None:
    value = _reals(item, file, 8)
    inner, outer = sorted(map(float, value[6:]))
    if inner < 0 or outer - inner <= _TINY:
        raise _error(
            item, file, f"radii are {inner:g} and {outer:g}; 0 ≤ inner < outer expected"
        )
    normal = _direction(item, file, value[3:6])
    source = Source(file, item.line)
    return Ring(value[:3], normal, inner, outer, item.modifier, item.name, source)


def _source(item: Primitive, file: str) -> Simple | None:
    value = _reals(item, file, 4)
    if not 0 < value[3] <= 360:
        raise _error(
            item, file, f"angle is {value[3]:g}°; more than 0 and up to 360 expected"
        )
    direction, angle = _direction(item, file, value[:3]), float(value[3])
    return DistantSource(
        direction, angle, item.modifier, item.name, Source(file, item.line)
    )


MATERIALS: Mapping[str, Callable[[Primitive, str], Material]] = {
    "plastic": _plastic,
    "glass": _glass,
    "glow": _glow,
    "light": _light,
}
SURFACES: Mapping[str, Callable[[Primitive, str], Simple | None]] = {
    "sphere": _sphere,
    "bubble": _sphere,
    "cone": _cone,
    "cup": _cone,
    "cylinder": _cone,
    "tube": _cone,
    "ring": _ring,
    "source": _source,
}


def _reals(item: Primitive, file: str, *counts: int) -> Float[np.ndarray, " numbers"]:
    # The numbers, if as many as the type takes
    expected = " or ".join(map(str, counts))
    if item.strings:
        raise _error(item, file, f"{len(item.strings)} string arguments; none expected")
    if len(item.reals) not in counts:
        raise _error(item, file, f"{len(item.reals)} numbers; {expected} expected")
    value = np.array(item.reals)
    if np.abs(value).max() > LARGEST:
        raise _error(item, file, f"a number beyond {LARGEST:.0e}")
    return value


def _share(
    item: Primitive, file: str, what: str, colour: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "3"]:
    if colour.min() < 0:
        raise _error(item, file, f"{what} is {colour.min():g}; 0 to 1 expected")
    if colour.max() > 1:
        _doubt(
            item,
            file,
            f"{what} is {colour.max():g}, so it makes light; 0 to 1 expected",
        )
    return colour


def _radiance(
    item: Primitive, file: str, colour: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "3"]:
    if colour.min() < 0:
        raise _error(item, file, f"radiance is {colour.min():g}; 0 or more expected")
    return colour


def _direction(
    item: Primitive, file: str, vector: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "3"]:
    length = np.linalg.norm(vector)
    if not 0 < length < np.inf:
        raise _error(item, file, "its direction has no length")
    return unit(vector)


def _error(item: Primitive, file: str, message: str) -> InputError:
    return InputError(
        f'{item.kind} "{item.name}": {message}', file=file, line=item.line
    )


def _doubt(item: Primitive, file: str, message: str) -> None:
    text = f'{file}:{item.line}: {item.kind} "{item.name}": {message}'
    warnings.warn(text, ClerestoryWarning, stacklevel=2)
