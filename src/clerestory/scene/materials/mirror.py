"""Radiance's mirror: a plane mirror that creates virtual light sources."""

from dataclasses import dataclass

import numpy as np

from clerestory.scene.material import Colour, Material, Plugin, Source, Specification
from clerestory.scene.primitive import Definition, Readers
from clerestory.scene.tint import Tint


@dataclass(frozen=True, eq=False)
class Mirror(Material):
    """A plane mirror with a black back.

    If there is an alternate material, rays other than shadow rays see it.
    """

    name: str
    reflectance: Colour
    alternate: Material | None = None
    source: Source | None = None
    tint: Tint | None = None
    takes_pattern = True

    @property
    def opaque(self) -> bool:
        return self.alternate is None or self.alternate.opaque

    @property
    def mirrored(self) -> float:
        if self.alternate is not None:
            return self.alternate.mirrored
        return float(np.mean(self.reflectance))

    def plugin(self) -> Plugin:
        if self.alternate is not None:
            return self.alternate.plugin()
        return Plugin("radiance_mirror", {"reflectance": self.reflectance})

    def specification(self) -> Specification:
        strings = () if self.alternate is None else (self.alternate,)
        return Specification("mirror", strings, (*self.reflectance,))


def _read(given: Definition) -> Material:
    colour = given.share("reflectance", given.reals(3, strings=True))
    return Mirror(given.item.name, np.asarray(colour), given.alternate(), given.source)


READERS: Readers = {"mirror": _read}
