"""Materials that hold others or a BSDF, and what any material is: `Material`.

Reference: "The RADIANCE 6.0 Synthetic Imaging System" (ray.html), section 2.1.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.bsdf import Bsdf
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
from clerestory.scene.pattern import Pattern


@dataclass(frozen=True, eq=False)
class Mirror:
    """A plane mirror with a black back.

    Attributes
    ----------
    reflectance : share reflected
    alternate : what is there for all light but that of lamps and sun; None: the mirror
        itself
    """

    name: str
    reflectance: Float[np.ndarray, "3"]
    alternate: "Material | None" = None
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Void:
    """Nothing: light passes unchanged."""

    name: str = "void"
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Mixture:
    """Two materials side by side, too finely to be seen apart.

    Attributes
    ----------
    foreground, background : what is mixed
    amount : share of the foreground, 0…1, or a pattern of which it is the first channel
    """

    name: str
    foreground: "Material"
    background: "Material"
    amount: float | Pattern
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Patterned:
    """A material whose colour varies.

    Attributes
    ----------
    base : plastic, metal, trans, glass or mirror; of glass the transmission varies
    pattern : multiplier of its colour
    """

    name: str
    base: "Material"
    pattern: Pattern
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Textured:
    """A material that scatters as if its surface were bumpy.

    Attributes
    ----------
    texture : three values that are added to the unit normal, in the coordinates of the
        function
    """

    name: str
    base: "Material"
    texture: Pattern
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class BsdfSurface:
    """A surface that scatters light as a BSDF says.

    The front of the surface, where its normal points, is the room side of the BSDF.

    Attributes
    ----------
    bsdf : what it does to light
    thickness : 0 for a surface; otherwise how far the geometry that the BSDF stands
        for reaches behind (positive) or before (negative) the surface [m]
    up : vector in the coordinates before `transform`; with the normal it orients the
        BSDF
    transform : rotation or reflection that takes `up` into the scene: up @ transform
    front, back : diffuse reflectance added on either side
    transmission : diffuse transmittance added for both sides
    peak : whether light that the BSDF passes straight is kept sharp (aBSDF)
    """

    name: str
    bsdf: Bsdf
    thickness: float
    up: Float[np.ndarray, "3"]
    transform: Float[np.ndarray, "3 3"] = field(default_factory=lambda: np.eye(3))
    front: Float[np.ndarray, "3"] = field(default_factory=lambda: np.zeros(3))
    back: Float[np.ndarray, "3"] = field(default_factory=lambda: np.zeros(3))
    transmission: Float[np.ndarray, "3"] = field(default_factory=lambda: np.zeros(3))
    peak: bool = False
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Illum:
    """A surface that lights the scene like a lamp and looks like something else.

    Attributes
    ----------
    radiance : [W/(m²·sr)]
    alternate : what is seen in its place
    pattern : how the radiance varies; None: not at all
    """

    name: str
    radiance: Float[np.ndarray, "3"]
    alternate: "Material" = Void()
    source: Source | None = None
    pattern: Pattern | None = None


Emitter = Light | Glow | Spotlight | Illum
Material = (
    Plastic
    | Metal
    | Trans
    | Plastic2
    | Metal2
    | Trans2
    | Glass
    | Dielectric
    | Interface
    | Mirror
    | Mixture
    | Patterned
    | Textured
    | BsdfSurface
    | Void
    | Emitter
)


def insert_material(materials: dict[str, Material], material: Material) -> str:
    """Add a material under its name, or a numbered one if taken; return its key.

    A material equal in all but its place in a file is not added twice.
    """
    stem = material.name.rpartition("#")[0] if "#" in material.name else material.name
    key, count = material.name, 1
    while key in materials:
        if same_material(materials[key], material):
            return key
        count += 1
        key = f"{stem}#{count}"
    materials[key] = material if key == material.name else replace(material, name=key)
    return key


def same_material(one: Material, other: Material) -> bool:
    """Whether two materials act alike, whatever their names and places.

    Examples
    --------
    >>> grey = Plastic("grey", np.full(3, 0.5))
    >>> cloth = Mixture("cloth", grey, Void(), 0.9)
    >>> same_material(cloth, Mixture("net", replace(grey, name="g"), Void(), 0.9))
    True
    """
    return _alike(one, other)


def _alike(one: object, other: object) -> bool:
    # Compare values in depth; names and places of materials do not count
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_alike(one[k], other[k]) for k in one)
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        return len(one) == len(other) and all(map(_alike, one, other))
    if is_dataclass(one) and not isinstance(one, type):
        aside = ("name", "source") if isinstance(one, Material) else ()
        return all(
            _alike(getattr(one, f.name), getattr(other, f.name))
            for f in fields(one)
            if f.name not in aside
        )
    return bool(np.array_equal(one, other))  # type: ignore[arg-type]
