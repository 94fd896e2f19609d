"""Keys in which the studies of compared runs differ."""

from clerestory.study.compared_settings import compared_settings

STUDY = {
    "title": "anna",
    "report": {"author": "Anna"},
    "scene": {"files": ["materials.rad", "room.rad"]},
    "window": [{"name": "south", "bsdf": "blind.xml", "state": []}],
    "sensors": [{"file": "desks.pts"}],
    "weather": {"file": "oslo.epw"},
    "sky": {"rotation_deg": 0.0},
    "trace": {"device": "cpu", "seed": 1},
    "sunlight": None,
}


def test_equal_studies_differ_in_nothing_that_changes_results():
    trace = {"device": "auto", "seed": 1}
    other = {**STUDY, "title": "ben", "report": {}, "trace": trace}
    assert compared_settings([STUDY, other]) == [{}, {}]


def test_tables_are_named_and_paths_are_shortened():
    other = {
        **STUDY,
        "window": [{"name": "south", "bsdf": "/home/ben/open.xml"}],
        "sensors": [{"file": "../eyes.pts"}],
        "sky": {"rotation_deg": 90.0},
    }
    assert compared_settings([STUDY, other]) == [
        {
            "window.south.bsdf": "blind.xml",
            "sensors.1.file": "desks.pts",
            "sky.rotation_deg": "0",
        },
        {
            "window.south.bsdf": "open.xml",
            "sensors.1.file": "eyes.pts",
            "sky.rotation_deg": "90",
        },
    ]


def test_a_key_of_one_study_alone_is_a_dash_in_the_others():
    other = {**STUDY, "sunlight": {"depth": 0.3}, "scene": {"files": ["a/dark.rad"]}}
    first, second = compared_settings([STUDY, other])
    assert first["sunlight.depth"] == "–"
    assert second == {"scene.files": "dark.rad", "sunlight.depth": "0.3"}


def test_values_and_keys_have_a_largest_number():
    many = {str(k): {"key": "x" * 100} for k in range(20)}
    found = compared_settings([{}, many])
    assert [len(one) for one in found] == [8, 8]
    assert {len(value) for value in found[1].values()} == {60}


def test_files_of_equal_names_are_told_apart_by_their_content():
    files = {"materials.rad": "11aa22bb", "room.rad": "33cc44dd", "oslo.epw": "55ee"}
    edited = {**files, "room.rad": "99ff00aa"}
    assert compared_settings([STUDY, STUDY], [files, edited]) == [
        {"scene.files": "room.rad (33cc44)"},
        {"scene.files": "room.rad (99ff00)"},
    ]
    assert compared_settings([STUDY, STUDY], [files, files]) == [{}, {}]


def test_the_last_of_many_edited_files_is_found():
    names = [f"a_long_name_of_a_scene_file_{k}.rad" for k in range(9)]
    study = {"scene": {"files": names}}
    files = dict.fromkeys(names, "11aa22bb")
    first, second = compared_settings([study, study], [files, files | {names[-1]: "9"}])
    assert first == {"scene.files": f"{names[-1]} (11aa22)"}
    assert second == {"scene.files": f"{names[-1]} (9)"}


def test_runs_without_hashes_are_compared_by_names():
    assert compared_settings([STUDY, STUDY], [{}, {"room.rad": "99ff"}]) == [{}, {}]
