"""Honeybee models: a room of our own, described as the schema says."""

import copy
import json
from contextlib import suppress

import numpy as np
import pytest
from honeybee_models import GLASS, aperture, box, building, honeybee_model
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.formats.hbjson import read_hbjson
from clerestory.scene.model import Glass, Plastic, Trans
from clerestory.scene.surface import area_vectors


def window(**radiance):
    """An aperture in the south wall, its outer side seen counter-clockwise."""
    points = [[1, 0, 1], [3, 0, 1], [3, 0, 2], [1, 0, 2]]
    return aperture("south_window", points, **radiance)


def model(units="Meters", **radiance):
    """A room of 4 m × 5 m × 3 m with a window of 2 m² to the south."""
    room = box(
        "room", (0, 0, 0), (4, 5, 3), south={"apertures": [window(modifier="pane")]}
    )
    for face in room["faces"]:
        face["identifier"] = face["identifier"].removeprefix("room_")
    return honeybee_model(room, units=units, **radiance)


@pytest.fixture
def read(tmp_path):
    def write_and_read(value):
        path = tmp_path / "room.hbjson"
        path.write_text(json.dumps(value), encoding="utf-8")
        return read_hbjson(path)

    return write_and_read


def area(polygon):
    ends = np.array([0, len(polygon)])
    return float(np.linalg.norm(area_vectors(polygon, ends)[0]))


def surface(found, name):
    return next(s for s in found.scene.surfaces if s.name == name)


def test_a_room_with_plain_glass_is_one_scene(read):
    found = read(model())
    assert not found.windows
    assert area(surface(found, "south").vertices) == pytest.approx(12 - 2)
    assert area(surface(found, "south_window").vertices) == pytest.approx(2)
    glass = found.scene.materials["pane"]
    assert isinstance(glass, Glass)
    assert glass.transmissivity.tolist() == [0.8, 0.9, 0.7]
    floor = found.scene.materials[surface(found, "floor").material]
    assert isinstance(floor, Plastic)
    assert floor.reflectance[0] == 0.2  # honeybee's generic floor


def test_feet_become_metres(read):
    found = read(model(units="Feet"))
    assert area(surface(found, "south_window").vertices) == pytest.approx(2 * 0.3048**2)


def test_a_room_of_millimetres_is_doubted(read):
    with pytest.warns(ClerestoryWarning, match=r"0.005 m wide in its units, Milli"):
        read(model(units="Millimeters"))


def test_states_make_a_window_that_faces_the_room(read):
    value = model()
    states = [{"modifier": "pane"}, {"modifier": "tint"}]
    radiance = {"dynamic_group_identifier": "shaded", "states": states}
    value["rooms"][0]["faces"][2]["apertures"] = [window(**radiance)]
    (group,) = read(value).windows
    assert group.name == "shaded"
    assert [name for name, _ in group.states] == ["pane", "tint"]
    (outline,) = group.polygons
    normal = np.cross(outline[1] - outline[0], outline[2] - outline[1])
    assert normal[1] > 0  # northwards, into the room


def test_one_window_of_states_makes_all_glass_outdoors_windows(read):
    value = model()
    second = window(modifier="pane") | {"identifier": "second"}
    second["geometry"] = {"boundary": [[1, 0, 2.2], [3, 0, 2.2], [3, 0, 2.8]]}
    radiance = {"states": [{"modifier": "tint"}], "dynamic_group_identifier": "d"}
    value["rooms"][0]["faces"][2]["apertures"] = [window(**radiance), second]
    assert sorted(group.name for group in read(value).windows) == ["d", "pane"]


def test_a_wall_between_rooms_stands_once(read):
    value = model()
    other = copy.deepcopy(value["rooms"][0])
    other["identifier"] = "other"
    for item in other["faces"]:
        item["identifier"] += "_2"
    east, west = value["rooms"][0]["faces"][5], other["faces"][4]
    for own, twin in ((east, "west_2"), (west, "east")):
        own["boundary_condition"] = {
            "type": "Surface",
            "boundary_condition_objects": [twin, "room"],
        }
    other["faces"][2]["apertures"] = []
    value["rooms"].append(other)
    names = [s.name for s in read(value).scene.surfaces]
    assert "east" in names
    assert "west_2" not in names
    assert len(names) == 12


def test_an_air_boundary_is_open(read):
    value = model()
    value["rooms"][0]["faces"][3]["face_type"] = "AirBoundary"
    assert "north" not in [s.name for s in read(value).scene.surfaces]


def test_sets_give_what_faces_do_not_say(read):
    brown = {"type": "Plastic", "identifier": "brown", "r_reflectance": 0.4}
    walls = {"identifier": "old", "wall_set": {"exterior_modifier": "brown"}}
    value = model(modifiers=[GLASS, brown], modifier_sets=[walls])
    value["rooms"][0]["properties"] = {"radiance": {"modifier_set": "old"}}
    assert surface(read(value), "west").material == "brown"


def test_trans_has_the_numbers_of_radiance(read):
    """Honeybee hands its seven numbers to Radiance as they are."""
    trans = {
        "type": "Trans", "identifier": "film", "r_reflectance": 0.5,
        "g_reflectance": 0.5, "b_reflectance": 0.5, "specularity": 0.02,
        "roughness": 0.1, "transmitted_diff": 0.45, "transmitted_spec": 0.25,
    }  # fmt: skip
    value = model(modifiers=[GLASS, trans])
    value["rooms"][0]["faces"][5]["properties"]["radiance"] = {"modifier": "film"}
    film = read(value).scene.materials["film"]
    assert isinstance(film, Trans)
    numbers = film.specularity, film.roughness, film.transmission
    assert (*numbers, film.transmitted_specular) == (0.02, 0.1, 0.45, 0.25)


def test_grids_and_views_have_names_and_metres(read):
    sensor = {"pos": [2, 2, 0.75], "dir": [0, 0, 2]}
    grid = {"identifier": "g", "display_name": "desk/1", "sensors": [sensor]}
    view = {
        "identifier": "eye", "position": [2, 3, 1.2], "direction": [0, -1, 0],
        "view_type": "a", "h_size": 180, "v_size": 180,
    }  # fmt: skip
    found = read(model(units="Feet", sensor_grids=[grid, grid], views=[view]))
    assert list(found.grids) == ["desk-1", "desk-1 2"]
    place = found.grids["desk-1"].position[0]
    assert place == pytest.approx([0.6096, 0.6096, 0.2286])
    assert found.grids["desk-1"].direction.tolist() == [[0, 0, 1]]
    assert found.views["eye"].kind == "angular"


def test_what_is_left_out_is_reported(read):
    value = model(modifiers=[GLASS, {"type": "Mist", "identifier": "fog"}])
    assert read(value).unsupported == ('modifier "fog" of type Mist',)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"units": "Parsecs"}, r'units is "Parsecs"; "Meters", "Millimeters"'),
        ({"rooms": 3}, "rooms is 3; a list in"),
        (
            {"rooms": [{"faces": [{"identifier": "a"}]}]},
            r"rooms\[0\].faces\[0\].geometry.boundary is missing",
        ),
    ],
)
def test_errors_name_the_place(read, change, message):
    with pytest.raises(InputError, match=message):
        read(model() | change)


_JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.text(max_size=5), inner, max_size=3)
    ),
    max_leaves=6,
)


@settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_a_damaged_model_is_refused_in_words(read, data):
    """Any member of the model is replaced by anything."""
    value = copy.deepcopy(model(sensor_grids=[{"identifier": "g", "sensors": []}]))
    at = value
    for _ in range(data.draw(st.integers(1, 7))):
        keys = list(at) if isinstance(at, dict) else list(range(len(at)))
        if not keys:
            break
        key = data.draw(st.sampled_from(keys))
        if not isinstance(at[key], dict | list) or data.draw(st.booleans()):
            at[key] = data.draw(_JSON)
            break
        at = at[key]
    with suppress(InputError, ClerestoryWarning):
        read(value)


def test_windows_of_plain_glass_become_groups_of_one_room_on_request(tmp_path):
    """Two offices side by side: their windows are in one plane, of one glass."""
    path = tmp_path / "model.hbjson"
    path.write_text(json.dumps(building(2)))
    assert not read_hbjson(path).windows
    windows = read_hbjson(path, window_groups=True).windows
    assert [group.name for group in windows] == ["r0 pane", "r1 pane"]
    assert [len(group.polygons) for group in windows] == [1, 1]
