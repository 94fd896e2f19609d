"""Surface primitives of Radiance scene files: reading, checks and writing."""

import warnings
from collections.abc import Callable, Mapping

import numpy as np
from jaxtyping import Bool

from clerestory.checks import require
from clerestory.directions import unit
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.radiance.statements import PolygonRun
from clerestory.scene.material import Specification
from clerestory.scene.model import Cone, DistantSource, Polygon, Ring, Simple, Sphere
from clerestory.scene.primitive import Arguments, Primitive
from clerestory.scene.surface import area_vectors
from clerestory.scene.transform import LARGEST

# Planarity tolerances: relative to the polygon's size, and for coordinates that are
# rounded to six decimals [m]
_ROUNDING, _SIX_DECIMALS = 1e-4, 2e-6

# Length up to which a length is treated as zero (Radiance's FTINY) [m]
_TINY = 1e-6

# Maximum number of polygons per kind of warning that are reported individually
_NAMED = 5


def checked(run: PolygonRun, *, file: str) -> PolygonRun:
    """Return the polygons of non-zero area, without a last vertex equal to the first.

    Warnings are given for polygons of zero area, which Radiance ignores too, and for
    non-planar polygons, with the largest distance of a vertex from the mean plane.
    """
    _refuse_beyond_measure(run, file)
    run = _without_closing_vertex(run)
    normal = area_vectors(run.vertices, run.first)
    area = np.linalg.norm(normal, axis=1)
    middle = _per_polygon(np.add, run.vertices, run) / np.diff(run.first)[:, None]
    away = run.vertices - np.repeat(middle, np.diff(run.first), axis=0)
    size = _per_polygon(np.maximum, np.linalg.norm(away, axis=1), run)

    # An area is zero if it is within the rounding error of the coordinates
    magnitude = _per_polygon(np.maximum, np.abs(run.vertices).max(axis=1), run)
    flat = area <= 1e-15 * magnitude * size + 1e-300
    _warn(run, flat, file, lambda i: "it has no area and is omitted")

    with np.errstate(invalid="ignore", divide="ignore"):
        plane = np.repeat(normal / area[:, None], np.diff(run.first), axis=0)
        deviation = _per_polygon(np.maximum, np.abs((away * plane).sum(axis=1)), run)
    bent = ~flat & (deviation > _ROUNDING * size + _SIX_DECIMALS)
    _warn(
        run,
        bent,
        file,
        lambda i: (
            f"a vertex is {deviation[i]:.3g} m off its plane; a planar polygon expected"
        ),
    )
    return _subset(run, ~flat) if flat.any() else run


def _refuse_beyond_measure(run: PolygonRun, file: str) -> None:
    beyond = np.flatnonzero(np.abs(run.vertices).max(axis=1) > LARGEST)
    if len(beyond):
        i = int(np.searchsorted(run.first, beyond[0], side="right")) - 1
        message = f'polygon "{run.name[i]}": a coordinate exceeds {LARGEST:.0e} m'
        raise InputError(message, file=file, line=run.source[i].line)


def _without_closing_vertex(run: PolygonRun) -> PolygonRun:
    # Removes a last vertex equal to the first, as in Radiance
    last = run.first[1:] - 1
    length = np.diff(run.first)
    gap = run.vertices[run.first[:-1]] - run.vertices[last]
    closing = (length > 3) & (np.linalg.norm(gap, axis=1) <= _TINY)
    if not closing.any():
        return run
    keep = np.ones(len(run.vertices), dtype=bool)
    keep[last[closing]] = False
    first = np.concatenate([[0], np.cumsum(length - closing)])
    return PolygonRun(run.modifier, run.name, run.source, first, run.vertices[keep])


def _subset(run: PolygonRun, keep: Bool[np.ndarray, " polygons"]) -> PolygonRun:
    length = np.diff(run.first)
    chosen = np.flatnonzero(keep)
    return PolygonRun(
        [run.modifier[i] for i in chosen],
        [run.name[i] for i in chosen],
        [run.source[i] for i in chosen],
        np.concatenate([[0], np.cumsum(length[keep])]),
        run.vertices[np.repeat(keep, length)],
    )


def _per_polygon(
    operation: np.ufunc, values: np.ndarray, run: PolygonRun
) -> np.ndarray:
    return np.asarray(operation.reduceat(values, run.first[:-1], axis=0))


def _warn(
    run: PolygonRun,
    doubtful: Bool[np.ndarray, " polygons"],
    file: str,
    message: Callable[[int], str],
) -> None:
    found = np.flatnonzero(doubtful).tolist()
    for i in found[:_NAMED]:
        text = f'{file}:{run.source[i].line}: polygon "{run.name[i]}": {message(i)}'
        warnings.warn(text, ClerestoryWarning, stacklevel=2)
    if len(found) > _NAMED:
        text = f"{file}: {len(found) - _NAMED} more polygons of this kind"
        text += f", the first on line {run.source[found[_NAMED]].line}"
        warnings.warn(text, ClerestoryWarning, stacklevel=2)


def surface(item: Primitive, *, file: str) -> Simple | None:
    """Return the surface defined by a primitive other than a polygon.

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
    value = given.reals(7 if given.item.kind in ("cylinder", "tube") else 8)
    radii, inward = value[6:], given.item.kind in ("cup", "tube")
    if np.abs(radii).max() <= _TINY or radii.min() < -_TINY < _TINY < radii.max():
        listed = ", ".join(f"{r:g}" for r in radii)
        raise given.error(f"radius is {listed}; a positive number expected")
    if radii.min() < -_TINY:
        least = f"radius is {radii.min():g}"
        given.doubt(f"{least}; the surface is inverted, as in Radiance")
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
    """Return the Radiance type and arguments of a surface."""
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
