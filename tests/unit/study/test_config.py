"""A wrong study file is answered by its line and the valid choices."""

import re

import pytest

from clerestory.errors import InputError
from clerestory.study.config import Study, read_study
from clerestory.study.inputs import read_inputs


def change(study_file, old, new):
    text = study_file.read_text()
    assert text.count(old) >= 1
    study_file.write_text(text.replace(old, new, 1))


def line_of(study_file, words):
    lines = study_file.read_text().splitlines()
    return next(n for n, line in enumerate(lines, 1) if words in line)


def complaint(study_file):
    with pytest.raises(InputError) as caught:
        read_study(study_file)
    assert "\n" not in str(caught.value)
    assert caught.value.exit_status == 2
    return caught.value


def test_a_good_study_is_read_with_its_defaults(study_file):
    study = read_study(study_file)
    assert study.title == "Test room"
    assert study.scene.files == [study_file.parent / "room.rad"]
    assert [table.label for table in study.sensors] == ["desk", "eye"]
    assert (study.trace.samples, study.trace.relative_error) == (256, None)
    assert study.trace.bounces is None
    assert study.schedule.from_hour == 8
    assert study.sky.ground_reflectance == 0.2


def test_paths_are_relative_to_the_study_file(study_file, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert read_study("study/study.toml").scene.files[0].is_file()


def test_the_title_of_an_untitled_study_is_the_name_of_its_file(study_file):
    change(study_file, 'title = "Test room"\n', "")
    assert read_study(study_file).title == "study"


def test_facts_name_files_relative_to_the_study(study_file):
    facts = read_study(study_file).facts()
    assert facts["window"][0]["bsdf"] == "diffuser.xml"
    assert str(study_file.parent) not in read_study(study_file).to_json()


# What is replaced, by what, words on the line complained of, words of the message
WRONG = {
    "text for a number": (
        "samples = 256",
        'samples = "many"',
        "samples",
        'trace.samples is "many"; a whole number expected',
    ),
    "fraction of a sample": (
        "samples = 256",
        "samples = 2.5",
        "samples",
        "is 2.5; a whole number expected",
    ),
    "no samples": (
        "samples = 256",
        "samples = 0",
        "samples",
        "a number of at least 1 expected",
    ),
    "true for a number": (
        "samples = 256",
        "samples = true",
        "samples",
        "is true; a whole number expected",
    ),
    "both goals": (
        "samples = 256",
        "samples = 256\nrelative_error = 0.1",
        "[trace]",
        'both "samples" and "relative_error"; one of them expected',
    ),
    "error of nothing": (
        "samples = 256",
        "relative_error = 0",
        "relative_error",
        "a number above 0 expected",
    ),
    "error not a number": (
        "samples = 256",
        "relative_error = nan",
        "relative_error",
        "a finite number expected",
    ),
    "negative seed": ("seed = 7", "seed = -1", "seed", "a number of at least 0"),
    "unknown key": (
        "seed = 7",
        "sead = 7",
        "sead",
        'unknown key "trace.sead"; one of relative_error, samples, bounces, seed',
    ),
    "unknown table": (
        "[trace]",
        "[trase]",
        "[trase]",
        'unknown key "trase"; one of title, method, scene, window',
    ),
    "unknown method": (
        '"3-phase"',
        '"7-phase"',
        "method",
        'method is "7-phase"; "2-phase", "3-phase", "4-phase", "5-phase" or'
        ' "6-phase" expected',
    ),
    "picture at a time of no calendar": (
        "[weather]",
        '[[view]]\nfile = "room.rad"\npictures = ["13-01T12:00"]\n[weather]',
        "pictures",
        "13-01T12:00",
    ),
    "view without a name": (
        "[weather]",
        "[[view]]\nposition = [1, 1, 1.2]\ndirection = [0, -1, 0]\n[weather]",
        "[[view]]",
        '"position" without "name"; a name expected',
    ),
    "view without a direction": (
        "[weather]",
        '[[view]]\nname = "a"\nposition = [1, 1, 1.2]\n[weather]',
        "[[view]]",
        '"position" or "direction" without the other; both expected',
    ),
    "view in no direction": (
        "[weather]",
        '[[view]]\nname = "a"\nposition = [1, 1, 1]\ndirection = [0, 0, 0]\n[weather]',
        "[[view]]",
        '"direction" is zero; the direction of view expected',
    ),
    "view twice": (
        "[weather]",
        '[[view]]\nfile = "room.rad"\nposition = [1, 1, 1.2]\n[weather]',
        "[[view]]",
        'both "file" and "position"; one of them expected',
    ),
    "view of nothing": (
        "[weather]",
        "[[view]]\n[weather]",
        "[[view]]",
        'neither "file" nor "position"; one of them expected',
    ),
    "view of two coordinates": (
        "[weather]",
        '[[view]]\nname = "a"\nposition = [1, 1]\ndirection = [0, 1, 0]\n[weather]',
        "position",
        "position is [1, 1]; a list of at least 3 expected",
    ),
    "two-phase with a picture": (
        'method = "3-phase"',
        'method = "2-phase"\n[[view]]\nfile = "room.rad"',
        "",
        "no table [[view]] expected",
    ),
    "two-phase with a view grid behind a window": (
        'method = "3-phase"',
        'method = "2-phase"\n[[view_grid]]\nname = "a"\nplaces = [[2, 1, 1.2]]',
        "",
        'and a table [[window]]; glazing in the scene, or method = "5-phase", expected',
    ),
    "unknown device": (
        "seed = 7",
        'device = "gpu"',
        "device",
        '"auto", "cpu" or "cuda" expected',
    ),
    "sky too fine": (
        "subdivision = 1",
        "subdivision = 7",
        "subdivision",
        "1, 2, 3, 4, 5 or 6 expected",
    ),
    "ground too bright": (
        "subdivision = 1",
        "ground_reflectance = 1.2",
        "ground_reflectance",
        "a number of at most 1 expected",
    ),
    "scene not a list": (
        '["room.rad"]',
        '"room.rad"',
        "files",
        "a list in [ ] expected",
    ),
    "scene empty": ('["room.rad"]', "[]", "files", "a list of at least 1 expected"),
    "number for a file": (
        '["room.rad"]',
        "[7]",
        "files",
        "is 7; the name of a file in quotes expected",
    ),
    "missing scene file": (
        '["room.rad"]',
        '[\n  "room.rad",\n  "wall.rad"\n]',
        "files",
        'is "wall.rad"; the name of a file that exists expected',
    ),
    "missing weather": (
        '"two_days.wea"',
        '"oslo.epw"',
        "oslo",
        'weather.file is "oslo.epw"',
    ),
    "window without BSDF": (
        'bsdf = "diffuser.xml"\n',
        "",
        "[[window]]",
        'neither "bsdf" nor [[window.state]]; one of them expected',
    ),
    "window without file": (
        'file = "window.rad"\n',
        "",
        "[[window]]",
        "window[1].file is missing",
    ),
    "no sensors": (
        '[[sensors]]\nfile = "desk.pts"\n\n[[sensors]]\nfile = "eye.pts"',
        "",
        "",
        "sensors is missing; at least one table [[sensors]] expected",
    ),
    "sensors as one table": (
        '[[sensors]]\nfile = "desk.pts"\n\n[[sensors]]\nfile = "eye.pts"',
        '[sensors]\nfile = "desk.pts"',
        "[sensors]",
        "a list in [ ] expected",
    ),
    "two grids of one name": (
        'file = "eye.pts"',
        'file = "desk.pts"',
        "",
        'two tables have the name "desk"; different names expected',
    ),
    "name with a slash": (
        'name = "south"',
        'name = "so/uth"',
        "name",
        "letters, digits, spaces, dots and dashes expected",
    ),
    "schedule backwards": (
        "[output]",
        "[schedule]\nfrom_hour = 18\nto_hour = 8\n[output]",
        "[schedule]",
        '"from_hour" is not before "to_hour"',
    ),
    "no such day": (
        'file = "two_days.wea"',
        'file = "two_days.wea"\nfrom = "13-01"',
        "from",
        'a day of the year as "MM-DD" expected',
    ),
    "not TOML": (
        "seed = 7",
        "seed = = 7",
        "seed",
        "not TOML: Invalid value",
    ),
    "table not closed": ("[trace]", "[trace", "[trace", "not TOML"),
    "key given twice": (
        "seed = 7",
        "seed = 7\nseed = 8",
        "seed = 8",
        "not TOML: Cannot overwrite a value",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_errors_of_a_study_name_line_and_choices(study_file, case):
    old, new, place, words = WRONG[case]
    change(study_file, old, new)
    error = complaint(study_file)
    assert words in str(error)
    if place:
        assert error.line == line_of(study_file, place)
        assert re.match(rf".*study\.toml:{error.line}: ", str(error))


def test_a_truncated_study_is_reported_at_its_end(study_file):
    text = study_file.read_text()
    study_file.write_text(text[: text.index("phase")])
    error = complaint(study_file)
    assert "not TOML" in str(error)
    assert error.line == 2


def test_a_missing_study_is_reported():
    with pytest.raises(InputError, match="No such file"):
        read_study("no_such_study.toml")


def test_errors_of_an_empty_study_name_the_missing_tables(study_file):
    study_file.write_text("")
    assert "is missing" in str(complaint(study_file))


def test_several_faults_are_reported_one_by_one(study_file):
    change(study_file, "samples = 256", "samples = 0")
    change(study_file, "subdivision = 1", "subdivision = 9")
    message = str(complaint(study_file))
    assert "sky.subdivision" in message
    assert message.endswith("(and 1 more)")


def test_seed_and_device_can_be_replaced(study_file):
    study = read_study(study_file)
    other = study.with_trace(seed=9, device="cpu")
    assert (other.trace.seed, other.trace.device) == (9, "cpu")
    assert study.with_trace().trace == study.trace
    assert isinstance(other, Study)
    assert other.facts()["scene"] == study.facts()["scene"]


@pytest.mark.parametrize("day", ["01-31", "03-22", "06-21"])
def test_the_sun_is_followed_between_february_and_the_equinox(study_file, day):
    text = study_file.read_text()
    study_file.write_text(f'{text}\n[sunlight]\nday = "{day}"\n')
    assert f'"day" is "{day}"; a day from "02-01" to "03-21" expected' in str(
        complaint(study_file)
    )


def test_sunlight_needs_openings(study_file):
    text = study_file.read_text().split("[[window]]")
    rest = text[1].split("[[sensors]]", 1)[1]
    first = text[0].replace("3-phase", "2-phase")
    study_file.write_text(f"{first}[[sensors]]{rest}\n[sunlight]\n")
    assert "[sunlight] without a window" in str(complaint(study_file))


SENSITIVITY = [
    ("", "materials"),
    ("materials = []", 'a list of names of materials, or "all"'),
    ('materials = "every"', "all"),
    ('materials = "all"\nstep = 0', "step"),
    ('materials = "all"\nstep = 0.9', "step"),
]


@pytest.mark.parametrize(("text", "words"), SENSITIVITY)
def test_sensitivity_needs_materials_and_a_step(study_file, text, words):
    given = study_file.read_text()
    study_file.write_text(f"{given}\n[sensitivity]\n{text}\n")
    with pytest.raises(InputError, match=words):
        read_study(study_file)


ENERGY = '[energy]\nmodel = "office.idf"\n'
WRONG_ENERGY = {
    "window": (
        '[[energy.window]]\nname = "roof"\nsurfaces = ["s"]\nconstructions = ["c"]\n',
        '[energy] refers to window "roof"',
    ),
    "zone": (
        '[[energy.lights]]\nlights = "lamps"\n',
        '[energy] refers to lighting zone ""; one of none expected',
    ),
    "surface": (
        '[[energy.window]]\nname = "a"\nsurfaces = ["s", "S"]\nconstructions = ["c"]\n',
        'surface "s" is named twice',
    ),
    "comfort": ("comfort_c = [26.0, 20.0]\n", "the lower limit first"),
    "sun": ('solar = "ours"\n', 'solar is "ours"'),
}


@pytest.mark.parametrize("case", WRONG_ENERGY)
def test_energy_refers_to_tables_of_the_study(study_file, case):
    table, words = WRONG_ENERGY[case]
    (study_file.parent / "office.idf").touch()
    study_file.write_text(f"{study_file.read_text()}\n{ENERGY}{table}")
    assert words in str(complaint(study_file))


OF_ZONES = {
    "prediction": (
        'rule = "predictive"',
        'rule "predictive" of window "south" depends',
    ),
    "season": (
        'rule = "cooling season"\ngrid = "desk"',
        'rule "cooling season" of window "south" depends on the zone',
    ),
    "load": (
        'rule = "threshold"\nquantity = "cooling load"\nclose_above = 100',
        'rule "threshold" of window "south" depends on the zone',
    ),
    "key": ('rule = "glare"\nhorizon = 12', 'rule "glare" has no key "horizon"'),
    "grid": ('rule = "cooling season"', 'rule "cooling season" without "grid"'),
    "horizon": ('rule = "predictive"\nhorizon = 0', "a number above 0"),
    "eyes": ('rule = "predictive"\neye_grid = "eyes"', 'refers to grid "eyes"'),
}


@pytest.mark.parametrize("case", OF_ZONES)
def test_rules_that_know_the_zone_need_a_model(study_file, case):
    rule, words = OF_ZONES[case]
    text = study_file.read_text()
    state = '\n[[window.state]]\nbsdf = "'
    text = re.sub(
        r'\nbsdf = "(.+)"',
        rf'{state}\1"\nname = "a"{state}\1"\nname = "b"\n[window.control]\n{rule}',
        text,
        count=1,
    )
    study_file.write_text(text)
    assert words in str(complaint(study_file))


def test_a_view_has_a_position_and_a_direction_or_a_file(study_file):
    """Both are the same fisheye view; one that looks up has +y at its top."""
    line = "rvu -vta -vp 1 2 1.2 -vd 0 -1 0 -vu 0 0 1 -vh 180 -vv 180\n"
    (study_file.parent / "seat.vf").write_text(line)
    table = '[[view]]\nname = "{}"\nposition = [1, 2, 1.2]\ndirection = [0, {}]\n'
    tables = table.format("a", "-2, 0") + table.format("up", "0, 1")
    with study_file.open("a") as stream:
        stream.write(f'\n{tables}\n[[view]]\nfile = "seat.vf"\n')
    study = read_study(study_file)
    assert [view.label for view in study.view] == ["a", "up", "seat"]
    own, up, file = (camera.view for camera in read_inputs(study).cameras)
    for name in ("kind", "horizontal", "vertical"):
        assert getattr(own, name) == getattr(file, name)
    for name in ("position", "direction", "up"):
        assert getattr(own, name).tolist() == getattr(file, name).tolist()
    assert up.up.tolist() == [0, 1, 0]
