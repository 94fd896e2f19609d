"""The scene as plain values: materials, surfaces, distant sources.

A surface names its material by a key of `Scene.materials`. Where a file defines a
name twice, the later definition holds for the surfaces read after it, as in
Radiance; both survive here, the later under a key of its own ("wall#2").

Lengths are in metres. The front of a polygon is where its vertices run
counter-clockwise.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from jaxtyping import Float, Int

from clerestory.errors import InputError
from clerestory.scene.composite import (
    BsdfSurface,
    Emitter,
    Illum,
    Material,
    Mirror,
    Mixture,
    Void,
    insert_material,
    same_material,
)
from clerestory.scene.emitter import Glow, Light, Spotlight
from clerestory.scene.material import (
    Dielectric,
    Glass,
    Interface,
    Metal,
    Metal2,
    Plastic,
    Plastic2,
    Source,
    Trans,
    Trans2,
)

__all__ = [
    "BsdfSurface",
    "Cone",
    "Dielectric",
    "DistantSource",
    "Emitter",
    "Glass",
    "Glow",
    "Illum",
    "Interface",
    "Light",
    "Material",
    "Metal",
    "Metal2",
    "Mirror",
    "Mixture",
    "Plastic",
    "Plastic2",
    "Polygon",
    "Ring",
    "Scene",
    "Simple",
    "Source",
    "Sphere",
    "Spotlight",
    "Surface",
    "Trans",
    "Trans2",
    "TriangleMesh",
    "Void",
    "insert_material",
    "same_material",
]


@dataclass(frozen=True, eq=False)
class Polygon:
    """A flat polygon, filled by the even–odd rule; holes hang on seams."""

    vertices: Float[np.ndarray, "vertices 3"]
    material: str
    name: str = ""
    source: Source | None = None

    def __post_init__(self) -> None:
        if (
            self.vertices.ndim != 2
            or self.vertices.shape[1] != 3
            or len(self.vertices) < 3
        ):
            raise InputError(
                f'polygon "{self.name}" has vertices of shape {self.vertices.shape};'
                " at least 3 rows of 3 expected"
            )


@dataclass(frozen=True, eq=False)
class Sphere:
    """A sphere; `inward` turns its front to the centre (Radiance's bubble)."""

    centre: Float[np.ndarray, "3"]
    radius: float
    inward: bool
    material: str
    name: str = ""
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Cone:
    """The side of a truncated cone or cylinder; `inward`: cup or tube."""

    base: Float[np.ndarray, "3"]
    top: Float[np.ndarray, "3"]
    base_radius: float
    top_radius: float
    inward: bool
    material: str
    name: str = ""
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Ring:
    """A flat disc, or a ring when the inner radius is not zero."""

    centre: Float[np.ndarray, "3"]
    normal: Float[np.ndarray, "3"]
    inner_radius: float
    outer_radius: float
    material: str
    name: str = ""
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Many triangles of one material, as one surface.

    Attributes
    ----------
    vertices : [m]
    faces : counter-clockwise as seen from the front
    """

    vertices: Float[np.ndarray, "vertices 3"]
    faces: Int[np.ndarray, "triangles 3"]
    material: str
    name: str = ""
    source: Source | None = None

    def __post_init__(self) -> None:
        low, high = self.faces.min(initial=0), self.faces.max(initial=0)
        if len(self.vertices) == 0 or low < 0 or high >= len(self.vertices):
            raise InputError(
                f'mesh "{self.name}" refers to vertices {low} to {high};'
                f" 0 to {len(self.vertices) - 1} expected"
            )


Surface = Polygon | Sphere | Cone | Ring | TriangleMesh


@dataclass(frozen=True, eq=False)
class DistantSource:
    """A disc of sky, sun or ground at infinity.

    Attributes
    ----------
    direction : unit vector to its centre
    angle_deg : the full angle it subtends, up to 360
    """

    direction: Float[np.ndarray, "3"]
    angle_deg: float
    material: str
    name: str = ""
    source: Source | None = None


# What a primitive other than a polygon describes
Simple = Sphere | Cone | Ring | TriangleMesh | DistantSource


@dataclass(frozen=True, eq=False)
class Scene:
    """Surfaces and the materials they are made of.

    Attributes
    ----------
    materials : by key; each material carries its key as name
    surfaces : in the order read
    distant : sources at infinity

    Raises
    ------
    InputError : a surface is made of a material that is not in the scene

    Examples
    --------
    >>> grey = Plastic("grey", np.array([0.5, 0.5, 0.5]))
    >>> floor = Polygon(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]]), "grey", "floor")
    >>> room = Scene({"grey": grey}, (floor,))
    >>> len((room + room).surfaces)
    2
    """

    materials: Mapping[str, Material] = field(default_factory=dict)
    surfaces: tuple[Surface, ...] = ()
    distant: tuple[DistantSource, ...] = ()

    def __post_init__(self) -> None:
        for item in (*self.surfaces, *self.distant):
            if item.material not in self.materials:
                raise InputError(
                    f'surface "{item.name}" is made of "{item.material}",'
                    " which is not a material of the scene"
                )

    def __add__(self, other: "Scene") -> "Scene":
        """Both scenes in one; equal names of different materials are kept apart."""
        materials = dict(self.materials)
        key = {
            name: insert_material(materials, m) for name, m in other.materials.items()
        }
        return Scene(
            materials,
            self.surfaces + tuple(_renamed(s, key) for s in other.surfaces),
            self.distant + tuple(_renamed(d, key) for d in other.distant),
        )

    def bounds(self) -> Float[np.ndarray, "2 3"]:
        """Lowest and highest corner [m] of the box around all surfaces; NaN if none."""
        if not self.surfaces:
            return np.full((2, 3), np.nan)
        points = np.concatenate([_extent(s) for s in self.surfaces])
        return np.stack([points.min(axis=0), points.max(axis=0)])


_Item = TypeVar("_Item", bound=Surface | DistantSource)


def _renamed(item: _Item, key: dict[str, str]) -> _Item:
    new = key[item.material]
    return item if new == item.material else replace(item, material=new)


def _extent(surface: Surface) -> Float[np.ndarray, "points 3"]:
    # Points whose box holds the surface
    match surface:
        case Polygon() | TriangleMesh():
            return surface.vertices
        case Sphere():
            return surface.centre + np.outer([-1, 1], np.full(3, surface.radius))
        case Cone():
            return np.concatenate(
                [
                    _disc_extent(
                        surface.base, surface.top - surface.base, surface.base_radius
                    ),
                    _disc_extent(
                        surface.top, surface.top - surface.base, surface.top_radius
                    ),
                ]
            )
        case Ring():
            return _disc_extent(surface.centre, surface.normal, surface.outer_radius)


def _disc_extent(
    centre: Float[np.ndarray, "3"], normal: Float[np.ndarray, "3"], radius: float
) -> Float[np.ndarray, "2 3"]:
    axis = normal / np.linalg.norm(normal)
    return centre + np.outer([-1, 1], radius * np.sqrt(np.clip(1 - axis**2, 0, 1)))
