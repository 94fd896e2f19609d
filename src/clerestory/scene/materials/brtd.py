"""Radiance's BRTDfunc: specular coefficients as functions of the angle of incidence.

LBNL's Optics, WINDOW and `glaze` write coated, fritted and patterned glass in this
type. The functions of light sources (rbrtd, gbrtd, bbrtd) must be zero.
"""

from dataclasses import dataclass

import numpy as np

from clerestory.scene.material import Colour, Material, Plugin, Source, Specification
from clerestory.scene.pattern import Pattern
from clerestory.scene.primitive import Definition, Readers


@dataclass(frozen=True, eq=False)
class FunctionSheet(Material):
    """Radiance's BRTDfunc: a thin sheet.

    Attributes
    ----------
    reflection, transmission : coefficients of mirror reflection and of direct
        transmission, as patterns with one value per channel; Rdot is positive for light
        on the front
    front, back, diffuse_transmission : diffuse reflectance of each side, and diffuse
        transmittance
    strings, reals : Radiance's arguments, from which the material is written without
        its function file; no strings if a transform applies
    """

    name: str
    reflection: Pattern
    transmission: Pattern
    front: Colour
    back: Colour
    diffuse_transmission: Colour
    strings: tuple[str, ...] = ()
    reals: tuple[float, ...] = ()
    source: Source | None = None
    takes_pattern = True
    opaque = False

    @property
    def mirrored(self) -> float:
        # Mean of both sides along the normal and at two oblique angles; some
        # coatings reflect at oblique incidence only
        slope = np.radians([0.0, 60.0, 80.0])
        upwards = np.column_stack([np.sin(slope), 0 * slope, np.cos(slope)])
        towards = np.concatenate([upwards, -upwards])
        normal = np.array([[0.0, 0.0, 1.0]] * len(towards))
        value = self.reflection.value(towards, normal, np.zeros((len(towards), 3)))
        return float(value.mean())

    def plugin(self) -> Plugin:
        return Plugin(
            "radiance_brtd",
            {
                "front": self.front,
                "back": self.back,
                "passed": self.diffuse_transmission,
                "reflection": self.reflection,
                "transmission": self.transmission,
            },
        )

    def specification(self) -> Specification | None:
        if not self.strings:
            return None
        return Specification("BRTDfunc", self.strings, self.reals)


def _read(given: Definition) -> Material:
    given.strings(10, "9 functions, a function file and a transform")
    reals = given.item.reals
    if len(reals) < 9:
        raise given.error(f"{len(reals)} numbers; 9 or more expected")
    reflection, transmission = given.coefficients()
    front, back, passed = given.share(
        "a diffuse coefficient", np.array(reals[:9])
    ).reshape(3, 3)
    unmoved = np.array_equal(given.placed.matrix, np.eye(4))
    return FunctionSheet(
        given.item.name,
        reflection,
        transmission,
        front,
        back,
        passed,
        given.item.strings if unmoved else (),
        reals,
        given.source,
    )


READERS: Readers = {"BRTDfunc": _read}
