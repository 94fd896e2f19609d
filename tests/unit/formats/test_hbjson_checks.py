"""Honeybee models that cannot be simulated: one line, which names the object."""

import json

import pytest
from honeybee_models import GLASS, aperture, box, building, honeybee_model, office

from clerestory.errors import InputError
from clerestory.formats.hbjson import read_hbjson


@pytest.fixture
def refused(tmp_path):
    def message(model):
        path = tmp_path / "m.hbjson"
        path.write_text(json.dumps(model))
        with pytest.raises(InputError) as caught:
            read_hbjson(path)
        assert "\n" not in str(caught.value)
        return caught.value.message

    return message


def without(room, *sides):
    ends = tuple(f"_{side}" for side in sides)
    kept = [f for f in room["faces"] if not f["identifier"].endswith(ends)]
    return room | {"faces": kept}


def turned(points):
    return {"geometry": {"boundary": points[::-1]}}


def test_an_open_room_is_refused(refused):
    """Without its roof, the area vectors sum to 4 m × 5 m, downwards."""
    message = refused(honeybee_model(without(office(), "roof")))
    assert message == (
        'room "office" is open or has overlapping faces: 20 m² of its surface are not'
        " balanced; a closed room expected"
    )


def test_a_tube_is_refused(refused):
    """Without floor and roof the area vectors cancel, but their moments do not."""
    assert 'room "office" is open' in refused(
        honeybee_model(without(office(), "roof", "floor"))
    )


def test_a_face_that_faces_inwards_is_refused_by_name(refused):
    roof = [[0, 0, 3], [4, 0, 3], [4, 5, 3], [0, 5, 3]]
    message = refused(honeybee_model(office(roof=turned(roof))))
    assert message == (
        'face "office_roof" of room "office" faces inwards; vertices counter-clockwise'
        " as seen from outside the room expected"
    )


def test_a_room_inside_out_is_refused(refused):
    room = box("a", (4, 0, 0), (0, 5, 3))
    assert 'room "a" is inside out' in refused(honeybee_model(room))


def test_a_flipped_aperture_is_refused_by_name(refused):
    pane = aperture("pane_1", [[1, 0, 2], [3, 0, 2], [3, 0, 1], [1, 0, 1]])
    message = refused(honeybee_model(office(south={"apertures": [pane]})))
    assert message.startswith('aperture "pane_1" faces opposite to face "office_south"')


def test_an_aperture_beside_its_face_is_refused_by_name(refused):
    pane = aperture("pane_1", [[1, 0.5, 1], [3, 0.5, 1], [3, 0.5, 2], [1, 0.5, 2]])
    message = refused(honeybee_model(office(south={"apertures": [pane]})))
    assert message.startswith('aperture "pane_1" is 0.5 m from the plane of face')


@pytest.mark.parametrize("kind", ["room", "face", "aperture"])
def test_duplicate_identifiers_are_refused(refused, kind):
    one, two = office("a"), office("b", x=10)
    if kind == "room":
        two["identifier"] = "a"
    elif kind == "face":
        two["faces"][0]["identifier"] = "a_floor"
    else:
        two["faces"][2]["apertures"][0]["identifier"] = "a_window"
    what = {"room": "a", "face": "a_floor", "aperture": "a_window"}[kind]
    message = refused(honeybee_model(one, two))
    assert message.startswith(f"several {kind}s are named '{what}'")


def test_a_missing_modifier_is_refused_with_its_object(refused):
    room = office(north={"properties": {"radiance": {"modifier": "marble"}}})
    message = refused(honeybee_model(room))
    assert message == (
        'modifier "marble" of "office_north" is not in the model; one of its modifiers'
        " expected"
    )


def test_a_modifier_of_unknown_type_is_refused_where_it_is_used(refused):
    room = office(north={"properties": {"radiance": {"modifier": "fog"}}})
    fog = {"type": "Mist", "identifier": "fog"}
    message = refused(honeybee_model(room, modifiers=[GLASS, fog]))
    assert message.startswith('modifier "fog" of "office_north" is of type Mist; ')


def test_modifiers_with_one_identifier_and_two_values_are_refused(refused):
    grey = {"type": "Plastic", "identifier": "grey", "r_reflectance": 0.4}
    model = honeybee_model(modifiers=[grey, grey | {"r_reflectance": 0.5}])
    assert "several modifiers are named 'grey'" in refused(model)


def test_a_model_far_from_the_origin_is_refused(refused):
    """In 32-bit numbers coordinates of 1,000 km are multiples of 6 cm."""
    message = refused(honeybee_model(office(x=1e6)))
    assert message == (
        "a corner is 1000 km from the origin; at most 10 km expected: move the model"
        " to the origin"
    )


def test_a_building_of_a_hundred_rooms_is_accepted(tmp_path):
    path = tmp_path / "m.hbjson"
    path.write_text(json.dumps(building()))
    model = read_hbjson(path)
    # Nine of ten walls between neighbours are given twice
    assert len(model.scene.surfaces) == 100 * 7 - 90
    assert len(model.rooms) == 100
