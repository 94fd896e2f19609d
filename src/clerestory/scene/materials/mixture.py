"""Radiance's mixfunc, mixdata and void: blends of two materials."""

from dataclasses import dataclass

from clerestory.scene.material import Material, Plugin, Source, Specification
from clerestory.scene.materials.modified import Textured
from clerestory.scene.pattern import Pattern
from clerestory.scene.primitive import Definition, Readers


@dataclass(frozen=True, eq=False)
class Void(Material):
    """No material: light passes unchanged."""

    name: str = "void"
    source: Source | None = None
    opaque = False

    def plugin(self) -> Plugin:
        return Plugin("null")

    def specification(self) -> None:
        return None


@dataclass(frozen=True, eq=False)
class Mixture(Material):
    """A blend of two materials; `amount` is the fraction of the foreground.

    If `amount` is a pattern, the first channel is the fraction.
    """

    name: str
    foreground: Material
    background: Material
    amount: float | Pattern
    source: Source | None = None

    @property
    def opaque(self) -> bool:
        return self.foreground.opaque and self.background.opaque

    @property
    def mirrored(self) -> float:
        amount = 0.5 if isinstance(self.amount, Pattern) else self.amount
        one, other = self.foreground, self.background
        if isinstance(one, Textured) or isinstance(other, Textured):
            return 0.0
        return amount * one.mirrored + (1 - amount) * other.mirrored

    def plugin(self) -> Plugin:
        parts = {"foreground": self.foreground, "background": self.background}
        return Plugin("radiance_mixture", {"amount": self.amount, **parts})

    def specification(self) -> Specification:
        strings = self.foreground, self.background, self.amount, "."
        return Specification("mixfunc", strings)


def _read(given: Definition) -> Material:
    words = given.strings(4, "foreground, background, share and function file")
    share = given.share_of_foreground()
    parts = given.named(words[0]), given.named(words[1])
    return Mixture(given.item.name, *parts, share, given.source)


READERS: Readers = {"mixfunc": _read, "mixdata": _read}
