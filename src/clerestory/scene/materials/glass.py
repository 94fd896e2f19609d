"""Radiance's glass: a thin pane."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from clerestory.scene.material import Colour, Material, Plugin, Source, Specification
from clerestory.scene.primitive import Definition


@dataclass(frozen=True, eq=False)
class Glass(Material):
    """Radiance's glass: one thin pane.

    Attributes
    ----------
    name : key of the material in the scene
    transmissivity : internal transmittance of one pass at normal incidence
    index : index of refraction
    """

    name: str
    transmissivity: Colour
    index: float = 1.52
    source: Source | None = None
    takes_pattern = True
    opaque = False

    def display_colour(self) -> Colour:
        return self.transmissivity

    def plugin(self) -> Plugin:
        return Plugin(
            "radiance_glass",
            {"transmissivity": self.transmissivity, "index": self.index},
        )

    def specification(self) -> Specification:
        return Specification("glass", (), (*self.transmissivity, self.index))


def _read(given: Definition) -> Material:
    given.no_strings()
    value = given.reals(3, 4)
    index = float(value[3]) if len(value) == 4 else 1.52
    if index < 1:
        raise given.error(f"index of refraction is {index:g}; 1 or more expected")
    colour = given.share("transmissivity", value[:3])
    return Glass(given.item.name, colour, index, given.source)


READERS: Mapping[str, Callable[[Definition], Material]] = {"glass": _read}
