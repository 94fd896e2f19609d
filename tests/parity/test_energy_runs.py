"""A year of EnergyPlus with the shades and lights of a study."""

import importlib.util
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.cli.main import main
from clerestory.energyplus.building_model import read_building_model
from clerestory.energyplus.complex_fenestration import complex_fenestration
from clerestory.energyplus.engine_run import Actuator, AnnualRun, Output, simulate
from clerestory.energyplus.input_objects import as_idf
from clerestory.errors import InputError
from clerestory.glare.dgp import simplified_dgp
from clerestory.glazing.stack import stack_layers
from clerestory.hemisphere.klems import klems
from clerestory.phases.matrix_store import MatrixStore
from clerestory.progress import silent
from clerestory.study.config import read_study
from clerestory.study.energy_model import energy_model
from clerestory.study.energy_simulation import run_building
from clerestory.study.energy_solar import solar_radiation
from clerestory.study.inputs import read_inputs
from clerestory.study.job import Job
from energy_models import (
    BASIS,
    PLAIN,
    SMALL_OFFICE,
    annual_outputs,
    double_glazing,
    shaded_glazing,
)

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        importlib.util.find_spec("pyenergyplus") is None,
        reason="EnergyPlus is not installed (extra energy)",
    ),
]

ROOM = Path(__file__).parents[1] / "cli" / "room"
SYSTEMS = {
    "clear": double_glazing(),
    "blind": shaded_glazing(45),
}
METERS = (
    "Heating:EnergyTransfer",
    "Cooling:EnergyTransfer",
    "InteriorLights:Electricity",
)
STUDY = """
method = "3-phase"
[scene]
files = ["room.rad"]
[[window]]
name = "south"
file = "window.rad"
[[window.state]]
name = "clear"
bsdf = "bright.xml"
[[window.state]]
name = "blind"
bsdf = "dark.xml"
[window.control]
rule = "schedule"
file = "states.csv"
[[sensors]]
file = "desk.pts"
[[luminaire]]
file = "lamp.rad"
power = 90
[[lighting]]
grid = "desk"
[weather]
file = "weather.epw"
[sky]
subdivision = 1
[trace]
samples = 64
[energy]
model = "office.idf"
[[energy.window]]
name = "south"
surfaces = ["South Window"]
constructions = ["clear", "blind"]
[[energy.lights]]
lights = "Office Lights"
"""
YEAR = "RunPeriod,Year,1,1,,12,31"
DARK = """
WindowMaterial:Glazing,Grey,SpectralAverage,,0.003962,0.2,0.075,0.075,0.2,0.075,0.075,
  0,0.84,0.84,1.0;
Construction,dark,Grey,Space,Pane;
"""
LAMP = """void light lamp 0 0 3 90 90 90
lamp polygon panel 0 0 12 1.5 2 2.9 1.5 3 2.9 2.5 3 2.9 2.5 2 2.9
"""


def state(name, basis):
    """IDF text of a complex fenestration state."""
    light = stack_layers(SYSTEMS[name].layers, partition=basis)
    return as_idf(complex_fenestration(SYSTEMS[name], light, name=name))


@pytest.fixture(scope="module")
def states():
    """IDF text of all complex fenestration states."""
    return "\n".join(state(name, BASIS) for name in SYSTEMS)


@pytest.fixture
def folder(tmp_path, states, shared_data, monkeypatch):
    """Folder of a study whose window and lights are those of the office."""
    shutil.copytree(ROOM, tmp_path, dirs_exist_ok=True)
    shutil.copy(shared_data / "weather" / "chicago.epw", tmp_path / "weather.epw")
    write_bsdf(tmp_path / "bright.xml", lambertian(0.7, BASIS))
    write_bsdf(tmp_path / "dark.xml", lambertian(0.1, BASIS))
    (tmp_path / "lamp.rad").write_text(LAMP)
    (tmp_path / "office.idf").write_text(SMALL_OFFICE.text("clear", states))
    (tmp_path / "study.toml").write_text(STUDY)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def schedule(chosen_state):
    """Write the states of all hours of a year: one, or a function of the hour."""
    hours = np.arange("1990-01-01T00", "1991-01-01T00", dtype="datetime64[h]")
    given = chosen_state if callable(chosen_state) else lambda _: chosen_state
    chosen = [given(k % 24) for k in range(len(hours))]
    times = [str(hour).replace("T", " ") + ":30" for hour in hours]
    rows = "\n".join(f"{t},{s}" for t, s in zip(times, chosen, strict=True))
    Path("states.csv").write_text(f"time,south\n{rows}\n")


def alone(construction, *objects):
    """Energy [kWh] of the office by EnergyPlus without any actuator."""
    text = SMALL_OFFICE.text(construction, *objects)
    outputs = [Output(meter, sum=True) for meter in METERS]
    values = annual_outputs(Path(), Path("weather.epw"), text, outputs)
    return values.sum(axis=1) / 3.6e6


def run():
    assert main(["run", "study.toml", "--out", "results", "--quiet"]) == 0
    return xr.load_dataset("results/results.nc", engine="h5netcdf")


@pytest.mark.parametrize("state", [0, 1])
def test_a_constant_state_is_the_construction_of_the_model(state, folder, states):
    schedule(state)
    text = STUDY.partition("[[energy.lights]]")[0]
    Path("study.toml").write_text(text)
    found = run()["annual_energy"].sel(energy_use=["heating", "cooling", "lighting"])
    expected = alone(("clear", "blind")[state], states)
    assert expected[:2].min() > 100
    np.testing.assert_allclose(found, expected, rtol=1e-5)


def test_constructions_are_in_effect_in_the_time_step_that_they_are_given_for(folder):
    """Two states by turns, each for two hours: shares of the sun in quarter hours."""
    text = SMALL_OFFICE.text("plain", PLAIN, DARK)
    Path("turns.idf").write_text(text.replace(YEAR, "RunPeriod,Year,6,20,,6,21"))
    model = read_building_model("turns.idf").objects
    state = np.arange(4 * 8760) // 8 % 2
    names = ("plain", "dark")
    shades = Actuator("Surface", "Construction State", "South Window", state, names)
    solar = "Solar Radiation Rate"
    outputs = [
        Output(f"Surface Outside Face Incident {solar} per Area", "South Window"),
        Output(f"Surface Window Transmitted {solar}", "South Window"),
    ]
    weather = Path("weather.epw")
    job = AnnualRun(model, weather, [shades], outputs, steps_per_hour=4)
    incident, transmitted = simulate(job)
    lit = np.isfinite(incident) & (incident > 50)
    assert lit.sum() > 60
    share = transmitted[lit] / (3 * incident[lit])
    np.testing.assert_array_equal(share < 0.2, state[lit] == 1)


def test_shades_and_lights_follow_the_study(folder):
    schedule(lambda hour: int(10 <= hour < 16))
    data = run()
    lights = data["energy"].sel(energy_use="lighting").values
    np.testing.assert_allclose(lights, data["lighting_power"][0] / 1000, rtol=1e-4)
    closed = data["state"][0].values == 1
    incident, transmitted, absorbed = data["window_solar"].values[:, 0]
    lit = incident > 100
    share = transmitted[lit] / incident[lit]
    assert share[closed[lit]].max() < 0.4 < share[~closed[lit]].mean()
    assert (transmitted + absorbed)[lit].sum() < incident[lit].sum()
    facts = json.loads(Path("results/run.json").read_text())
    assert facts["warnings"] == []
    table = Path("results/energy.csv").read_text().splitlines()
    assert len(table) == 8761
    assert table[0].startswith("time,heating [kWh],cooling [kWh],lighting [kWh]")


WRONG = {
    "surface": ('surfaces = ["South Window"]', 'surfaces = ["Door"]', 'no .*"Door"'),
    "construction": ('["clear", "blind"]', '["clear", "dark"]', 'construction "dark"'),
    "states": ('["clear", "blind"]', '["clear"]', "1 constructions of .*2 states"),
    "window": ('name = "south"\nsurfaces', 'name = "n"\nsurfaces', 'window "n"'),
    "lights": ('lights = "Office Lights"', 'lights = "Desk"', 'no Lights "Desk"'),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_does_not_fit_is_one_line_before_tracing(name, folder, capsys):
    old, new, message = WRONG[name]
    assert STUDY.count(old) == 1
    Path("study.toml").write_text(STUDY.replace(old, new))
    schedule(0)
    assert main(["run", "study.toml", "--out", "results", "--quiet"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert re.search(message, said)
    assert not list(Path("results").rglob("*.nc"))


def test_errors_of_the_engine_are_its_own_message(folder, states):
    text = SMALL_OFFICE.text("clear", states).replace(
        "Construction,Slab", "Construction,Slap"
    )
    Path("bad.idf").write_text(text)
    model = read_building_model("bad.idf").objects
    outputs = [Output(METERS[0], sum=True)]
    with pytest.raises(InputError, match=r"EnergyPlus: .*[Cc]onstruction.*SLAB"):
        simulate(AnnualRun(model, Path("weather.epw"), [], outputs))


LIGHTS = "LightingLevel,100,,,0,0.4,0.2"
EVERY = ("South", "East", "North", "West", "Floor", "Ceiling")
GLARE_FREE = 'rule = "predictive"\neye_grid = "eye"\ndgp_below = 0.35'


def predictive_study(solar):
    """A study whose states are those of the construction, with predictive control."""
    basis = klems("quarter")
    for name, file in (("clear", "bright.xml"), ("blind", "dark.xml")):
        light = stack_layers(SYSTEMS[name].layers, partition=basis)
        write_bsdf(Path(file), light.bsdf)
    text = STUDY.replace('rule = "schedule"\nfile = "states.csv"', GLARE_FREE)
    text = text.replace("[[luminaire]]", '[[sensors]]\nfile = "eye.pts"\n[[luminaire]]')
    text = text.replace("[energy]\n", f'[energy]\nsolar = "{solar}"\n')
    Path("study.toml").write_text(text.replace("samples = 64", "samples = 256"))


def test_prediction_saves_energy_within_the_glare_limit(folder):
    """Heating, cooling and light by EnergyPlus itself, against both fixed states."""
    predictive_study("matrices")
    data = run()
    uses = ["heating", "cooling", "lighting"]
    found = float(data["annual_energy"].sel(energy_use=uses).sum())
    fixed = data["fixed_state_energy"].sel(energy_use=uses).sum("energy_use")
    assert found < 0.98 * float(fixed.min())
    occupied = data["occupied"].values
    eye = data["illuminance"].values[data["grid"].values == "eye"].max(axis=0)
    closed = data["state"].values[0] == 1
    glare = simplified_dgp(eye) > 0.35
    # Where the open shade has glare, the other state is chosen
    assert not (glare & occupied & ~closed).any()
    assert float(data["zone_model_error"].sel(zone_model_figure="energy").max()) < 0.06
    assert float(data["solar_balance"].max()) < 0.005
    assert float(data["zone_closure"].min()) == pytest.approx(1, abs=0.02)
    again = run()
    np.testing.assert_array_equal(again["energy"], data["energy"])
    assert main(["report", "results", "--quiet"]) == 0
    page = Path("results/report.html").read_text()
    for words in ("absorbed by layer 3", "kept by the room", "always in state 1"):
        assert words in page


def test_surfaces_absorb_the_given_radiation(folder, states):
    """What EnergyPlus reports is what the matrices give, surface by surface."""
    predictive_study("matrices")
    week = "RunPeriod,Year,12,1,,12,7"
    text = SMALL_OFFICE.text("clear", states).replace(YEAR, week)
    # Luminaires without light, which would be absorbed as solar radiation is
    Path("office.idf").write_text(text.replace(LIGHTS, "LightingLevel,0,,,0,0.4,0.2"))
    study = read_study("study.toml")
    inputs = read_inputs(study)
    job = Job(study, inputs, MatrixStore(Path("matrices")), silent)
    model = energy_model(study, inputs)
    hours = np.arange(8760)
    chosen = {"south": (hours // 5) % 2}
    solar = solar_radiation(job, model, chosen)
    given = {a.key: a.values for a in solar.actuators}
    surfaces = {"South": 9.0, "East": 15.0, "Floor": 20.0, "Ceiling": 20.0}
    name = "Surface Inside Face Solar Radiation Heat Gain Rate"
    outputs = [Output(name, surface) for surface in surfaces]
    absorbed = "Surface Window Total Glazing Layers Absorbed Shortwave Radiation Rate"
    values = run_building(
        model, chosen, {}, [*outputs, Output(absorbed, "South Window")], solar=solar
    )
    (window,) = solar.windows
    simulated = np.isfinite(values[0])
    # Hours with sun before and after: EnergyPlus gives nothing in the part of an hour
    # without sun
    incident = window.parts["incident"]
    lit = simulated & (incident > 20) & (np.roll(incident, 1) > 0)
    lit &= np.roll(incident, -1) > 0
    for row, (surface, area) in zip(values, surfaces.items(), strict=False):
        expected = area * given[f"Solar on {surface}"]
        assert expected[lit].mean() > 10
        np.testing.assert_allclose(row[lit], expected[lit], rtol=0.02, atol=2.0)
    layers = 3 * window.parts["absorbed"]
    np.testing.assert_allclose(values[-1][lit], layers[lit], rtol=0.01, atol=1.0)

    # Radiation into the zone is absorbed by surfaces and layers, or returned
    areas = {s: 20.0 if s in ("Floor", "Ceiling") else 15.0 for s in EVERY}
    areas |= {"North": 12.0, "South": 9.0}
    kept = sum(areas[s] * given[f"Solar on {s}"] for s in EVERY)
    inward = 3 * (window.parts["transmitted"] - window.parts["returned"])
    front = window.parts["incident"] - window.parts["reflected"]
    back = layers - 3 * (front - window.parts["transmitted"])
    np.testing.assert_allclose(kept + back, inward, rtol=5e-3, atol=0.1)


def test_a_killed_engine_is_one_line(folder, states, monkeypatch):
    model = read_building_model("office.idf").objects
    script = Path("killed.sh")
    script.write_text("#!/bin/sh\nkill -9 $$\n")
    script.chmod(0o755)
    monkeypatch.setattr("sys.executable", str(script.resolve()))
    job = AnnualRun(model, Path("weather.epw"), [], [], source="office.idf")
    with pytest.raises(InputError, match=r"office\.idf.*ended with status -9"):
        simulate(job)


def test_windows_outside_the_study_are_one_line(folder, capsys):
    predictive_study("matrices")
    text = Path("office.idf").read_text()
    second = "FenestrationSurface:Detailed,Door,Window,clear,South,,,,,4,\n"
    second += "  3.2,0,2.5,3.2,0,1,3.8,0,1,3.8,0,2.5;\n"
    Path("office.idf").write_text(text + second)
    assert main(["run", "study.toml", "--out", "results", "--quiet"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert 'zone "Office" has windows without [[energy.window]]: Door' in said
