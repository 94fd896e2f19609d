"""Radiance's BSDF and aBSDF: surfaces with a measured or simulated BSDF."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vector
from clerestory.brief_repr import brief
from clerestory.bsdf.bsdf import Bsdf
from clerestory.directions import unit
from clerestory.errors import InputError
from clerestory.scene.material import Colour, Material, Plugin, Source, Specification
from clerestory.scene.pattern import Pattern
from clerestory.scene.primitive import Definition, Readers
from clerestory.scene.transform import Transform


@dataclass(frozen=True, eq=False)
class BsdfSurface(Material):
    """A surface that scatters light by a BSDF.

    The front of the surface, where its normal points, is the room side of the BSDF.

    Attributes
    ----------
    bsdf : bidirectional scattering distribution functions (BSDF)
    thickness : 0 for a surface; otherwise the depth of the geometry represented by the
        BSDF, behind (positive) or in front of (negative) the surface [m]
    up : up vector of the BSDF before `transform`
    transform : rotation or reflection of `up` to scene coordinates: up @ transform
    front, back : diffuse reflectance of front and back, added to the BSDF
    transmission : diffuse transmittance in both directions, added to the BSDF
    peak : whether direct transmission is extracted as a specular peak (aBSDF)
    """

    name: str
    bsdf: Bsdf
    thickness: float
    up: Vector
    transform: Float[np.ndarray, "3 3"] = field(default_factory=lambda: np.eye(3))
    front: Colour = field(default_factory=lambda: np.zeros(3))
    back: Colour = field(default_factory=lambda: np.zeros(3))
    transmission: Colour = field(default_factory=lambda: np.zeros(3))
    peak: bool = False
    source: Source | None = None
    opaque = False

    __repr__ = brief

    def plugin(self) -> Plugin:
        names = "bsdf", "front", "back", "transmission", "peak"
        parameters = {name: getattr(self, name) for name in names}
        return Plugin("bsdf_file", parameters | {"up": self.up @ self.transform})

    def specification(self) -> Specification:
        strings = self.bsdf, *(self.up @ self.transform), "."
        added = *self.front, *self.back, *self.transmission
        reals = added if np.any(added) else ()
        if self.peak:
            return Specification("aBSDF", strings, reals)
        return Specification("BSDF", (self.thickness, *strings), reals)


def _read(given: Definition) -> Material:
    peak = given.item.kind == "aBSDF"
    first = 0 if peak else 1  # only the type BSDF has a thickness, before the file
    what = "BSDF file, up vector, function file and transform"
    words = given.strings(first + 5, what if peak else f"thickness, {what}")
    numbers = given.reals(0, 3, 6, 9, strings=True)
    added = np.concatenate([numbers, np.zeros(9 - len(numbers))])
    front, back, transmission = given.share("added diffuse light", added).reshape(3, 3)
    transform = given.oriented(first + 5)
    up = given.vector(first + 1, Transform())
    if isinstance(up, Pattern):
        raise InputError("the up vector varies; a constant vector expected")
    # Undoes the transform that `vector` applied to the up vector
    up = up @ np.linalg.inv(given.transform(first + 5).matrix[:3, :3])
    return BsdfSurface(
        name=given.item.name,
        bsdf=given.bsdf(words[first]),
        thickness=0.0 if peak else given.constant("thickness", 0) * transform.scale,
        up=unit(up),
        transform=transform.matrix[:3, :3] / transform.scale,
        front=front,
        back=back,
        transmission=transmission,
        peak=peak,
        source=given.source,
    )


READERS: Readers = {"BSDF": _read, "aBSDF": _read}
