"""Writer of scenes as Radiance scene files."""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import numpy as np

from clerestory.errors import InputError
from clerestory.scene.model import (
    BsdfSurface,
    Cone,
    Dielectric,
    DistantSource,
    Glass,
    Glow,
    Illum,
    Interface,
    Light,
    Material,
    Metal,
    Metal2,
    Mirror,
    Mixture,
    Plastic,
    Plastic2,
    Polygon,
    Ring,
    Scene,
    Simple,
    Sphere,
    Spotlight,
    Trans,
    Trans2,
    TriangleMesh,
    Void,
    insert_material,
)
from clerestory.scene.pattern import Pattern

# Kind, string arguments, real arguments
_Primitive = tuple[str, list[str], Iterable[float]]


def format_rad(scene: Scene, *, bsdf_file: Mapping[str, str | Path]) -> str:
    """Return a scene as the text of a Radiance scene file.

    Parameters
    ----------
    bsdf_file : the file of each BSDF, by the key of its material

    Raises
    ------
    InputError : a BSDF without a file, or a lamp with a pattern

    Examples
    --------
    >>> ball = Sphere(np.zeros(3), 0.5, False, "grey", "ball")
    >>> grey = Plastic("grey", np.full(3, 0.4))
    >>> print(format_rad(Scene({"grey": grey}, (ball,)), bsdf_file={}))
    void plastic grey
    0
    0
    5 0.4 0.4 0.4 0 0
    <BLANKLINE>
    grey sphere ball
    0
    0
    4 0 0 0 0.5
    <BLANKLINE>
    """
    writer = _Writer(bsdf_file)
    name_of = {key: writer.define(m, key) for key, m in scene.materials.items()}
    for number, surface in enumerate((*scene.surfaces, *scene.distant), 1):
        name = surface.name or f"surface{number}"
        for shape in _shapes(surface):
            writer.put(name_of[surface.material], shape, name)
    return "\n".join(writer.text)


class _Writer:
    def __init__(self, bsdf_file: Mapping[str, str | Path]) -> None:
        self.text: list[str] = []
        self.written: dict[str, Material] = {}
        self.bsdf_file = bsdf_file

    def put(self, modifier: str, primitive: _Primitive, name: str) -> None:
        """Add a primitive."""
        kind, strings, reals = primitive
        words = " ".join([str(len(strings)), *map(_quoted, strings)])
        values = [f"{float(v):.12g}" for v in reals]
        numbers = " ".join([str(len(values)), *values])
        head = f"{_quoted(modifier)} {kind} {_quoted(name)}"
        self.text.append(f"{head}\n{words}\n0\n{numbers}\n")

    def define(self, material: Material, key: str) -> str:
        """Add a material, after those that it holds; return its name."""
        if isinstance(material, Void):
            return "void"
        primitive = self.primitive(material, key)
        self.written[key] = material
        self.put("void", primitive, key)
        return key

    def held(self, material: Material) -> str:
        """Return the name of a material within another, written if it is not yet."""
        if isinstance(material, Void):
            return "void"
        known = set(self.written)
        key = insert_material(self.written, material)
        return key if key in known else self.define(material, key)

    def primitive(self, material: Material, key: str) -> _Primitive:
        """Return what stands in the file for a material."""
        match material:
            case BsdfSurface():
                return self.bsdf(material, key)
            case Mirror():
                other = [] if material.alternate is None else [material.alternate]
                return "mirror", [self.held(m) for m in other], material.reflectance
            case Illum():
                _demand_even(material)
                return "illum", [self.held(material.alternate)], material.radiance
            case Mixture(amount=float()):
                parts = [self.held(material.foreground), self.held(material.background)]
                return "mixfunc", [*parts, f"{material.amount:.12g}", "."], []
            case _:
                return _plain(material)

    def bsdf(self, material: BsdfSurface, key: str) -> _Primitive:
        """Return what stands in the file for a BSDF."""
        if key not in self.bsdf_file:
            raise InputError(f'the BSDF of material "{key}" has no file; one expected')
        up = [f"{v:.12g}" for v in material.up @ material.transform]
        strings = [str(self.bsdf_file[key]), *up, "."]
        added = np.concatenate([material.front, material.back, material.transmission])
        reals = added.tolist() if np.any(added) else []
        if material.peak:
            return "aBSDF", strings, reals
        return "BSDF", [f"{material.thickness:.12g}", *strings], reals


def _plain(material: Material) -> _Primitive:
    match material:
        case Plastic() | Metal():
            kind = type(material).__name__.lower()
            return kind, [], [*material.reflectance, *_gloss(material)]
        case Plastic2() | Metal2():
            kind = type(material).__name__.lower()
            return kind, _oriented(material), [*material.reflectance, *_gloss(material)]
        case Trans() | Trans2():
            kind = type(material).__name__.lower()
            oriented = _oriented(material) if isinstance(material, Trans2) else []
            passed = material.transmission, material.transmitted_specular
            return kind, oriented, [*material.reflectance, *_gloss(material), *passed]
        case Glass():
            return "glass", [], [*material.transmissivity, material.index]
        case Dielectric():
            return "dielectric", [], [*material.transmissivity, material.index, 0]
        case Interface():
            inside = *material.inside_transmissivity, material.inside_index
            outside = *material.outside_transmissivity, material.outside_index
            return "interface", [], [*inside, *outside]
        case Light() | Glow() | Spotlight():
            return _lamp(material)
    raise InputError(f"a {type(material).__name__} has no place in a scene file")


def _gloss(
    material: Plastic | Metal | Trans | Plastic2 | Metal2 | Trans2,
) -> list[float]:
    return [material.specularity, *np.atleast_1d(material.roughness).tolist()]


def _oriented(material: Plastic2 | Metal2 | Trans2) -> list[str]:
    if isinstance(material.up, Pattern):
        raise InputError(
            f'the up vector of material "{material.name}" varies, which cannot be'
            " written; one for all points expected"
        )
    return [*(f"{v:.12g}" for v in material.up), "."]


def _lamp(material: Light | Glow | Spotlight) -> _Primitive:
    _demand_even(material)
    match material:
        case Light():
            return "light", [], material.radiance
        case Glow():
            return "glow", [], [*material.radiance, material.radius]
        case Spotlight():
            axis = material.direction * (material.length or 1.0)
            return "spotlight", [], [*material.radiance, material.angle_deg, *axis]


def _demand_even(material: Light | Glow | Spotlight | Illum) -> None:
    if material.pattern is not None:
        raise InputError(
            f'lamp "{material.name}" has a pattern, which cannot be written; one of'
            " even radiance expected"
        )


def _shapes(surface: Polygon | Simple) -> Iterator[_Primitive]:
    # A mesh is written triangle by triangle
    if isinstance(surface, TriangleMesh):
        for corners in surface.vertices[surface.faces]:
            yield "polygon", [], corners.ravel()
    else:
        yield _shape(surface)


def _shape(surface: Polygon | Sphere | Cone | Ring | DistantSource) -> _Primitive:
    match surface:
        case Polygon():
            return "polygon", [], surface.vertices.ravel()
        case Sphere():
            kind = "bubble" if surface.inward else "sphere"
            return kind, [], [*surface.centre, surface.radius]
        case Cone():
            ends = [*surface.base, *surface.top]
            if surface.base_radius == surface.top_radius:
                kind = "tube" if surface.inward else "cylinder"
                return kind, [], [*ends, surface.base_radius]
            radii = surface.base_radius, surface.top_radius
            return "cup" if surface.inward else "cone", [], [*ends, *radii]
        case Ring():
            radii = surface.inner_radius, surface.outer_radius
            return "ring", [], [*surface.centre, *surface.normal, *radii]
        case DistantSource():
            return "source", [], [*surface.direction, surface.angle_deg]


def _quoted(word: str) -> str:
    # Radiance reads a word in quotes as one
    return f'"{word}"' if not word or any(c.isspace() for c in word) else word
