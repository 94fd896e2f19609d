"""Radiance's glass: a thin pane."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.checks import require
from clerestory.scene.material import Colour, Material, Plugin, Source, Specification
from clerestory.scene.primitive import Definition, Readers
from clerestory.scene.tint import Tint


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
    tint: Tint | None = None
    takes_pattern = True
    opaque = False

    @property
    def mirrored(self) -> float:
        # Both sides of the pane
        return 2 * ((self.index - 1) / (self.index + 1)) ** 2

    def plugin(self) -> Plugin:
        return Plugin(
            "radiance_glass",
            {"transmissivity": self.transmissivity, "index": self.index},
        )

    def specification(self) -> Specification:
        return Specification("glass", (), (*self.transmissivity, self.index))


def transmissivity(
    transmittance: Float[np.ndarray, "*batch"], index: float
) -> Float[np.ndarray, "*batch"]:
    """Internal transmittance of one pass from transmittance at normal incidence.

    The transmittance includes reflections between both sides of the pane. Values above
    those of a clear pane give 1.

    >>> transmissivity(np.array([0.0, 0.88]), 1.52).round(3).tolist()
    [0.0, 0.958]
    """
    reflected = ((index - 1) / (index + 1)) ** 2
    passed = (1 - reflected) ** 2
    twice = 2 * reflected * transmittance
    root = np.sqrt(passed**2 + twice**2)
    return np.asarray(np.minimum(2 * transmittance / (passed + root), 1.0))


def _read(given: Definition) -> Material:
    value = given.reals(3, 4)
    index = float(value[3]) if len(value) == 4 else 1.52
    require(index >= 1, f"index of refraction is {index:g}; 1 or more expected")
    colour = given.share("transmissivity", value[:3])
    return Glass(given.item.name, colour, index, given.source)


READERS: Readers = {"glass": _read}
