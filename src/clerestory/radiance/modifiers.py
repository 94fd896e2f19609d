"""What patterns and textures do to materials: finishes.

A finish stands between a surface and its material, or above the material; either way
it varies the colour or bends the normal. Where the material is a mixture, both parts
take it, and a mirror with an alternate hands it on.
"""

from dataclasses import dataclass, replace

from clerestory.radiance.arguments import Arguments
from clerestory.radiance.function_pattern import (
    DataPattern,
    FunctionPattern,
    constant_value,
)
from clerestory.scene.composite import (
    BsdfSurface,
    Illum,
    Material,
    Mirror,
    Mixture,
    Patterned,
    Textured,
    Void,
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
    Trans,
    Trans2,
)
from clerestory.scene.pattern import Pattern, Product


@dataclass(frozen=True, eq=False)
class Finish:
    """Patterns and textures, in one.

    Attributes
    ----------
    patterns : multipliers of the colour, the outermost first
    textures : of which each bends the normal
    """

    patterns: tuple[Pattern, ...] = ()
    textures: tuple[FunctionPattern | DataPattern, ...] = ()

    def within(self, outer: "Finish | None") -> "Finish":
        """Return this finish modified by another, or by none."""
        if outer is None:
            return self
        return Finish(outer.patterns + self.patterns, outer.textures + self.textures)

    def pattern(self) -> Pattern | None:
        """Return the product of the patterns, None without any."""
        if len(self.patterns) <= 1:
            return self.patterns[0] if self.patterns else None
        return Product(self.patterns)


def finished(material: Material, finish: Finish, given: Arguments) -> Material:
    """Return a material with a finish.

    Parameters
    ----------
    given : the primitive that names both, for errors

    Raises
    ------
    InputError : with file and line, where the material takes no pattern
    """
    match material:
        case Light() | Glow() | Spotlight() | Illum():
            if not finish.patterns:
                return material
            patterns = finish.patterns
            patterns += () if material.pattern is None else (material.pattern,)
            return replace(material, pattern=Finish(patterns).pattern())
        case Mixture():
            return replace(
                material,
                foreground=finished(material.foreground, finish, given),
                background=finished(material.background, finish, given),
            )
        case Mirror(alternate=other) if other is not None:
            return replace(material, alternate=finished(other, finish, given))
        case Void():
            return material
    made = _painted(material, finish, given)
    for texture in finish.textures:
        made = Textured(material.name, made, texture, material.source)
    return made


def _painted(material: Material, finish: Finish, given: Arguments) -> Material:
    pattern = finish.pattern()
    if pattern is None:
        return material
    factor = constant_value(pattern)
    match material:
        case Plastic() | Metal() | Trans() | Plastic2() | Metal2() | Trans2():
            if factor is not None:
                return replace(material, reflectance=material.reflectance * factor)
            return Patterned(material.name, material, pattern, material.source)
        case Glass() | Mirror():
            return Patterned(material.name, material, pattern, material.source)
        case Patterned(base=base, pattern=inner):
            both = Product((pattern, inner))
            return Patterned(material.name, base, both, material.source)
        case Textured(base=base):
            return replace(material, base=_painted(base, finish, given))
        case BsdfSurface() | Dielectric() | Interface():
            pass
    raise given.error(
        f"{type(material).__name__} does not take a pattern; void expected as its"
        " modifier, or plastic, metal, trans, glass or mirror in its place"
    )
