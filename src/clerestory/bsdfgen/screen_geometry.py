"""Geometry of perforated sheets and woven screens."""

import math
from collections.abc import Iterator
from typing import Literal

import numpy as np

from clerestory.array_types import Points2, Vector2
from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.channel_weights import Share, channel_values, system_bands
from clerestory.bsdfgen.shading_system import SampleArea, System, unit_cell
from clerestory.checks import not_negative, one_of, positive, require
from clerestory.scene.model import Cone, Material, Plastic, Polygon, Scene

# Number of corners of the polygon of equal area that replaces a round hole.
_CORNERS = 48

# Number of holes or threads along each side of the unit cell.
_COUNT = 4


def perforated(
    *,
    pitch: float = 2.0e-3,
    hole: float = 1.0e-3,
    shape: Literal["round", "square"] = "round",
    thickness: float = 0.0,
    reflectance: Share = 0.5,
    solar_reflectance: float | None = None,
) -> System:
    """Return the unit cell of an infinite sheet with holes on a square grid.

    Parameters
    ----------
    pitch : distance between hole centres [m]
    hole : diameter of round holes, or side of square holes [m]
    thickness : thickness of the sheet [m]; 0 for an infinitely thin sheet
    reflectance : reflectance of the sheet and of the walls of the holes, as in
        Radiance's material `plastic`
    solar_reflectance : reflectance in the solar band; None for the visible band only
    """
    rho = channel_values("reflectance", reflectance, solar_reflectance)
    scene, area = sheet_with_holes(
        Plastic("sheet", rho), pitch=pitch, hole=hole, shape=shape, thickness=thickness
    )
    share = (hole / pitch) ** 2 * (math.pi / 4 if shape == "round" else 1)
    product = Product(name=f"Perforated screen, {share:.1%} open", device_type="Other")
    return System(scene, area, system_bands(solar_reflectance), product)


def woven(
    *,
    spacing: float = 1.0e-3,
    thread: float = 0.3e-3,
    reflectance: Share = 0.5,
    solar_reflectance: float | None = None,
) -> System:
    """Return the unit cell of an infinite screen of round threads in two crossing
    layers.

    Parameters
    ----------
    spacing : distance between thread axes in both directions [m]
    thread : diameter of the threads [m]
    reflectance : reflectance of the threads, as in Radiance's material `plastic`
    solar_reflectance : reflectance in the solar band; None for the visible band only
    """
    positive(thread, "thread", unit="m")
    require(thread < spacing, f"thread is {thread} m; less than the spacing expected")
    rho = channel_values("reflectance", reflectance, solar_reflectance)
    side, radius = _COUNT * spacing, thread / 2
    layers = -1.01 * radius, -3.02 * radius
    threads = []
    for number in range(_COUNT):
        at = (number + 0.5) * spacing
        for axis, z in enumerate(layers):
            base, top = np.array([[at, at, z], [at, at, z]])
            base[axis], top[axis] = -0.01 * side, 1.01 * side
            name = f"{'weft' if axis == 0 else 'warp'}{number}"
            threads.append(Cone(base, top, radius, radius, False, "thread", name))
    share = (1 - thread / spacing) ** 2
    depth = layers[0] + radius - (layers[1] - radius) + 0.01 * radius
    return System(
        Scene({"thread": Plastic("thread", rho)}, tuple(threads)),
        unit_cell(side, side, depth),
        system_bands(solar_reflectance),
        Product(name=f"Woven screen, {share:.1%} open", device_type="Other"),
    )


def sheet_with_holes(
    material: Material,
    *,
    pitch: float,
    hole: float,
    shape: Literal["round", "square"],
    thickness: float,
    faces: Literal[1, 2] = 2,
) -> tuple[Scene, SampleArea]:
    """Return a perforated sheet, including the walls of the holes, and a unit cell.

    `faces`: number of sheet faces; 2 for a thick sheet, 1 if light passes the sheet.
    """
    positive([pitch, hole], "pitch or hole", unit="m")
    not_negative(thickness, "thickness", unit="m")
    require(hole < pitch, f"hole is {hole} m; less than the pitch {pitch} m expected")
    one_of(shape, "shape", choices=("round", "square"))
    rim = _rim(shape, hole)
    sides = (0.0, -thickness) if thickness > 0 and faces == 2 else (0.0,)
    surfaces: list[Polygon] = []
    for column in range(_COUNT):
        for row in range(_COUNT):
            middle = pitch * (np.array([column, row]) + 0.5)
            for number, z in enumerate(sides):
                surfaces += _around(middle, rim, pitch, z, number, material.name)
            if thickness > 0:
                surfaces += _wall(middle, rim, thickness, material.name)
    area = unit_cell(_COUNT * pitch, _COUNT * pitch, thickness)
    return Scene({material.name: material}, tuple(surfaces)), area


def _rim(shape: str, hole: float) -> Points2:
    if shape == "square":
        return np.asarray(hole / 2 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]))
    turn = 2 * np.pi * (np.arange(_CORNERS) / _CORNERS - 0.375)
    radius = hole / 2 * np.sqrt(2 * np.pi / (_CORNERS * np.sin(2 * np.pi / _CORNERS)))
    return np.asarray(radius * np.stack([np.cos(turn), np.sin(turn)], axis=1))


def _around(
    middle: Vector2, rim: Points2, pitch: float, z: float, side: int, material: str
) -> Iterator[Polygon]:
    # Divide the square around a hole into four polygons
    outer = pitch / 2 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    quarter = len(rim) // 4
    for number in range(4):
        arc = range(number * quarter, (number + 1) * quarter + 1)
        inner = np.take(rim, arc, axis=0, mode="wrap")
        flat = np.concatenate([[outer[number], outer[(number + 1) % 4]], inner[::-1]])
        flat = flat[::-1] if side else flat
        corners = np.column_stack([flat + middle, np.full(len(flat), z)])
        yield Polygon(corners, material, f"sheet{side}.{number}")


def _wall(
    middle: Vector2, rim: Points2, thickness: float, material: str
) -> Iterator[Polygon]:
    for number, (a, b) in enumerate(zip(rim, np.roll(rim, -1, axis=0), strict=True)):
        around = np.array([a, b, b, a]) + middle
        corners = np.column_stack([around, np.array([0, 0, -1, -1]) * thickness])
        yield Polygon(corners, material, f"wall.{number}")
