"""Scenes: materials, surfaces and distant sources.

A surface refers to its material by a key of `Scene.materials`. If scene files define a
name twice, the later definition applies to the surfaces after it, as in Radiance; the
scene contains both materials, the later one under a numbered key ("wall#2").
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from jaxtyping import Float

from clerestory.argument_types import checked_fields
from clerestory.bands import RGB, Bands
from clerestory.brief_repr import brief
from clerestory.errors import InputError
from clerestory.scene.material import (
    Colour,
    Emitter,
    Material,
    Source,
    colours,
    error_at,
    insert_material,
    parts,
    require_few_parts,
    same_material,
)
from clerestory.scene.materials.brtd import FunctionSheet
from clerestory.scene.materials.bsdf_surface import BsdfSurface
from clerestory.scene.materials.dielectric import Dielectric, Interface
from clerestory.scene.materials.emitters import Glow, Illum, Light, Spotlight
from clerestory.scene.materials.glass import Glass
from clerestory.scene.materials.mirror import Mirror
from clerestory.scene.materials.mixture import Mixture, Void
from clerestory.scene.materials.modified import Patterned, Textured
from clerestory.scene.materials.plastic import Metal, Plastic
from clerestory.scene.materials.trans import Trans
from clerestory.scene.surface import (
    Cone,
    DistantSource,
    Polygon,
    Ring,
    Simple,
    Sphere,
    Surface,
    TriangleMesh,
    area_vector,
    extent,
)

__all__ = [
    "BsdfSurface",
    "Cone",
    "Dielectric",
    "DistantSource",
    "Emitter",
    "FunctionSheet",
    "Glass",
    "Glow",
    "Illum",
    "Interface",
    "Light",
    "Material",
    "Metal",
    "Mirror",
    "Mixture",
    "Patterned",
    "Plastic",
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
    "TriangleMesh",
    "Void",
    "display_colour",
    "insert_material",
    "same_material",
]

# Sine of the angle below which two vectors count as parallel (Radiance's FTINY)
_PARALLEL = 1e-6


@checked_fields
@dataclass(frozen=True, eq=False)
class Scene:
    """Surfaces and their materials.

    Attributes
    ----------
    materials : materials by key; the name of each material is its key
    surfaces : surfaces in the order of the scene files
    distant : sources at infinity
    bands : spectral bands of the materials' colours

    Raises
    ------
    InputError : the material of a surface is not in the scene, the up vector of a BSDF
        is parallel to the surface normal, or a colour has other bands

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
    bands: Bands = RGB

    __repr__ = brief

    def __post_init__(self) -> None:
        for material in self.materials.values():
            require_few_parts(material)
            _check_colours(material, self.bands)
        oriented = {key for key, m in self.materials.items() if _has_bsdf(m)}
        for item in (*self.surfaces, *self.distant):
            if item.material not in self.materials:
                raise InputError(
                    f'surface "{item.name}" is made of "{item.material}",'
                    " which is not a material of the scene"
                )
            if item.material in oriented and isinstance(item, Polygon | Ring):
                _check_up(item, self.materials[item.material])

    def __add__(self, other: "Scene") -> "Scene":
        """Return the union of two scenes; clashing material names are numbered.

        A grey scene can be added to a scene in any bands; otherwise bands must agree.
        """
        if self.bands == RGB != other.bands:
            return replace(self, bands=other.bands) + other
        if other.bands != self.bands:
            other = replace(other, bands=self.bands)
        materials = dict(self.materials)
        key = {
            name: insert_material(materials, m) for name, m in other.materials.items()
        }
        return Scene(
            materials,
            self.surfaces + tuple(_renamed(s, key) for s in other.surfaces),
            self.distant + tuple(_renamed(d, key) for d in other.distant),
            self.bands,
        )

    def bounds(self) -> Float[np.ndarray, "2 3"]:
        """Corners [m] of the bounding box of all surfaces; NaN if there are none."""
        if not self.surfaces:
            return np.full((2, 3), np.nan)
        points = np.concatenate([extent(s) for s in self.surfaces])
        return np.stack([points.min(axis=0), points.max(axis=0)])


def display_colour(material: Material) -> Colour:
    """Return a material's colour for drawings, without patterns; lights are white."""
    match material:
        case Mixture(foreground=one, background=other, amount=amount):
            share = amount if isinstance(amount, float) else 0.5
            return share * display_colour(one) + (1 - share) * display_colour(other)
        case Light() | Glow() | Spotlight():
            return np.ones_like(material.radiance)
        case BsdfSurface():
            return np.ones(3)
    for part in parts(material):
        return display_colour(part)
    return next(colours(material), np.ones(3))


def _check_colours(material: Material, bands: Bands) -> None:
    # Grey colours are valid in other bands, but in RGB scenes all have three values
    for colour in colours(material):
        if len(colour) != len(bands) and (bands == RGB or np.ptp(colour) > 0):
            raise error_at(
                material.source,
                f'a colour of the material "{material.name}" has {len(colour)} values;'
                f" one for each of the bands {bands} expected",
            )
    for part in parts(material):
        _check_colours(part, bands)


def _has_bsdf(material: Material) -> bool:
    return isinstance(material, BsdfSurface) or any(map(_has_bsdf, parts(material)))


def _check_up(surface: Polygon | Ring, material: Material) -> None:
    for part in parts(material):
        _check_up(surface, part)
    if not isinstance(material, BsdfSurface):
        return
    if isinstance(surface, Ring):
        normal = surface.normal
    else:
        normal = area_vector(surface.vertices)
    up = material.up @ material.transform
    sine = np.linalg.norm(np.cross(up, normal))
    if sine < _PARALLEL * np.linalg.norm(up) * np.linalg.norm(normal):
        raise error_at(
            surface.source,
            f'"{surface.name}": the up vector of BSDF "{material.name}" is parallel to'
            " the surface normal; another direction expected",
        )


_Item = TypeVar("_Item", bound=Surface | DistantSource)


def _renamed(item: _Item, key: dict[str, str]) -> _Item:
    new = key[item.material]
    return item if new == item.material else replace(item, material=new)
