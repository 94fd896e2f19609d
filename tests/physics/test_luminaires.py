"""Luminaires light sensors as their intensities say."""

import numpy as np
import pytest

from clerestory.formats.photometry.luminaire import Luminaire, LuminousShape
from clerestory.formats.photometry.luminaire_scene import luminaire_scene, panel_scene
from clerestory.formats.photometry.read import read_luminaire
from clerestory.phases.rendering import irradiance
from clerestory.scene.sensors import Sensors

UP = np.array([0.0, 0.0, 1.0])


def lux(scene, points, normals=None, samples=4096):
    points = np.asarray(points, dtype=float)
    normals = np.broadcast_to(UP, points.shape) if normals is None else normals
    sensors = Sensors(points, np.ascontiguousarray(normals))
    gathered = irradiance(scene, sensors, samples=samples, bounces=1, seed=5)
    weights = np.array([0.265, 0.670, 0.065]) * 179
    error = gathered.error @ weights
    return gathered.illuminance(), error


def test_a_lambertian_point_lights_a_plane():
    """CIE 171:2006, 5.2: 1000 cd 3 m above a plane, E = I cos⁴θ / h²."""
    angles = np.linspace(0, 90, 91)
    cosine = 1000 * np.cos(np.radians(angles))[None]
    shape = LuminousShape("cylinder", 0.02, 0.02, 0.0)
    lamp = Luminaire("point", "C", np.zeros(1), angles, cosine, shape)
    scene = luminaire_scene(lamp, position=(0.0, 0.0, 3.0))
    places = [[0, 0, 0], [0.5, 0, 0], [1, 0.5, 0], [1.5, 1.5, 0]]
    found, error = lux(scene, places)
    expected = [111.11, 105.21, 85.64, 49.39]
    assert error.max() < 0.3
    assert np.all(np.abs(found - expected) < 4 * error + 0.004 * np.array(expected))


def test_a_panel_lights_a_room():
    """CIE 171:2006, 5.3: 1 m² of π·1000 lm in the ceiling of a black room of 3 m."""
    corners = np.array([[1.5, 1.5, 3], [1.5, 2.5, 3], [2.5, 2.5, 3], [2.5, 1.5, 3]])
    scene = panel_scene(corners, lumens=1000 * np.pi)
    z = np.array([2.75, 1.75, 0.25])
    y = np.array([0.25, 1.25, 1.75])
    walls = np.column_stack([np.full(3, 2.0), np.zeros(3), z])
    floor = np.column_stack([np.full(3, 2.0), y, np.zeros(3)])
    normals = np.array([[0.0, 1, 0]] * 3 + [[0.0, 0, 1]] * 3)
    found, error = lux(scene, np.concatenate([walls, floor]), normals)
    expected = np.array([32.68, 81.38, 39.9, 61.27, 95.52, 105.89])
    assert error.max() < 1
    assert np.all(np.abs(found - expected) < 4 * error + 0.001 * expected)


@pytest.mark.parametrize(
    "name", ["1.IES", "2.IES", "4.IES", "fluorescent_luminaire.ldt"]
)
def test_files_light_a_plane_far_below(name, shared_data):
    """Ten metres below, E = I(direction) cos θ / d²; turned, in all shapes.

    The allowance of 1.5 % is for the table of directions that the tracer holds.
    """
    lamp = read_luminaire(shared_data / "photometry" / name)
    scene = luminaire_scene(lamp, position=(0.0, 0.0, 10.0), turn_deg=25.0)
    places = np.array([[0, 0, 0], [3, 1, 0], [-2, 4, 0], [5, -5, 0], [0, -9, 0.0]])
    away = places - [0, 0, 10]
    distance = np.linalg.norm(away, axis=1)
    ray = away / distance[:, None]
    turn = np.radians(25)
    local = ray.copy()
    local[:, 0] = ray[:, 0] * np.cos(turn) + ray[:, 1] * np.sin(turn)
    local[:, 1] = -ray[:, 0] * np.sin(turn) + ray[:, 1] * np.cos(turn)
    expected = lamp.candela(local) * -ray[:, 2] / distance**2
    found, error = lux(scene, places, samples=16384)
    assert error.max() < 0.02 * expected.max()
    assert np.all(np.abs(found - expected) < 4 * error + 0.015 * expected)


def test_flux_arrives_on_the_walls_of_a_black_box(shared_data):
    """All lumens of a luminaire come down on the faces of a cube around it."""
    lamp = read_luminaire(shared_data / "photometry" / "1.IES")
    scene = luminaire_scene(lamp)
    edge = (np.arange(12) + 0.5) / 12 * 4 - 2
    u, v = (grid.ravel() for grid in np.meshgrid(edge, edge))
    points, normals = [], []
    for axis in range(3):
        for side in (-2.0, 2.0):
            face = np.empty((len(u), 3))
            face[:, axis], face[:, axis - 1], face[:, axis - 2] = side, u, v
            normal = np.zeros(3)
            normal[axis] = -np.sign(side)
            points.append(face)
            normals.append(np.broadcast_to(normal, face.shape))
    found, error = lux(scene, np.concatenate(points), np.concatenate(normals), 1024)
    total = found.sum() * 16 / 144
    spread = np.sqrt((error**2).sum()) * 16 / 144
    assert spread < 0.01 * lamp.flux()
    assert abs(total - lamp.flux()) < 4 * spread + 0.01 * lamp.flux()
