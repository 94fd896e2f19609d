"""`clerestory import`: from a honeybee model to a study that runs."""

import importlib.resources
import json

import numpy as np
import pytest
import xarray as xr
from honeybee_models import GLASS, building, honeybee_model, office

from clerestory.radiance.rad_reader import read_rad
from clerestory.study.config import read_study
from ifc_models import ifc_room

WEATHER = importlib.resources.files("pvlib") / "data" / "723170TYA.CSV"


@pytest.fixture
def convert(call, tmp_path):
    """Import a model beside the weather of the demo; return folder and outcome."""

    def run(model, *options, weather=True):
        path, out = tmp_path / "model.hbjson", tmp_path / "study"
        path.write_text(json.dumps(model))
        words = ["--weather", WEATHER] if weather else []
        return out, call("import", path, "-o", out, *words, *options)

    return run


def one_noon(study):
    """Restrict a study to one hour and few samples."""
    text = study.read_text().replace(
        "[weather]", '[weather]\nmoments = ["06-21T11:30"]'
    )
    study.write_text(f"{text}\n[trace]\nsamples = 64\nbounces = 2\n")


def test_a_building_of_a_hundred_rooms_gives_a_study(convert):
    out, outcome = convert(building(), "--spacing", "1.5")
    assert outcome.status == 0, outcome.err
    assert "grids above the floors of rooms without sensors: 100" in outcome.out
    study = read_study(out / "study.toml")
    assert len(study.sensors) == 100
    assert study.methods == ["2-phase"]


@pytest.mark.slow
def test_the_study_of_a_hundred_rooms_runs(convert, call, tmp_path):
    out, _ = convert(building(), "--spacing", "1.5")
    one_noon(out / "study.toml")
    outcome = call("run", out / "study.toml", "--out", tmp_path / "results", "--quiet")
    assert outcome.status == 0, outcome.err
    assert (tmp_path / "results" / "report.html").stat().st_size > 0
    with xr.open_dataset(tmp_path / "results" / "results.nc") as found:
        lux = found["illuminance"].load()
    assert lux.sizes["sensor"] == 100 * 2 * 3
    # The window is 2 m² of glass in 12 m² of wall: every room receives light
    assert float(lux.groupby("grid").mean().min()) > 0


def test_height_and_north_reach_the_study(convert):
    out, _ = convert(honeybee_model(office()), "--height", "0.85", "--north", "30")
    rows = np.loadtxt(out / "office.pts")
    assert np.all(rows[:, 2] == 0.85)
    assert read_study(out / "study.toml").sky.rotation_deg == 30


def test_without_weather_the_missing_study_is_announced(convert):
    out, outcome = convert(honeybee_model(office()), weather=False)
    assert outcome.status == 0
    assert "no study was written: --weather FILE expected" in outcome.out
    assert (out / "office.pts").is_file()
    assert not (out / "study.toml").exists()


def test_what_is_left_out_is_in_one_file(convert):
    model = honeybee_model(office())
    model["properties"]["energy"] = {}
    out, outcome = convert(model)
    assert (out / "left_out.txt").read_text() == "the energy properties of the model\n"
    assert "left out: the energy properties of the model" in outcome.out


def flipped(model):
    outline = model["rooms"][0]["faces"][2]["apertures"][0]["geometry"]["boundary"]
    outline.reverse()


def unknown(model):
    radiance = {"radiance": {"modifier": "marble"}}
    model["rooms"][0]["faces"][3]["properties"] = radiance


def bad_bsdf(model):
    bsdf = {"type": "BSDF", "identifier": "pane", "bsdf_data": "<x/>"}
    model["properties"]["radiance"]["modifiers"] = [bsdf]


# Change of a model that makes it bad, and words of the message
FAULTS = {
    "open room": (lambda m: m["rooms"][0]["faces"].pop(), 'room "office" is open'),
    "flipped aperture": (flipped, 'aperture "office_window" faces opposite to face'),
    "missing modifier": (unknown, 'modifier "marble" of "office_north" is not in'),
    "duplicate": (lambda m: m["rooms"].append(office(x=9)), "several rooms are named"),
    "far": (lambda m: m.update(rooms=[office(x=1e6)]), "is 1000 km from the origin"),
    "BSDF": (bad_bsdf, 'the BSDF of modifier "pane"'),
}


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("command", ["import", "recipe"])
def test_nothing_is_written_for_a_bad_model(call, tmp_path, command, fault):
    model, (change, message) = honeybee_model(office()), FAULTS[fault]
    change(model)
    path, out = tmp_path / "model.hbjson", tmp_path / "out"
    path.write_text(json.dumps(model))
    if command == "import":
        words = [path, "-o", out, "--weather", WEATHER]
    else:
        inputs = tmp_path / "inputs.json"
        inputs.write_text(json.dumps({"model": str(path), "wea": str(WEATHER)}))
        words = ["annual-daylight", inputs, "--folder", out]
    outcome = call(command, *words)
    assert outcome.status == 2
    assert message in outcome.err
    assert len(outcome.err.strip().splitlines()) == 1
    assert not out.exists()


def test_nothing_is_written_without_valid_weather(convert, tmp_path):
    (tmp_path / "bad.epw").write_text("no weather")
    words = ("--weather", tmp_path / "bad.epw")
    out, outcome = convert(honeybee_model(office()), *words, weather=False)
    assert outcome.status == 2
    assert len(outcome.err.strip().splitlines()) == 1
    assert not out.exists()


def test_inner_glass_stays_between_two_rooms(convert):
    """The opening of the twin face is not added a second time."""
    one, two = office("a"), office("b", x=4)
    points = [[4, 1, 1], [4, 2, 1], [4, 2, 2], [4, 1, 2]]
    for room, side, other, outline in (
        (one, 5, "b", points),
        (two, 4, "a", points[::-1]),
    ):
        own = room["identifier"]
        side_of = {"a": "east", "b": "west"}
        room["faces"][side]["boundary_condition"] = {
            "type": "Surface",
            "boundary_condition_objects": [f"{other}_{side_of[other]}", other],
        }
        room["faces"][side]["apertures"] = [
            {
                "identifier": f"{own}_inner",
                "geometry": {"boundary": outline},
                "boundary_condition": {
                    "type": "Surface",
                    "boundary_condition_objects": [f"{other}_inner", other],
                },
            }
        ]
    out, outcome = convert(honeybee_model(one, two))
    assert outcome.status == 0, outcome.err
    names = [s.name for s in read_rad(out / "scene.rad").surfaces]
    assert "a_inner" in names
    assert "b_inner" not in names
    assert read_study(out / "study.toml").methods == ["2-phase"]


def test_a_skylight_with_states_becomes_a_window_group(convert):
    points = [[1, 1, 3], [2, 1, 3], [2, 2, 3], [1, 2, 3]]
    tint = GLASS | {"identifier": "tint", "g_transmissivity": 0.1}
    states = [{"modifier": "pane"}, {"modifier": "tint"}]
    sky = {
        "identifier": "sky",
        "geometry": {"boundary": points},
        "properties": {
            "radiance": {"dynamic_group_identifier": "roof", "states": states}
        },
    }
    room = office(roof={"apertures": [sky]})
    out, outcome = convert(honeybee_model(room, modifiers=[GLASS, tint]))
    assert outcome.status == 0, outcome.err
    study = read_study(out / "study.toml")
    tables = {table.name: table for table in study.window}
    assert [state.name for state in tables["roof"].state] == ["pane", "tint"]
    assert set(tables) == {"roof", "pane"}


MODELS = (
    "complex",
    "hb_sample_model_grid",
    "large_light_path_model",
    "model_radiance_dynamic_states",
    "room_w_dynamic_skylight",
    "two_rooms",
)


@pytest.mark.slow
@pytest.mark.parametrize("name", MODELS)
def test_models_of_honeybee_give_a_study_that_runs(call, shared_data, tmp_path, name):
    model = shared_data / "models" / "hbjson_honeybee-radiance" / f"{name}.hbjson"
    out, results = tmp_path / "study", tmp_path / "results"
    outcome = call("import", model, "-o", out, "--weather", WEATHER)
    assert outcome.status == 0, outcome.err
    one_noon(out / "study.toml")
    outcome = call("run", out / "study.toml", "--out", results, "--quiet")
    assert outcome.status == 0, outcome.err
    assert (results / "report.html").stat().st_size > 0


def test_an_ifc_model_gives_a_study(call, tmp_path):
    pytest.importorskip("ifcopenshell")
    path, out = tmp_path / "room.ifc", tmp_path / "study"
    path.write_text(ifc_room())
    outcome = call("import", path, "-o", out, "--weather", WEATHER)
    assert outcome.status == 0, outcome.err
    assert "assumed: reflectance 0.5 of IfcWall: 5" in outcome.out
    study = read_study(out / "study.toml")
    assert study.sky.rotation_deg == pytest.approx(-30)
    assert [grid.name for grid in study.sensors] == ["1.01 Office"]
    assumed = (out / "assumptions.txt").read_text()
    assert "position of the site: that of the weather file, 36.10° north" in assumed


@pytest.mark.slow
def test_the_study_of_an_ifc_model_runs(call, tmp_path):
    pytest.importorskip("ifcopenshell")
    path, out = tmp_path / "room.ifc", tmp_path / "study"
    path.write_text(ifc_room())
    call("import", path, "-o", out, "--weather", WEATHER)
    one_noon(out / "study.toml")
    outcome = call("run", out / "study.toml", "--out", tmp_path / "run", "--quiet")
    assert outcome.status == 0, outcome.err
    with xr.open_dataset(tmp_path / "run" / "results.nc") as found:
        lux = found["illuminance"].load()
    assert lux.sizes["sensor"] == 76
    # The first two rows of eight sensors lie next to the window
    assert float(lux[:16].mean()) > 2 * float(lux[16:].mean()) > 0


def test_a_scale_in_the_map_of_an_ifc_model_is_refused(call, tmp_path):
    path, materials = tmp_path / "room.ifc", tmp_path / "m.toml"
    path.write_text(ifc_room())
    materials.write_text('scale = 0.001\n[materials]\n"*" = { reflectance = 0.5 }\n')
    outcome = call("import", path, "-o", tmp_path / "o", "--materials", materials)
    assert outcome.status == 2
    assert 'keys "scale" or "up"; IFC files have units' in outcome.err
    assert not (tmp_path / "o").exists()
