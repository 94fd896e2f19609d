"""Coplanar surfaces of different materials are named; neighbours are no overlap."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from clerestory.scene.coplanar import check_coplanar
from clerestory.scene.model import Glass, Plastic, Polygon, Scene, Sphere, TriangleMesh
from clerestory.scene.proximity import Triangulation
from clerestory.scene.scene_checks import check_scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.surface import transformed
from clerestory.scene.tessellate import meshes
from clerestory.scene.transform import parse_transform
from processor_time import least_processor_time

MATERIALS = {
    "wall": Plastic("wall", np.full(3, 0.5)),
    "same": Plastic("same", np.full(3, 0.5)),
    "rug": Plastic("rug", np.full(3, 0.1)),
    "glass": Glass("glass", np.full(3, 0.9)),
}


def rectangle(corner, u, v, material, name):
    a, u, v = (np.array(x, dtype=float) for x in (corner, u, v))
    return Polygon(np.array([a, a + u, a + u + v, a + v]), material, name)


def box(corner, size, material, name):
    """A closed box with its fronts outwards."""
    x, y, z = np.diag(np.array(size, dtype=float))
    a = np.array(corner, dtype=float)
    sides = [(a, y, x), (a + z, x, y), (a, x, z), (a + y, z, x)]
    sides += [(a, z, y), (a + x, y, z)]
    return [rectangle(*s, material, f"{name}{n}") for n, s in enumerate(sides)]


FLOOR = rectangle((0, 0, 0), (5, 0, 0), (0, 4, 0), "wall", "floor")
CEILING = rectangle((0, 0, 3), (0, 4, 0), (5, 0, 0), "wall", "ceiling")
WALL = rectangle((0, 0, 0), (0, 0, 3), (5, 0, 0), "wall", "wall")

OVERLAPS = {
    "a rug in the floor": [rectangle((1, 1, 0), (2, 0, 0), (0, 1, 0), "rug", "rug")],
    "a rug that covers two edges": [
        rectangle((-1, -1, 0), (2, 0, 0), (0, 2, 0), "rug", "rug")
    ],
    "the floor twice": [replace(FLOOR, material="rug", name="rug")],
    "the floor seen from below": [
        replace(FLOOR, vertices=FLOOR.vertices[::-1], material="rug", name="rug")
    ],
    "a pane in a wall without a hole": [
        WALL,
        rectangle((1, 0, 1), (0, 0, 1), (2, 0, 0), "glass", "pane"),
    ],
    "a box sunk to its top": box((1, 1, -0.5), (1, 1, 0.5), "rug", "box"),
}
SOUND = {
    "nothing else": [],
    "a rug a millimetre above": [
        rectangle((1, 1, 0.001), (2, 0, 0), (0, 1, 0), "rug", "rug")
    ],
    "an equal material": [rectangle((1, 1, 0), (2, 0, 0), (0, 1, 0), "same", "rug")],
    "a pane in a hole": [
        rectangle((0, 0, 0), (0, 0, 3), (1, 0, 0), "wall", "left"),
        rectangle((1, 0, 0), (0, 0, 1), (4, 0, 0), "wall", "sill"),
        rectangle((1, 0, 1), (0, 0, 2), (4, 0, 0), "glass", "pane"),
    ],
    "furniture on the floor": box((1, 1, 0), (1, 0.5, 0.8), "rug", "box"),
    "a box on a box": [
        *box((1, 1, 0), (1, 1, 0.8), "rug", "low"),
        *box((1.2, 1.2, 0.8), (0.2, 0.2, 0.3), "glass", "high"),
    ],
    "a table whose legs touch its top": [
        *box((1, 1, 0), (0.1, 0.8, 0.7), "rug", "leg"),
        *box((0.9, 0.9, 0.7), (2, 1, 0.03), "glass", "top"),
    ],
    "a box whose top is cut along the other diagonal": [
        *box((1.85, 2.4, 0), (0.3, 1.2, 0.7), "rug", "foot")[:1],
        rectangle((2.15, 2.4, 0.7), (0, 1.2, 0), (-0.3, 0, 0), "rug", "top"),
        *box((1.85, 2.4, 0), (0.3, 1.2, 0.7), "rug", "foot")[2:],
    ],
}
PLACES = {
    "as it is": "-t 0 0 0",
    "turned": "-rx 20 -rz 31.4 -t 3 4 5",
    "far away": "-rz 12.3 -t 1e6 -7e5 100",
    "in millimetres": "-s 1000",
    "small": "-s 0.01 -rz 10",
}


def triangulation(scene):
    parts = meshes(scene)
    corner = np.concatenate([m.vertices[m.faces] for m in parts])
    return Triangulation(corner, np.concatenate([m.surface for m in parts]))


def found(surfaces, place):
    move, _ = parse_transform(place.split())
    scene = Scene(MATERIALS, tuple(transformed(s, move) for s in surfaces))
    return list(check_coplanar(scene, triangulation(scene)))


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
@pytest.mark.parametrize("case", OVERLAPS)
def test_overlapping_materials_are_named(case, place):
    [text] = found([FLOOR, CEILING, *OVERLAPS[case]], place)
    assert "lie in one plane and overlap" in text
    assert 'of "wall"' in text
    assert 'of "rug"' in text or 'of "glass"' in text


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
@pytest.mark.parametrize("case", SOUND)
def test_neighbours_are_no_overlap(case, place):
    assert found([FLOOR, CEILING, *SOUND[case]], place) == []


def test_a_million_faces_are_checked_in_seconds():
    """A hilly terrain, with one patch of another material on one of its faces."""
    x, y = np.meshgrid(np.linspace(0, 500, 708), np.linspace(0, 500, 708))
    z = 5 * np.sin(x / 20) * np.cos(y / 30)
    vertices = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    corner = np.arange(708 * 708).reshape(708, 708)
    a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, :-1], corner[1:, 1:]
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([b, d, c], -1)])
    hills = TriangleMesh(vertices, faces.reshape(-1, 3), "wall", "hills")
    place = vertices[hills.faces[1234]]
    patch = TriangleMesh(place, np.array([[0, 1, 2]]), "rug", "patch")
    scene = Scene(MATERIALS, (hills, patch))
    parts = triangulation(scene)
    [text] = check_coplanar(scene, parts)
    assert '"patch" of "rug"' in text
    assert least_processor_time(lambda: list(check_coplanar(scene, parts))) < 4


def test_a_thousand_spheres_of_as_many_materials_take_little():
    """Spheres have 1280 triangles each; materials are compared in pairs."""
    rng = np.random.default_rng(1)
    grey = [Plastic(f"m{k}", x) for k, x in enumerate(rng.uniform(0.1, 0.9, (1000, 3)))]
    place = rng.integers(0, 99, (1000, 3)).astype(float)
    balls = [Sphere(x, 0.4, False, m.name) for x, m in zip(place, grey, strict=True)]
    scene = Scene({m.name: m for m in grey}, tuple(balls))
    sensors = Sensors(np.full((1, 3), 50.3), np.array([[0.0, 0, 1]]))
    tracemalloc.start()
    check_scene(scene, (), sensors)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert least_processor_time(lambda: check_scene(scene, (), sensors)) < 3
    assert most < 250 * 1280 * 1000


def test_many_flat_surfaces_of_many_materials_are_checked_in_seconds():
    rng = np.random.default_rng(1)
    grey = [Plastic(f"m{k}", x) for k, x in enumerate(rng.uniform(0.1, 0.9, (4000, 3)))]
    tile = [
        rectangle((2 * k, 0, 0), (1, 0, 0), (0, 1, 0), m.name, f"t{k}")
        for k, m in enumerate(grey)
    ]
    scene = Scene({m.name: m for m in grey}, tuple(tile))

    def check():
        assert not list(check_coplanar(scene, triangulation(scene)))

    assert least_processor_time(check) < 2
