"""Radiance's mixfunc, mixdata and void: blends of two materials."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from clerestory.scene.material import Colour, Material, Plugin, Source, Specification
from clerestory.scene.pattern import Pattern
from clerestory.scene.primitive import Definition


@dataclass(frozen=True, eq=False)
class Void(Material):
    """No material: light passes unchanged."""

    name: str = "void"
    source: Source | None = None
    opaque = False

    def display_colour(self) -> Colour:
        return np.ones(3)

    def plugin(self) -> Plugin:
        return Plugin("null")

    def specification(self) -> None:
        return None


@dataclass(frozen=True, eq=False)
class Mixture(Material):
    """A blend of two materials.

    Attributes
    ----------
    foreground, background : component materials
    amount : foreground fraction 0…1, or a pattern whose first channel is the fraction
    """

    name: str
    foreground: Material
    background: Material
    amount: float | Pattern
    source: Source | None = None

    @property
    def opaque(self) -> bool:
        return self.foreground.opaque and self.background.opaque

    def display_colour(self) -> Colour:
        share = self.amount if isinstance(self.amount, float) else 0.5
        fore, back = self.foreground.display_colour(), self.background.display_colour()
        return np.asarray(share * fore + (1 - share) * back)

    def plugin(self) -> Plugin:
        parts = {"foreground": self.foreground, "background": self.background}
        return Plugin("radiance_mixture", {"amount": self.amount, **parts})

    def specification(self) -> Specification:
        strings = self.foreground, self.background, self.amount, "."
        return Specification("mixfunc", strings)


def _read(given: Definition) -> Material:
    words = given.item.strings
    if len(words) < 4:
        raise given.error(
            f"{len(words)} string arguments; foreground, background, share and"
            " function file expected"
        )
    share = given.share_of_foreground()
    parts = given.named(words[0]), given.named(words[1])
    return Mixture(given.item.name, *parts, share, given.source)


READERS: Mapping[str, Callable[[Definition], Material]] = {
    "mixfunc": _read,
    "mixdata": _read,
}
