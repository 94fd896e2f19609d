"""CIE 171:2006, test cases with analytical references, as scenes of ours.

Each case gives our values beside those of the standard, with our standard errors. The
reference tables are in the folder of shared data. Interiors are black except in 5.8.
"""

import json
from dataclasses import dataclass

import numpy as np

from clerestory.formats.photometry.luminaire import Luminaire, LuminousShape
from clerestory.formats.photometry.luminaire_scene import luminaire_scene, panel_scene
from clerestory.hemisphere.reinhart import reinhart
from clerestory.phases.rendering import irradiance
from clerestory.phases.traced_matrices import daylight_coefficients
from clerestory.scene.materials.emitters import Light
from clerestory.scene.model import Plastic, Polygon, Scene, Sphere
from clerestory.scene.sensors import Sensors
from clerestory.scene.surface import DistantSource
from clerestory.sky.luminance_distribution import (
    cie_general,
    horizontal_integral,
    overcast,
)

WEIGHTS = np.array([0.265, 0.670, 0.065]) * 179
UP, DOWN = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)
NORTH, SOUTH = (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)
# Sensors stand off their surface by this [m]
OFF = 1e-4


@dataclass(frozen=True, eq=False)
class Found:
    """Our values of a case beside the standard's.

    Attributes
    ----------
    name : of the case
    quantity : what is compared, with its unit
    ours, error, truth : our values, their standard errors, the standard's values
    resolution : half of the last digit that the standard prints
    """

    name: str
    quantity: str
    ours: np.ndarray
    error: np.ndarray
    truth: np.ndarray
    resolution: float

    @property
    def relative(self):
        """Deviations from the standard, where it is not 0."""
        lit = self.truth > 0
        return self.ours[lit] / self.truth[lit] - 1

    @property
    def explained(self):
        """Whether each deviation is within four standard errors and the digits."""
        allowance = 4 * self.error + self.resolution + 0.01 * self.truth
        return np.abs(self.ours - self.truth) <= allowance


def quad(*corners, material="black"):
    return Polygon(np.array(corners, dtype=float), material, "quad")


def matt(reflectance, name="black"):
    return Plastic(name, np.full(3, float(reflectance)))


def wall_points(y, inwards):
    """A…F of the standard: up the middle of a wall, from the top down."""
    heights = 2.75 - 0.5 * np.arange(6)
    shift = OFF * inwards[1]
    return [(2.0, y + shift, z) for z in heights], [inwards] * 6


def depth_points(height, *, from_north=False, facing=UP):
    """G…N of the standard: into the depth of the room."""
    depths = 0.25 + 0.5 * np.arange(8)
    depths = depths[::-1] if from_north else depths
    return [(2.0, y, height + OFF * facing[2]) for y in depths], [facing] * 8


def sensors(*parts):
    points = [point for part in parts for point in part[0]]
    facing = [normal for part in parts for normal in part[1]]
    return Sensors(np.array(points, dtype=float), np.array(facing, dtype=float))


def black_room(*, roof=None, facade=None):
    """The room of the daylight cases with an opening (x0, x1, a0, a1) in a surface."""
    floor = quad((0, 0, 0), (4, 0, 0), (4, 4, 0), (0, 4, 0))
    ceiling = quad((0, 0, 3), (0, 4, 3), (4, 4, 3), (4, 0, 3))
    south = quad((0, 0, 0), (0, 0, 3), (4, 0, 3), (4, 0, 0))
    north = quad((0, 4, 0), (4, 4, 0), (4, 4, 3), (0, 4, 3))
    west = quad((0, 0, 0), (0, 4, 0), (0, 4, 3), (0, 0, 3))
    east = quad((4, 0, 0), (4, 0, 3), (4, 4, 3), (4, 4, 0))
    if roof:
        a, b, c, d = roof
        hole = [(a, c, 3), (b, c, 3), (b, d, 3), (a, d, 3), (a, c, 3)]
        ceiling = quad((0, 0, 3), (0, 4, 3), (4, 4, 3), (4, 0, 3), (0, 0, 3), *hole)
    if facade:
        a, b, c, d = facade
        hole = [(a, 0, c), (b, 0, c), (b, 0, d), (a, 0, d), (a, 0, c)]
        south = quad((0, 0, 0), (0, 0, 3), (4, 0, 3), (4, 0, 0), (0, 0, 0), *hole)
    walls = (floor, ceiling, south, north, west, east)
    return Scene({"black": matt(0)}, walls)


def read_tables(folder):
    """Tables of the daylight cases by name: sky type by point."""
    tables, name = {}, ""
    text = (folder / "standards" / "cie171" / "daylight.txt").read_text()
    for line in text.splitlines():
        if line.startswith("@"):
            name = line[1:].split()[0]
            tables[name] = []
        elif line and not line.startswith("#"):
            tables[name].append([float(cell) for cell in line.split()])
    return {name: np.array(rows) for name, rows in tables.items()}


def patch_radiances(sun_y):
    """Radiance of sky patches per unit level irradiance for 16 skies, finely averaged.

    The sun stands 60° high on the side of `sun_y`; column 0 is the ground.
    """
    rows, columns = 1200, 2400
    z = (np.arange(rows) + 0.5) / rows
    azimuth = (np.arange(columns) + 0.5) / columns * 2 * np.pi
    sine = np.sqrt(1 - z**2)[:, None]
    level = np.broadcast_to(z[:, None], (rows, columns))
    directions = np.stack([sine * np.sin(azimuth), sine * np.cos(azimuth), level], -1)
    sky = reinhart(6)
    patch = sky.find(directions).ravel()
    sun = np.array([0.0, sun_y * 0.5, np.sqrt(0.75)])
    skies = [cie_general(number) for number in range(1, 16)] + [overcast]
    count = np.bincount(patch, minlength=len(sky))
    found = np.zeros((len(skies), len(sky)))
    for i, one in enumerate(skies):
        light = one(directions, sun).ravel()
        total = np.bincount(patch, light, minlength=len(sky))
        found[i] = total / np.maximum(count, 1) / horizontal_integral(one, sun=sun)
    return found


def daylight(scene, points, radiances, device, relative_error):
    """Per cent of the level irradiance, and its error: over (sky, sensor)."""
    matrix = daylight_coefficients(
        scene,
        sensors=points,
        subdivision=6,
        relative_error=relative_error,
        bounces=1,
        seed=7,
        device=device,
    )
    ours = 100 * radiances @ matrix.values[0].T
    parts = 100 * np.einsum("skp,np->kns", matrix.components[:, 0], radiances)
    return ours, np.sqrt(np.sum(parts**2, axis=-1)).T


def case_5_9(folder, device="cpu", relative_error=0.002):
    """Sky component under a roof opening of 1 m × 1 m, 16 skies."""
    points = sensors(wall_points(0.0, NORTH), depth_points(0.0))
    room = black_room(roof=(1.5, 2.5, 1.5, 2.5))
    ours, error = daylight(room, points, patch_radiances(1), device, relative_error)
    truth = read_tables(folder)["5.9_1x1"]
    return [Found("5.9, roof opening 1 × 1 m", "SC [%]", ours, error, truth, 0.005)]


def case_5_11(folder, device="cpu", relative_error=0.002):
    """Sky and ground components behind a facade opening of 2 m × 1 m, 16 skies."""
    room = black_room(facade=(1.0, 3.0, 1.0, 2.0))
    points = sensors(
        wall_points(4.0, SOUTH),
        depth_points(0.0, from_north=True),
        depth_points(3.0, from_north=True, facing=DOWN),
    )
    radiances = patch_radiances(-1)
    radiances[:, 0] = 0.3 / np.pi
    ours, error = daylight(room, points, radiances, device, relative_error)
    tables = read_tables(folder)
    parts = (
        ("wall", "SC + ERC [%]", slice(0, 6)),
        ("floor", "SC [%]", slice(6, 14)),
        ("ceiling", "ERC [%]", slice(14, 22)),
    )
    found = []
    for name, quantity, part in parts:
        truth = tables[f"5.11_{name}_2x1"]
        mine = ours[: len(truth), part], error[: len(truth), part]
        title = f"5.11, facade opening 2 × 1 m, {name}"
        found.append(Found(title, quantity, *mine, truth, 0.005))
    return found


def electric(folder):
    """Reference values of the cases without a sky."""
    path = folder / "standards" / "cie171" / "electric.json"
    return json.loads(path.read_text())


def lux(scene, points, device, relative_error, bounces=1):
    gathered = irradiance(
        scene, points, relative_error=relative_error, bounces=bounces, seed=5,
        device=device,
    )  # fmt: skip
    return gathered.illuminance(), gathered.error @ WEIGHTS


def case_5_2(folder, device="cpu", relative_error=0.001):
    """A Lambertian point of 1000 cd 3 m above a plane."""
    tabulated = electric(folder)["5.2_diffuse"]
    angles = np.linspace(0, 90, 91)
    cosine = 1000 * np.cos(np.radians(angles))[None]
    shape = LuminousShape("cylinder", 0.02, 0.02, 0.0)
    lamp = Luminaire("point", "C", np.zeros(1), angles, cosine, shape)
    scene = luminaire_scene(lamp, position=(0.0, 0.0, 3.0))
    places = [(x, y, 0.0) for x, y in tabulated["points_xy"].values()]
    points = sensors((places, [UP] * len(places)))
    ours, error = lux(scene, points, device, relative_error)
    truth = np.array(list(tabulated["E_lux"].values()))
    return [Found("5.2, point above a plane", "lux", ours, error, truth, 0.005)]


def case_5_3(folder, device="cpu", relative_error=0.002):
    """A panel of 1 m² in the ceiling of a black room."""
    tabulated = electric(folder)["5.3_diffuse"]
    corners = np.array([[1.5, 1.5, 3], [1.5, 2.5, 3], [2.5, 2.5, 3], [2.5, 1.5, 3]])
    scene = panel_scene(corners, lumens=1000 * np.pi)
    points = sensors(wall_points(0.0, NORTH), depth_points(0.0))
    ours, error = lux(scene, points, device, relative_error)
    truth = np.array(list(tabulated["E_lux"].values()))
    return [Found("5.3, panel in a room", "lux", ours, error, truth, 0.005)]


def case_5_6(folder, device="cpu", relative_error=0.002):
    """Light reflected by a level diffuse surface of 4 m × 4 m and reflectance 0.30.

    A small sun behind the sensors lights it; a sensor upon it tells by how much.
    """
    tabulated = electric(folder)["5.6_scenario2"]["ff_pct"]
    floor = quad((0, 0, 0), (4, 0, 0), (4, 4, 0), (0, 4, 0), material="floor")
    sun = Light("sun", np.full(3, 1e6))
    towards = np.array([0.0, -0.5, np.sqrt(0.75)])
    scene = Scene(
        {"floor": matt(0.3, "floor"), "sun": sun},
        (floor,),
        (DistantSource(towards, 0.1, "sun", "sun"),),
    )
    heights = 0.75 + 0.5 * np.arange(5)
    wall = [(2.0, OFF, z) for z in heights], [NORTH] * 5
    level = [(2.0, 2.0, OFF)], [UP]
    points = sensors(wall, depth_points(3.0, facing=DOWN), level)
    values, errors = lux(scene, points, device, relative_error, bounces=None)
    scale = 100 / (0.3 * values[-1])
    truth = np.array(list(tabulated.values()))
    mine = values[:-1] * scale, errors[:-1] * scale
    return [
        Found("5.6, light reflected by a floor", "E / (Ehz ρ) [%]", *mine, truth, 5e-3)
    ]


def case_5_7(folder, device="cpu", relative_error=0.002):
    """Light of a diffuse wall of 4 m × 3 m past an obstruction.

    The wall shines itself, evenly, as the standard's evenly lit wall does.
    """
    tabulated = electric(folder)["5.7_corrected"]["ff_pct"]
    wall = np.array([[0.0, 4, 0], [4, 4, 0], [4, 4, 3], [0, 4, 3]])
    lumens = 12.0 * 1000  # an exitance of 1000 lm/m²
    box = [
        quad((0, 2.5, 0), (4, 2.5, 0), (4, 2.5, 1), (0, 2.5, 1)),
        quad((0, 2.7, 0), (4, 2.7, 0), (4, 2.7, 1), (0, 2.7, 1)),
        quad((0, 2.5, 1), (4, 2.5, 1), (4, 2.7, 1), (0, 2.7, 1)),
    ]
    scene = Scene({"black": matt(0)}, tuple(box)) + panel_scene(wall, lumens=lumens)
    depth = depth_points(0.0)
    points = sensors(wall_points(0.0, NORTH), (depth[0][:5], depth[1][:5]))
    ours, error = lux(scene, points, device, relative_error)
    truth = np.array(list(tabulated.values()))
    title = "5.7, light of a wall past an obstruction"
    return [Found(title, "E / (Ev ρ) [%]", ours / 10, error / 10, truth, 0.005)]


def case_5_8(folder, device="cpu", relative_error=0.002):
    """A small lamp in a diffuse cube of 4 m: mean indirect illuminance.

    The mean over each face is Gauss's rule on 4 × 4 sensors.
    """
    samples = max(64, round(0.02 / relative_error**2))
    tabulated = electric(folder)["5.8"]
    radius = 0.02
    shine = 10_000 / 179 / (4 * np.pi**2 * radius**2)
    lamp = Sphere(np.array([2.0, 2, 2]), radius, False, "lamp", "lamp")
    nodes, share = np.polynomial.legendre.leggauss(4)
    places, share = 2 + 2 * nodes, share / 2
    weights = np.tile(np.outer(share, share).ravel(), 6) / 6
    points, facing = [], []
    for axis in range(3):
        for side in (0.0, 4.0):
            for a in places:
                for b in places:
                    point = np.insert([a, b], axis, side)
                    normal = np.zeros(3)
                    normal[axis] = 1.0 if side == 0 else -1.0
                    points.append(point + OFF * normal)
                    facing.append(normal)
    grid = Sensors(np.array(points), np.array(facing))
    ours, error = [], []
    for number, reflectance in enumerate([0.0, *map(float, tabulated["E_indirect"])]):
        materials = {
            "black": matt(reflectance),
            "lamp": Light("lamp", np.full(3, shine)),
        }
        scene = Scene(materials, (*_cube(), lamp))
        gathered = irradiance(scene, grid, samples=samples, seed=5, device=device)
        values, errors = gathered.illuminance(), gathered.error @ WEIGHTS
        ours.append(weights @ values)
        error.append(np.sqrt(np.sum((weights * errors) ** 2)))
        if number == 0:
            direct = ours[0]
    truth = np.array(list(tabulated["E_indirect"].values()), dtype=float)
    mine = np.array(ours[1:]) - direct, np.hypot(error[1:], error[0])
    return [Found("5.8, cube of reflectance 0.05 to 0.95", "lux", *mine, truth, 0.5)]


def _cube():
    a, b = 0.0, 4.0
    return (
        quad((a, a, a), (b, a, a), (b, b, a), (a, b, a)),
        quad((a, a, b), (a, b, b), (b, b, b), (b, a, b)),
        quad((a, a, a), (a, a, b), (b, a, b), (b, a, a)),
        quad((a, b, a), (b, b, a), (b, b, b), (a, b, b)),
        quad((a, a, a), (a, b, a), (a, b, b), (a, a, b)),
        quad((b, a, a), (b, a, b), (b, b, b), (b, b, a)),
    )


CASES = (case_5_2, case_5_3, case_5_6, case_5_7, case_5_8, case_5_9, case_5_11)
