"""Radiance's trans: a translucent sheet."""

from dataclasses import dataclass

from clerestory.checks import within
from clerestory.scene.material import Colour, Material, Plugin, Source, Specification
from clerestory.scene.materials.plastic import (
    Roughness,
    Up,
    highlight_parameters,
    highlight_specification,
    read_highlight,
    smooth_specularity,
)
from clerestory.scene.primitive import Definition, Readers
from clerestory.scene.tint import Tint


@dataclass(frozen=True, eq=False)
class Trans(Material):
    """Radiance's trans: a translucent sheet.

    Attributes
    ----------
    reflectance : colour of diffuse reflection and of transmission
    specularity : specular reflectance, uncoloured
    roughness, up : parameters of reflected and transmitted highlight; see `Plastic`
    transmission : transmitted fraction of the flux that is not reflected specularly
    transmitted_specular : specular fraction of the transmitted flux
    """

    name: str
    reflectance: Colour
    specularity: float = 0.0
    roughness: Roughness = 0.0
    transmission: float = 0.0
    transmitted_specular: float = 0.0
    source: Source | None = None
    up: Up = None
    tint: Tint | None = None
    takes_pattern = True

    @property
    def opaque(self) -> bool:
        return self.transmission == 0

    @property
    def mirrored(self) -> float:
        return smooth_specularity(self)

    def plugin(self) -> Plugin:
        names = "transmission", "transmitted_specular"
        passed = {name: getattr(self, name) for name in names}
        return Plugin("radiance_trans", passed | highlight_parameters(self))

    def specification(self) -> Specification:
        passed = self.transmission, self.transmitted_specular
        return highlight_specification("trans", self, *passed)


def _read(given: Definition) -> Material:
    gloss, up, passed = read_highlight(given, 2)
    within(passed[0], "transmission", least=0, most=1)
    within(passed[1], "transmitted specularity", least=0, most=1)
    shares = float(passed[0]), float(passed[1])
    return Trans(given.item.name, *gloss, *shares, given.source, up)


READERS: Readers = {"trans": _read, "trans2": _read}
