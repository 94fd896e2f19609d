"""Reading and writing of surface primitives of Radiance scene files."""

from collections.abc import Callable, Mapping

import numpy as np

from clerestory.checks import require
from clerestory.directions import unit
from clerestory.scene.material import Specification
from clerestory.scene.model import Cone, DistantSource, Polygon, Ring, Simple, Sphere
from clerestory.scene.primitive import Arguments, Primitive

# Radiance's FTINY: lengths up to it are treated as zero
_TINY = 1e-6


def surface(item: Primitive, *, file: str) -> Simple | None:
    """Return the surface of a primitive other than a polygon.

    Returns None, with a warning, if the surface has no extent.
    """
    given = Arguments(item, file)
    if item.kind not in SURFACES:
        known = ", ".join(["polygon", *SURFACES])
        raise given.error(f"unsupported type; one of {known} expected")
    with given.located():
        return SURFACES[item.kind](given)


def _sphere(given: Arguments) -> Simple | None:
    value = given.reals(4)
    radius, inward = float(value[3]), given.item.kind == "bubble"
    if abs(radius) <= _TINY:
        given.doubt("the radius is zero; the surface is omitted")
        return None
    if radius < 0:
        given.doubt(f"radius is {radius:g}; the surface is inverted, as in Radiance")
        radius, inward = -radius, not inward
    return Sphere(value[:3], radius, inward, *given.labels)


def _cone(given: Arguments) -> Simple | None:
    straight = given.item.kind in ("cylinder", "tube")
    value = given.reals(7 if straight else 8)
    radii, inward = value[6:], given.item.kind in ("cup", "tube")
    if np.abs(radii).max() <= _TINY or radii.min() < -_TINY < _TINY < radii.max():
        listed = ", ".join(f"{r:g}" for r in radii)
        raise given.error(f"radius is {listed}; a positive number expected")
    if radii.min() < -_TINY:
        given.doubt(
            f"radius is {radii.min():g}; the surface is inverted, as in Radiance",
        )
        radii, inward = -radii, not inward
    if np.linalg.norm(value[3:6] - value[:3]) <= _TINY:
        given.doubt("the two ends coincide; the surface is omitted")
        return None
    first, last = float(abs(radii[0])), float(abs(radii[-1]))
    return Cone(value[:3], value[3:6], first, last, inward, *given.labels)


def _ring(given: Arguments) -> Simple | None:
    value = given.reals(8)
    inner, outer = sorted(map(float, value[6:]))
    require(
        0 <= inner < outer - _TINY,
        f"radii are {inner:g} and {outer:g}; 0 ≤ inner < outer expected",
    )
    return Ring(value[:3], unit(value[3:6]), inner, outer, *given.labels)


def _source(given: Arguments) -> Simple | None:
    value = given.reals(4)
    given.full_angle(value[3])
    return DistantSource(unit(value[:3]), float(value[3]), *given.labels)


SURFACES: Mapping[str, Callable[[Arguments], Simple | None]] = {
    **dict.fromkeys(("sphere", "bubble"), _sphere),
    **dict.fromkeys(("cone", "cup", "cylinder", "tube"), _cone),
    "ring": _ring,
    "source": _source,
}


def specification(
    surface: Polygon | Sphere | Cone | Ring | DistantSource,
) -> Specification:
    """Return the type and arguments of a surface in Radiance."""
    match surface:
        case Polygon():
            return Specification("polygon", (), (*surface.vertices.ravel(),))
        case Sphere():
            kind = "bubble" if surface.inward else "sphere"
            return Specification(kind, (), (*surface.centre, surface.radius))
        case Cone():
            ends = [*surface.base, *surface.top]
            if surface.base_radius == surface.top_radius:
                kind = "tube" if surface.inward else "cylinder"
                return Specification(kind, (), (*ends, surface.base_radius))
            radii = surface.base_radius, surface.top_radius
            kind = "cup" if surface.inward else "cone"
            return Specification(kind, (), (*ends, *radii))
        case Ring():
            radii = surface.inner_radius, surface.outer_radius
            return Specification("ring", (), (*surface.centre, *surface.normal, *radii))
        case DistantSource():
            return Specification("source", (), (*surface.direction, surface.angle_deg))
