"""Emitting surfaces of luminaires, and their radiance by direction.

The radiance is the intensity divided by the projected area of all emitting surfaces. A
luminaire that emits only downwards (upwards) emits only from its lower (upper) face.
"""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.formats.photometry.luminaire import Luminaire, LuminousShape
from clerestory.scene.model import Cone, Polygon, Ring, Sphere
from clerestory.scene.transform import Transform

# Surface types that luminaires consist of
Shining = Polygon | Sphere | Cone | Ring

# Distance between the faces of a flat luminaire that emits up- and downwards [m]
_THICKNESS = 0.0005

# Height [m] above which a luminous shape emits from its sides
_LEAST_SIDE = 0.001


@dataclass(frozen=True)
class Faces:
    """Whether the lower face, the upper face and the sides of a shape emit light."""

    lower: bool
    upper: bool
    sides: bool


def faces(luminaire: Luminaire) -> Faces:
    """Return which faces of a luminaire emit light.

    The lower (upper) face emits if there is downward (upward) intensity. The sides
    emit if the shape has a height and the intensity table extends above and below the
    horizontal.
    """
    if luminaire.photometry != "C":
        return Faces(lower=True, upper=False, sides=False)
    angle, lit = luminaire.vertical_deg, luminaire.intensity.max(axis=0) > 0
    low, high = angle < 90, angle > 90
    sides = bool(low.any() and high.any()) and luminaire.shape.z > _LEAST_SIDE
    return Faces(bool((lit & low).any()), bool((lit & high).any()), sides)


@dataclass(frozen=True, eq=False)
class LuminairePattern:
    """Radiance [W/(m²·sr)] of a luminaire's emitting surfaces by direction.

    `transform`: from luminaire to scene coordinates.
    """

    luminaire: Luminaire
    shining: Faces
    transform: Transform = field(default_factory=Transform)
    needs_normal = False
    needs_point = False
    grey = True

    def value(
        self,
        direction: Float[np.ndarray, "rays 3"],
        normal: Float[np.ndarray, "rays 3"] | None = None,
        point: Float[np.ndarray, "rays 3"] | None = None,
    ) -> Float[np.ndarray, "rays 3"]:
        """Return the radiance of the emitting surfaces; see `Pattern.value`."""
        back = np.linalg.inv(self.transform.matrix[:3, :3]) * self.transform.scale
        local = direction @ back
        area = self._projected_area(local) * self.transform.scale**2
        shown = self.luminaire.candela(local) / LUMINOUS_EFFICACY
        radiance = np.divide(shown, area, out=np.zeros_like(shown), where=area > 1e-12)
        return np.repeat(radiance[:, None], 3, axis=1)

    def _projected_area(
        self, local: Float[np.ndarray, "rays 3"]
    ) -> Float[np.ndarray, " rays"]:
        # Projected area of the emitting faces [m²]
        shape = self.luminaire.shape
        x, y, z = np.abs(local).T
        if shape.kind == "sphere":
            return np.full(len(local), np.pi / 4 * shape.x**2)
        if shape.kind == "cylinder":
            face = np.pi / 4 * shape.x**2 * z
            side = shape.x * shape.z * np.sqrt(np.maximum(1 - z**2, 0))
        else:
            face = shape.x * shape.y * z
            side = shape.z * (x * shape.y + y * shape.x)
        return np.asarray(face + side if self.shining.sides else face)


def shining_surfaces(
    luminaire: Luminaire, *, material: str, name: str
) -> tuple[Shining, ...]:
    """Return the emitting surfaces in luminaire coordinates, facing outwards.

    `name`: prefix of the names of the surfaces.
    """
    shape, shining = luminaire.shape, faces(luminaire)
    if shape.kind == "sphere":
        ball = Sphere(np.zeros(3), shape.x / 2, False, material, f"{name}.s")
        return (ball,)
    both = shining.lower and shining.upper
    height = max(shape.z, _THICKNESS) if both else shape.z
    made: list[Shining] = []
    for shines, side, suffix in ((shining.lower, -1.0, "d"), (shining.upper, 1.0, "u")):
        if shines:
            made.append(_face(luminaire, side, height, material, f"{name}.{suffix}"))
    if shining.sides:
        made += _sides(luminaire, material, name)
    return tuple(made)


def _face(
    luminaire: Luminaire, side: float, height: float, material: str, name: str
) -> Shining:
    # Lower face (side -1) or upper face (side +1)
    shape = luminaire.shape
    centre = np.array([0.0, 0.0, side * height / 2])
    if shape.kind == "cylinder":
        normal = np.array([0.0, 0.0, side])
        return Ring(centre, normal, 0.0, shape.x / 2, material, name)
    corners = _outline(shape) + centre
    return Polygon(corners if side > 0 else corners[::-1], material, name)


def _outline(shape: LuminousShape) -> Float[np.ndarray, "4 3"]:
    x, y = shape.x / 2, shape.y / 2
    return np.array([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]])


def _sides(luminaire: Luminaire, material: str, name: str) -> list[Shining]:
    shape = luminaire.shape
    top = np.array([0.0, 0.0, shape.z / 2])
    if shape.kind == "cylinder":
        radius = shape.x / 2
        return [Cone(-top, top, radius, radius, False, material, f"{name}.c")]
    around = _outline(shape)
    made: list[Shining] = []
    for i, (one, other) in enumerate(zip(around, np.roll(around, -1, 0), strict=True)):
        corners = np.stack([one - top, other - top, other + top, one + top])
        made.append(Polygon(corners, material, f"{name}.{i + 1}"))
    return made
