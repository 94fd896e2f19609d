"""Geometry of daylighting films: prisms and mirrored channels."""

import math

import numpy as np

from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.extrusion import extruded
from clerestory.bsdfgen.shading_system import SampleArea, System
from clerestory.bsdfgen.system_parameters import (
    Share,
    channel_values,
    check_not_negative,
    check_positive,
)
from clerestory.errors import InputError
from clerestory.scene.model import Dielectric, Material, Metal, Polygon, Scene

# Smallest ratio of the unit cell's width and height to the thickness of the film.
_SLENDER = 8.0


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
    upper_angle_deg, lower_angle_deg : angles of the upward and the downward facing
        prism faces to the plane of the film, up to 90°; their sum is below 180°
    base : thickness of the sheet that carries the prisms [m]
    index : refractive index
    transmissivity : internal transmittance of 1 m of the material

    Examples
    --------
    >>> film = prismatic(pitch=1e-3, base=0.5e-3)
    >>> round(film.area.thickness * 1e3, 6)
    1.0
    """
    check_positive(pitch=pitch)
    check_not_negative(base=base)
    angles = upper_angle_deg, lower_angle_deg
    if not (all(0 < angle <= 90 for angle in angles) and sum(angles) < 180):
        raise InputError(
            f"prism angles of {angles}°; angles above 0 and up to 90°, with a sum below"
            " 180°, expected"
        )
    if not (index > 1 and 0 <= transmissivity <= 1):
        raise InputError(
            f"index = {index}, transmissivity = {transmissivity}; an index above 1"
            " and a transmissivity from 0 to 1 expected"
        )
    # Height of the prisms, and distance in y from groove to ridge
    up, down = (1 / math.tan(math.radians(a)) if a < 90 else 0.0 for a in angles)
    height = pitch / (up + down)
    ridge = height * down
    depth = base + height
    count = math.ceil(_SLENDER * depth / pitch)
    across = count * pitch
    ends = -0.01 * across, 1.01 * across
    high, low = (count + 1) * pitch, -pitch
    teeth = [
        (number * pitch + y, z)
        for number in range(count, -2, -1)
        for y, z in ((ridge, -depth), (0.0, -base))
    ]
    saw = np.array([(high, -base), *teeth])
    surfaces: list[Polygon] = [
        *extruded(saw, ends=ends, material="film", name="prism"),
        *extruded(
            np.array([(low, 0.0), (high, 0.0)]),
            ends=ends,
            material="film",
            name="sheet",
        ),
    ]
    film = Dielectric("film", np.full(3, transmissivity), index)
    corners = np.array([[0, 0, -depth], [across, across, 0]])
    return System(
        Scene({"film": film}, tuple(surfaces)),
        SampleArea(corners, periodic=True),
        product=Product(
            name=f"Prismatic film, prisms of {angles[0]:g} and {angles[1]:g} degrees"
        ),
    )


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

    Examples
    --------
    >>> mirrored_channels().area.thickness
    0.001
    """
    check_positive(pitch=pitch, thickness=thickness, mirror_depth=mirror_depth)
    if mirror_depth > thickness:
        raise InputError(
            f"mirror_depth = {mirror_depth}; at most the thickness {thickness} expected"
        )
    if not (index > 1 and 0 <= transmissivity <= 1):
        raise InputError(
            f"index = {index}, transmissivity = {transmissivity}; an index above 1"
            " and a transmissivity from 0 to 1 expected"
        )
    count = math.ceil(_SLENDER * thickness / pitch)
    across = count * pitch
    ends = -0.01 * across, 1.01 * across
    high, low = across + pitch, -pitch
    faces = (
        np.array([(low, 0.0), (high, 0.0)]),
        np.array([(high, -thickness), (low, -thickness)]),
    )
    surfaces: list[Polygon] = []
    for number, face in enumerate(faces):
        surfaces += extruded(face, ends=ends, material="sheet", name=f"sheet{number}")
    half = min(mirror_depth, thickness * (1 - 2 * _INSET)) / 2
    for number in range(count):
        y = (number + 0.5) * pitch
        line = np.array([(y, half - thickness / 2), (y, -half - thickness / 2)])
        surfaces += extruded(line, ends=ends, material="mirror", name=f"mirror{number}")
    materials: dict[str, Material] = {
        "sheet": Dielectric("sheet", np.full(3, transmissivity), index),
        "mirror": Metal("mirror", channel_values("reflectance", reflectance), 1.0, 0.0),
    }
    corners = np.array([[0, 0, -thickness], [across, across, 0]])
    return System(
        Scene(materials, tuple(surfaces)),
        SampleArea(corners, periodic=True),
        product=Product(
            name=f"Mirrored channels of {mirror_depth * 1e3:g} mm"
            f" every {pitch * 1e3:g} mm"
        ),
    )
