"""Patterns and textures as modifiers of materials.

A modifier of a surface has the same effect as a modifier of its material: a pattern
multiplies the colour, a texture perturbs the normal, and a spectrum multiplies the
colour in every band. Both materials of a mixture are
modified; of a mirror with an alternate material, only the alternate is modified.
"""

from dataclasses import dataclass, replace

from clerestory.checks import require
from clerestory.radiance.function_pattern import FunctionPattern, constant_value
from clerestory.scene.material import Emitter, Material, altered
from clerestory.scene.materials.mirror import Mirror
from clerestory.scene.materials.mixture import Mixture, Void
from clerestory.scene.materials.modified import Patterned, Textured
from clerestory.scene.materials.plastic import Metal, Plastic
from clerestory.scene.materials.trans import Trans
from clerestory.scene.pattern import Pattern, Product
from clerestory.scene.primitive import Arguments
from clerestory.scene.tint import tinted
from clerestory.spectra import Spectrum

# Largest number of patterns and textures that modify one material
_MOST_NESTED = 100


@dataclass(frozen=True, eq=False)
class Modifiers:
    """Patterns and textures that modify a material, the outermost ones first."""

    patterns: tuple[Pattern, ...] = ()
    textures: tuple[FunctionPattern, ...] = ()
    spectra: tuple[Spectrum, ...] = ()

    def within(self, outer: "Modifiers | None") -> "Modifiers":
        """Return the modifiers combined with outer modifiers, if there are any."""
        if outer is None:
            return self
        patterns, textures = outer.patterns + self.patterns, outer.textures
        spectra = outer.spectra + self.spectra
        nested = len(patterns) + len(textures) + len(spectra)
        message = f"more than {_MOST_NESTED} nested patterns and textures"
        require(nested <= _MOST_NESTED, f"{message}; fewer expected")
        return Modifiers(patterns, textures + self.textures, spectra)


def modified(material: Material, modifiers: Modifiers, given: Arguments) -> Material:
    """Return a material modified by patterns and textures.

    Error messages refer to `given`, the primitive that combines material and modifiers.
    """
    match material:
        case Emitter():
            inner = () if material.pattern is None else (material.pattern,)
            pattern = _product(modifiers.patterns + inner)
            return _spectral(altered(material, pattern=pattern), modifiers, given)
        case Mixture():
            one, other = material.foreground, material.background
            one, other = (modified(part, modifiers, given) for part in (one, other))
            return replace(material, foreground=one, background=other)
        case Mirror(alternate=other) if other is not None:
            return replace(material, alternate=modified(other, modifiers, given))
        case Void():
            return material
    pattern = _product(modifiers.patterns)
    made = _spectral(material, modifiers, given)
    made = made if pattern is None else _patterned(made, pattern, given)
    for texture in modifiers.textures:
        made = Textured(material.name, made, texture, material.source)
    return made


def _product(patterns: tuple[Pattern, ...]) -> Pattern | None:
    if len(patterns) <= 1:
        return patterns[0] if patterns else None
    return Product(patterns)


def _spectral(material: Material, modifiers: Modifiers, given: Arguments) -> Material:
    # The material with its colour multiplied by spectra
    if isinstance(material, Patterned | Textured) and modifiers.spectra:
        return replace(material, base=_spectral(material.base, modifiers, given))
    made = tinted(material, modifiers.spectra)
    if made is None:
        raise given.error(
            f"{type(material).__name__} cannot have a spectrum; the modifier void"
            " expected, or plastic, metal, trans, glass or mirror instead"
        )
    return made


def _patterned(material: Material, pattern: Pattern, given: Arguments) -> Material:
    factor = constant_value(pattern)
    match material:
        case Plastic() | Metal() | Trans() if factor is not None:
            tint = material.tint
            if tint is not None:
                tint = replace(tint, plain=tint.plain * factor)
            colour = material.reflectance * factor
            return replace(material, reflectance=colour, tint=tint)
        case Patterned(base=base, pattern=inner):
            both = Product((pattern, inner))
            return Patterned(material.name, base, both, material.source)
        case Textured(base=base):
            return replace(material, base=_patterned(base, pattern, given))
        case _ if material.takes_pattern:
            return Patterned(material.name, material, pattern, material.source)
    raise given.error(
        f"{type(material).__name__} cannot have a pattern; the modifier void expected,"
        " or plastic, metal, trans, glass or mirror instead"
    )
