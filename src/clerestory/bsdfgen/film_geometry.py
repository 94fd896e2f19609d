"""Geometry of daylighting films: prisms and mirrored channels."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from clerestory.array_types import Points2
from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.channel_weights import Share, channel_values
from clerestory.bsdfgen.extrusion import extruded
from clerestory.bsdfgen.shading_system import System, unit_cell
from clerestory.checks import not_negative, positive, require, within
from clerestory.scene.model import Dielectric, Material, Metal, Polygon, Scene

# Smallest ratio of the unit cell's width and height to the thickness of the film.
_SLENDER = 8.0

# Largest ratio of film thickness to the pitch of prisms or mirrors.
_THICKEST = 10_000


def prismatic(
    *,
    pitch: float = 0.2e-3,
    upper_angle_deg: float = 45.0,
    lower_angle_deg: float = 45.0,
    base: float = 0.2e-3,
    index: float = 1.49,
    transmissivity: float = 1.0,
) -> System:
    """Return the unit cell of an infinite film with horizontal prisms.

    Parameters
    ----------
    pitch : distance between prisms [m]
    upper_angle_deg, lower_angle_deg : angles between the film plane and the upward and
        downward facing prism faces, up to 90°; the sum of both is below 180°
    base : thickness of the sheet that carries the prisms [m]
    index : refractive index
    transmissivity : internal transmittance of 1 m of the material
    """
    positive(pitch, "pitch", unit="m")
    not_negative(base, "base", unit="m")
    angles = upper_angle_deg, lower_angle_deg
    require(
        all(0 < angle <= 90 for angle in angles) and sum(angles) < 180,
        f"prism angles are {angles}°; angles above 0 and up to 90°, with a sum below"
        " 180°, expected",
    )
    # Height of the prisms, and distance in y from groove to ridge
    up, down = (1 / math.tan(math.radians(a)) if a < 90 else 0.0 for a in angles)
    height = pitch / (up + down)
    ridge = height * down
    film = _Film(pitch, base + height, index, transmissivity)
    teeth = [
        (number * pitch + y, z)
        for number in range(film.count, -2, -1)
        for y, z in ((ridge, -film.depth), (0.0, -base))
    ]
    saw = np.array([((film.count + 1) * pitch, -base), *teeth])
    surfaces = [*film.strips(saw, "film", "prism"), *film.face("film", "sheet")]
    name = f"Prismatic film, prisms of {angles[0]:g} and {angles[1]:g} degrees"
    return film.system({"film": film.dielectric("film")}, surfaces, name)


# Smallest distance from mirrors to sheet faces, as a fraction of the sheet thickness.
_INSET = 1e-3


def mirrored_channels(
    *,
    pitch: float = 1.0e-3,
    thickness: float = 1.0e-3,
    mirror_depth: float = 0.8e-3,
    reflectance: Share = 0.9,
    index: float = 1.49,
    transmissivity: float = 1.0,
) -> System:
    """Return the unit cell of an infinite film with horizontal mirrors.

    Parameters
    ----------
    pitch : distance between mirrors [m]
    thickness : thickness of the sheet [m]
    mirror_depth : depth of the mirrors, centred in the sheet [m]
    reflectance : reflectance of the mirrors on both sides
    index : refractive index of the sheet
    transmissivity : internal transmittance of 1 m of the sheet material
    """
    positive([pitch, mirror_depth], "pitch or mirror_depth", unit="m")
    shallow = mirror_depth <= thickness
    require(
        shallow, f"mirror_depth is {mirror_depth} m; at most the thickness expected"
    )
    film = _Film(pitch, thickness, index, transmissivity)
    high, low = (film.count + 1) * pitch, -pitch
    back = np.array([(high, -thickness), (low, -thickness)])
    surfaces = [*film.face("sheet", "sheet0"), *film.strips(back, "sheet", "sheet1")]
    half = min(mirror_depth, thickness * (1 - 2 * _INSET)) / 2
    for number in range(film.count):
        y = (number + 0.5) * pitch
        line = np.array([(y, half - thickness / 2), (y, -half - thickness / 2)])
        surfaces += film.strips(line, "mirror", f"mirror{number}")
    mirror = Metal("mirror", channel_values("reflectance", reflectance), 1.0, 0.0)
    materials = {"sheet": film.dielectric("sheet"), "mirror": mirror}
    name = f"Mirrored channels of {mirror_depth * 1e3:g} mm every {pitch * 1e3:g} mm"
    return film.system(materials, surfaces, name)


@dataclass(frozen=True)
class _Film:
    # A film with horizontal structures; lengths in metres
    pitch: float
    depth: float
    index: float
    transmissivity: float

    def __post_init__(self) -> None:
        require(self.index > 1, f"refractive index is {self.index}; above 1 expected")
        within(self.transmissivity, "transmissivity", least=0, most=1)
        within(self.depth / self.pitch, "thickness over pitch", least=0, most=_THICKEST)

    @property
    def count(self) -> int:
        """Number of prisms or mirrors in the unit cell."""
        return math.ceil(_SLENDER * self.depth / self.pitch)

    def strips(self, section: Points2, material: str, name: str) -> Iterator[Polygon]:
        """Extrude a cross-section slightly beyond the unit cell."""
        across = self.count * self.pitch
        ends = -0.01 * across, 1.01 * across
        return extruded(section, ends=ends, material=material, name=name)

    def face(self, material: str, name: str) -> Iterator[Polygon]:
        """The flat face of the film at z = 0."""
        high, low = (self.count + 1) * self.pitch, -self.pitch
        return self.strips(np.array([(low, 0.0), (high, 0.0)]), material, name)

    def dielectric(self, name: str) -> Dielectric:
        """The material of the film."""
        return Dielectric(name, np.full(3, self.transmissivity), self.index)

    def system(
        self, materials: dict[str, Material], surfaces: list[Polygon], name: str
    ) -> System:
        """The shading system of the film, with a unit cell."""
        side = self.count * self.pitch
        scene = Scene(materials, tuple(surfaces))
        area = unit_cell(side, side, self.depth)
        return System(scene, area, product=Product(name=name))
