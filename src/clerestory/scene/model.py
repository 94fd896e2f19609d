"""The scene as plain values: materials, surfaces, distant sources.

A surface names its material by a key of `Scene.materials`. Where a file defines a
name twice, the later definition holds for the surfaces read after it, as in
Radiance; both survive here, the later under a key of its own ("wall#2").

Materials, emitters and surfaces have files of their own and are all found here.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError
from clerestory.scene.composite import (
    BsdfSurface,
    Emitter,
    Illum,
    Material,
    Mirror,
    Mixture,
    Patterned,
    Textured,
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
from clerestory.scene.surface import (
    Cone,
    DistantSource,
    Polygon,
    Ring,
    Simple,
    Sphere,
    Surface,
    TriangleMesh,
    extent,
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
    "Patterned",
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
    "Textured",
    "Trans",
    "Trans2",
    "TriangleMesh",
    "Void",
    "insert_material",
    "same_material",
]

# Sines of angles below this are none (Radiance's FTINY)
_PARALLEL = 1e-6


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
    InputError : a surface is made of a material that is not in the scene, or the up
        vector of its BSDF stands upright on it

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
            if isinstance(item, Polygon | Ring):
                _check_up(item, self.materials[item.material])

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
        points = np.concatenate([extent(s) for s in self.surfaces])
        return np.stack([points.min(axis=0), points.max(axis=0)])


def _check_up(surface: Polygon | Ring, material: Material) -> None:
    # The up vector of a BSDF, laid into the surface, must point somewhere
    match material:
        case Mixture():
            _check_up(surface, material.foreground)
            _check_up(surface, material.background)
        case Textured():
            _check_up(surface, material.base)
        case Mirror(alternate=other) | Illum(alternate=other) if other is not None:
            _check_up(surface, other)
        case BsdfSurface():
            normal = _normal(surface)
            up = material.up @ material.transform
            across = np.linalg.norm(np.cross(up, normal))
            if across < _PARALLEL * np.linalg.norm(up) * np.linalg.norm(normal):
                source = surface.source
                raise InputError(
                    f'"{surface.name}": the up vector of BSDF "{material.name}" is'
                    " along its normal; a vector that points up along the surface"
                    " expected",
                    file=source.file if source else None,
                    line=source.line if source else None,
                )


def _normal(surface: Polygon | Ring) -> Float[np.ndarray, "3"]:
    # Normal, of any length
    if isinstance(surface, Ring):
        return surface.normal
    around = surface.vertices - surface.vertices[0]
    normal: np.ndarray = np.cross(around, np.roll(around, -1, axis=0)).sum(axis=0)
    return normal


_Item = TypeVar("_Item", bound=Surface | DistantSource)


def _renamed(item: _Item, key: dict[str, str]) -> _Item:
    new = key[item.material]
    return item if new == item.material else replace(item, material=new)
