"""Default modifiers of objects, and grids above the floors of rooms."""

import json

import numpy as np
import pytest
from honeybee_models import aperture, box, face, honeybee_model, office

from clerestory.formats.floor_grids import floor_grids
from clerestory.formats.hbjson import read_hbjson


@pytest.fixture
def read(tmp_path):
    def write_and_read(value):
        path = tmp_path / "m.hbjson"
        path.write_text(json.dumps(value), encoding="utf-8")
        return read_hbjson(path)

    return write_and_read


def test_a_room_without_grid_has_a_grid_above_its_floor(read):
    """4 m × 5 m hold 8 × 10 cells of half a metre, sensors in their centres."""
    found = floor_grids(read(honeybee_model(office())), spacing=0.5, height=0.8)
    (grid,) = found.grids.values()
    assert list(found.grids) == ["office"]
    assert len(grid) == 80
    assert np.allclose(grid.position.min(axis=0), [0.25, 0.25, 0.8])
    assert np.allclose(grid.position.max(axis=0), [3.75, 4.75, 0.8])
    assert np.allclose(grid.direction, [0, 0, 1])
    assert not found.omitted


def test_spacing_and_height_are_metres_in_a_model_of_feet(read):
    found = floor_grids(
        read(honeybee_model(office(), units="Feet")), spacing=0.2, height=0.5
    )
    (grid,) = found.grids.values()
    assert np.allclose(grid.position[:, 2], 0.5)
    assert len(grid) == 6 * 7  # 1.219 m × 1.524 m


def test_a_room_with_sensors_keeps_them(read):
    sensors = [{"pos": [2, 2, 0.75], "dir": [0, 0, 1]}]
    for more in ({"room_identifier": "a"}, {}):
        grid = {"identifier": "desk", "sensors": sensors} | more
        model = honeybee_model(office("a"), office("b", x=10), sensor_grids=[grid])
        found = floor_grids(read(model), spacing=1, height=0.8)
        assert list(found.grids) == ["b"]


def test_a_grid_follows_the_room_and_leaves_out_holes(read):
    """An L of 4 × 4 less 2 × 2 m has three quarters of the sensors; so has its turn."""
    corners = np.array([[0, 0], [4, 0], [4, 2], [2, 2], [2, 4], [0, 4]], dtype=float)
    for angle in (0.0, 0.4):
        cos, sin = np.cos(angle), np.sin(angle)
        plan = corners @ np.array([[cos, sin], [-sin, cos]])
        low = [[*p, 0.0] for p in plan.tolist()]
        high = [[*p, 3.0] for p in plan.tolist()]
        walls = [
            face(f"w{i}", [low[i], low[j], high[j], high[i]])
            for i, j in zip(range(6), [1, 2, 3, 4, 5, 0], strict=True)
        ]
        faces = [face("f", low[::-1], "Floor"), face("r", high, "RoofCeiling"), *walls]
        room = {"identifier": "L", "faces": faces, "properties": {}}
        found = floor_grids(read(honeybee_model(room)), spacing=0.5, height=0.8)
        assert len(found.grids["L"]) == 48


def test_a_tiny_room_has_one_sensor_in_its_middle(read):
    room = box("closet", (0, 0, 0), (0.3, 0.4, 3))
    found = floor_grids(read(honeybee_model(room)), spacing=0.5, height=0.8)
    assert np.allclose(found.grids["closet"].position, [[0.15, 0.2, 0.8]])


def test_a_room_without_floor_is_named(read):
    room = office("a")
    room["faces"][0]["face_type"] = "Wall"
    found = floor_grids(read(honeybee_model(room)), spacing=0.5, height=0.8)
    assert not found.grids
    assert found.omitted == ('a grid for room "a": it has no floor of any area',)


def test_modifiers_of_sets_may_be_given_in_full(read):
    """A set may hold modifiers themselves instead of their names."""
    brown = {"type": "Plastic", "identifier": "brown", "r_reflectance": 0.4}
    walls = {
        "type": "ModifierSet",
        "identifier": "old",
        "wall_set": {"exterior_modifier": brown},
    }
    room = office()
    room["properties"] = {"radiance": {"modifier_set": "old"}}
    found = read(honeybee_model(room, modifier_sets=[walls]))
    named = {s.name: s.material for s in found.scene.surfaces}
    assert named["office_west"] == "brown"


def test_defaults_are_those_of_honeybee(read):
    """Found with honeybee-radiance 1.66 by asking each object for its modifier."""
    names = [
        "aperture_set.skylight",
        "aperture_set.window",
        "aperture_set.operable",
        "door_set.overhead",
        "door_set.exterior",
        "floor_set.exterior",
        "floor_set.interior",
    ]
    modifiers = [
        {"type": "Plastic", "identifier": name, "r_reflectance": 0.01 * (k + 1)}
        for k, name in enumerate(names)
    ]
    own = {"identifier": "own", "door_set": {"overhead_modifier": "door_set.overhead"}}
    for name in names[:3] + names[4:]:
        group, key = name.split(".")
        own.setdefault(group, {})[f"{key}_modifier"] = name
    high = [[1, 1, 3], [2, 1, 3], [2, 2, 3], [1, 2, 3]]
    low = [[1, 1, 0], [1, 2, 0], [2, 2, 0], [2, 1, 0]]
    door = aperture("hatch", [[3, 3, 3], [3.5, 3, 3], [3.5, 4, 3], [3, 4, 3]])
    vent = aperture("vent", [[1, 0, 1], [3, 0, 1], [3, 0, 2], [1, 0, 2]])
    room = office(
        roof={"apertures": [aperture("sky", high)], "doors": [door]},
        floor={"apertures": [aperture("low", low)]},
        north={"face_type": "Floor", "boundary_condition": {"type": "Ground"}},
        south={"apertures": [vent | {"is_operable": True}]},
    )
    room["properties"] = {"radiance": {"modifier_set": "own"}}
    found = read(honeybee_model(room, modifiers=modifiers, modifier_sets=[own]))
    named = {s.name: s.material for s in found.scene.surfaces}
    assert named["sky"] == "aperture_set.skylight"
    assert named["low"] == "aperture_set.skylight"
    assert named["vent"] == "aperture_set.operable"
    assert named["hatch"] == "door_set.overhead"
    assert named["office_floor"] == "floor_set.exterior"
    assert named["office_north"] == "floor_set.interior"


def test_orphaned_shades_are_context_only_if_detached(read):
    quad = [[0, 0, 9], [1, 0, 9], [1, 1, 9], [0, 1, 9]]
    model = honeybee_model(office())
    model["orphaned_shades"] = [
        {"identifier": name, "geometry": {"boundary": quad}, "is_detached": far}
        for name, far in (("near", False), ("far", True))
    ]
    mesh = {"vertices": quad, "faces": [[0, 1, 2, 3]]}
    model["shade_meshes"] = [
        {"identifier": "m", "geometry": mesh},
        {"identifier": "n", "geometry": mesh, "is_detached": False},
    ]
    scene = read(model).scene
    used = {s.name: scene.materials[s.material] for s in scene.surfaces}
    grey = [used[name].reflectance[0] for name in ("near", "far", "m", "n")]
    assert grey == [0.35, 0.2, 0.2, 0.35]


def test_what_is_ignored_is_listed_by_name(read):
    model = honeybee_model(office() | {"multiplier": 4})
    model["properties"]["energy"] = {"type": "ModelEnergyProperties"}
    model["rooms"][0]["faces"][3]["properties"]["radiance"] = {"modifier": "nothing"}
    void = {"type": "void", "identifier": "nothing"}
    model["properties"]["radiance"]["modifiers"].append(void)
    found = read(model)
    assert set(found.unsupported) == {
        "the energy properties of the model",
        'the multiplier 4 of room "office": it is modelled once',
        'surface "office_north": its modifier "nothing" is void',
    }
    assert "office_north" not in [s.name for s in found.scene.surfaces]
