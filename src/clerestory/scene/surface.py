"""Surfaces, and sources at infinity.

A surface names its material by the key in the scene. Lengths are in metres. The
vertices of a polygon are counter-clockwise as seen from its front.
"""

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Faces, Vector, Vertices
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.scene.material import Source
from clerestory.scene.transform import LARGEST, Transform


@dataclass(frozen=True, eq=False)
class Polygon:
    """A planar polygon, filled by the even–odd rule; seams connect holes to the rim."""

    vertices: Vertices
    material: str
    name: str = ""
    source: Source | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        shape = self.vertices.shape
        if len(shape) != 2 or shape[1] != 3 or shape[0] < 3:
            raise InputError(
                f'polygon "{self.name}" has vertices of shape {shape};'
                " at least 3 rows of 3 expected"
            )
        require(
            bool(np.abs(self.vertices).max() <= LARGEST),
            f'polygon "{self.name}": a coordinate exceeds {LARGEST:.0e} m',
        )


@dataclass(frozen=True, eq=False)
class Sphere:
    """A sphere; if `inward`, the front faces the centre (Radiance's bubble)."""

    centre: Vector
    radius: float
    inward: bool
    material: str
    name: str = ""
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Cone:
    """The lateral surface of a truncated cone; if `inward`, the front is inside."""

    base: Vector
    top: Vector
    base_radius: float
    top_radius: float
    inward: bool
    material: str
    name: str = ""
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Ring:
    """A disc, or an annulus if the inner radius is not zero."""

    centre: Vector
    normal: Vector
    inner_radius: float
    outer_radius: float
    material: str
    name: str = ""
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Triangles of one material, counter-clockwise as seen from the front."""

    vertices: Vertices
    faces: Faces
    material: str
    name: str = ""
    source: Source | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        low = np.minimum.reduce(self.faces, axis=None, initial=0)
        high = np.maximum.reduce(self.faces, axis=None, initial=0)
        if not 0 <= low <= high < len(self.vertices):
            raise InputError(
                f'mesh "{self.name}" refers to vertices {low} to {high};'
                f" 0 to {len(self.vertices) - 1} expected"
            )
        size = np.abs(self.vertices)
        if not np.maximum.reduce(size, axis=None, initial=0) <= LARGEST:
            message = f'mesh "{self.name}": a coordinate exceeds {LARGEST:.0e} m'
            raise InputError(message)


Surface = Polygon | Sphere | Cone | Ring | TriangleMesh


@dataclass(frozen=True, eq=False)
class DistantSource:
    """A source at infinity (sky, sun or ground) with the full angle `angle_deg`."""

    direction: Vector
    angle_deg: float
    material: str
    name: str = ""
    source: Source | None = None


Simple = Sphere | Cone | Ring | TriangleMesh | DistantSource


def extent(surface: Surface) -> Float[np.ndarray, "points 3"]:
    """Return points [m] whose bounding box contains the surface."""
    match surface:
        case Polygon() | TriangleMesh():
            return surface.vertices
        case Sphere():
            return surface.centre + np.outer([-1, 1], np.full(3, surface.radius))
        case Cone():
            axis = surface.top - surface.base
            base = _disc_extent(surface.base, axis, surface.base_radius)
            return np.vstack(
                [base, _disc_extent(surface.top, axis, surface.top_radius)]
            )
        case Ring():
            return _disc_extent(surface.centre, surface.normal, surface.outer_radius)


_Item = TypeVar("_Item", bound=Surface | DistantSource)


def transformed(
    surface: _Item, transform: Transform, *, inverted: bool = False
) -> _Item:
    """Return a transformed surface or source; `inverted` swaps front and back."""
    move, scale = transform, transform.scale
    reverse = move.mirrored != inverted
    changes: dict[str, object]
    match surface:
        case Polygon():
            vertices = move.points(surface.vertices)
            changes = {"vertices": vertices[::-1] if reverse else vertices}
        case Sphere():
            changes = {
                "centre": move.points(surface.centre),
                "radius": surface.radius * scale,
                "inward": surface.inward != inverted,
            }
        case Cone():
            changes = {
                "base": move.points(surface.base),
                "top": move.points(surface.top),
                "base_radius": surface.base_radius * scale,
                "top_radius": surface.top_radius * scale,
                "inward": surface.inward != inverted,
            }
        case Ring():
            facing = -1 if inverted else 1
            changes = {
                "centre": move.points(surface.centre),
                "normal": move.vectors(surface.normal) * facing / scale,
                "inner_radius": surface.inner_radius * scale,
                "outer_radius": surface.outer_radius * scale,
            }
        case TriangleMesh():
            faces = surface.faces[:, ::-1] if reverse else surface.faces
            changes = {"vertices": move.points(surface.vertices), "faces": faces}
        case DistantSource():
            changes = {"direction": move.vectors(surface.direction) / scale}
    return replace(surface, **changes)  # type: ignore[arg-type]


def _disc_extent(
    centre: Vector, normal: Vector, radius: float
) -> Float[np.ndarray, "2 3"]:
    axis = normal / np.linalg.norm(normal)
    return centre + np.outer([-1, 1], radius * np.sqrt(np.clip(1 - axis**2, 0, 1)))


def area_vector(vertices: Vertices) -> Vector:
    """Return a polygon's normal by Newell's method, with the area [m²] as length."""
    local = vertices - vertices[0]
    return np.asarray(np.cross(local, np.roll(local, -1, axis=0)).sum(axis=0) / 2)


def surface_label(surface: Surface) -> str:
    """File, line, type and name of a surface as text."""
    kind, source = type(surface).__name__.lower(), surface.source
    place = f"{source.file}:{source.line}: " if source and source.file else ""
    return f'{place}{kind} "{surface.name}"'


def is_parallelogram(vertices: Vertices) -> bool:
    """Whether the diagonals of a quadrilateral bisect each other, within 1e-6.

    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> is_parallelogram(square + 1e7), is_parallelogram(square[[0, 2, 1, 3]])
    (True, False)
    """
    a, b, c, d = vertices - vertices[0]
    largest = max(np.abs(b).max(), np.abs(d).max())
    return bool(np.abs(a + c - b - d).max() <= 1e-6 * largest)


def area_vectors(
    vertices: Vertices, first: np.ndarray
) -> Float[np.ndarray, "polygons 3"]:
    """Return the normals of polygons, with the areas [m²] as lengths."""
    length = np.diff(first)
    local = vertices - np.repeat(vertices[first[:-1]], length, axis=0)
    following = np.roll(local, -1, axis=0)
    following[first[1:] - 1] = local[first[:-1]]
    return np.add.reduceat(np.cross(local, following) / 2, first[:-1], axis=0)
