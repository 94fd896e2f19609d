"""`clerestory recipe`: closed forms outdoors, and the package that reads results."""

import importlib.resources
import json
import os
import shutil
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from honeybee_models import GLASS, TINT, honeybee_model, office

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.image.picture_files import read_picture
from clerestory.metrics.honeybee import read_honeybee
from clerestory.sky.sky_conditions import sky_conditions
from clerestory.sky.weather_formats import read_weather

WEATHER = Path(str(importlib.resources.files("pvlib"))) / "data" / "723170TYA.CSV"
UP, SOUTH = [0, 0, 1], [0, -1, 0]


@pytest.fixture
def recipe(call, tmp_path):
    """Run a recipe; return the folder of its results."""

    def run(name, model, **inputs):
        (tmp_path / "model.hbjson").write_text(json.dumps(model))
        file = tmp_path / "inputs.json"
        file.write_text(json.dumps({"model": "model.hbjson", **inputs}))
        outcome = call("recipe", name, file, "--folder", tmp_path, "--workers", 2)
        assert outcome.status == 0, outcome.err
        return tmp_path / name.replace("-", "_")

    return run


def field(*directions):
    """Sensors in an open field; a small distant shade is the only surface."""
    sensors = [{"pos": [0, 0, 1], "dir": d} for d in directions]
    model = honeybee_model(sensor_grids=[{"identifier": "g", "sensors": sensors}])
    far = [[500, 500, 0], [500, 501, 0], [500, 501, 1]]
    shade = {"identifier": "far", "geometry": {"boundary": far}}
    return model | {"orphaned_shades": [shade]}


def test_sky_views_of_an_open_field(recipe):
    """On a wall: half of the uniform sky, (3/7)(1/2 + 4/(3π)) of the overcast sky."""
    for kind, wall in (("uniform", 50.0), ("cloudy", 39.6)):
        folder = recipe(
            "sky-view",
            field(UP, SOUTH),
            **{"cloudy-sky": kind, "radiance-parameters": "-ad 65536"},
        )
        found = np.loadtxt(folder / "results" / "sky_view" / "g.res")
        assert found == pytest.approx([100, wall], abs=0.5)
    scene = zipfile.ZipFile(folder / "visualization.vtkjs").read("index.json")
    names = [each["name"] for each in json.loads(scene)["scene"]]
    assert names[0] == "grid g"
    assert len(names) == 2  # and the shade


@pytest.mark.parametrize(
    ("sky", "up", "south"),
    [
        # Overcast: 39.6 % of the horizontal illuminance from the sky, 10 % from ground
        ("illuminance 10000", 10_000, 4960),
        # Uniform, black ground: half
        ("illuminance 10000 -u -g 0", 10_000, 5000),
        # The sun in the south at 60° in a black sky, with dark ground
        ("climate-based -alt 60 -az 180 -dni 100 -dhi 1 -g 0", None, None),
    ],
)
def test_illuminance_of_an_open_field_at_one_time(recipe, sky, up, south):
    inputs = {"sky": sky, "radiance-parameters": "-ab 2 -ad 65536"}
    folder = recipe("point-in-time-grid", field(UP, SOUTH), **inputs)
    found = np.loadtxt(folder / "results" / "pit" / "g.res")
    if up is None:
        # Sunlight on the plane and on the wall: sin 60° and cos 60°
        assert found[1] / found[0] == pytest.approx(1 / 3**0.5, rel=0.03)
    else:
        assert found == pytest.approx([up, south], rel=0.01)


def test_pictures_of_a_uniform_sky(recipe):
    """Upwards 100/π W/(m²·sr); the distant shade is not in view."""
    up = {"identifier": "up", "position": [0, 0, 1], "direction": UP}
    view = up | {"up_vector": [0, 1, 0], "view_type": "v", "h_size": 40, "v_size": 20}
    model = field(UP)
    other = view | {"identifier": "left out"}
    model["properties"]["radiance"]["views"] = [view, other]
    for metric, value in (("luminance", 100 / np.pi), ("illuminance", 0)):
        folder = recipe(
            "point-in-time-view",
            model,
            sky="irradiance 100 -u",
            metric=metric,
            resolution=8,
            view_filter="u*",
            radiance_parameters="-ab 1 -ad 64",
        )
        (path,) = (folder / "results").glob("*.HDR")
        picture = read_picture(path)
        assert (picture.columns, picture.rows) == (8, 4)
        assert picture.radiance == pytest.approx(value, rel=0.01)


def test_irradiance_at_one_time_is_that_of_the_text(recipe):
    inputs = {"sky": "irradiance 50 -u -g 0", "metric": "irradiance"}
    folder = recipe("point-in-time-grid", field(UP), **inputs)
    found = np.loadtxt(folder / "results" / "pit" / "g.res")
    assert found == pytest.approx(50, rel=0.03)


def test_daylight_factors_of_an_open_field(recipe):
    """On a wall: 39.6 % from the sky, and ground of reflectance 0.2: 10 % more."""
    folder = recipe(
        "daylight-factor", field(UP, SOUTH), radiance_parameters="-ab 2 -ad 65536"
    )
    found = np.loadtxt(folder / "results" / "g.res")
    assert found == pytest.approx([100, 49.6], abs=0.5)
    summary = (folder / "grid_summary.csv").read_text().splitlines()
    assert summary[0].startswith("Sensor Grid,Sensor Grid ID,DAYLIGHT-FACTOR-Mean")


def test_sun_hours_of_an_open_field(recipe):
    """Steps with gendaymtx's sun above the horizon, and those with it in the south."""
    folder = recipe("direct-sun-hours", field(UP, SOUTH), wea=str(WEATHER), north=90)
    found = np.loadtxt(folder / "results" / "cumulative" / "g.res")
    sun = sky_conditions(read_weather(WEATHER), sun_formula="radiance").sun
    up = sun.altitude > 0
    # North is at -x of the model, so that its -y axis points west
    west = up & (np.sin(sun.azimuth) < 0)
    assert found[0] == up.sum()
    assert abs(found[1] - west.sum()) <= 12  # the sun crosses the plane of the wall
    hourly = np.loadtxt(folder / "results" / "direct_sun_hours" / "g.ill")
    hours = np.loadtxt(folder / "results" / "direct_sun_hours" / "sun-up-hours.txt")
    assert hourly.shape == (2, len(hours))
    assert hourly.sum(axis=1).tolist() == found.tolist()


@pytest.mark.parametrize("kind", ["annual-irradiance", "cumulative-radiation"])
def test_radiation_on_a_horizontal_plane_is_that_of_the_weather(recipe, kind):
    """DNI sin(altitude) + DHI, summed over the year."""
    folder = recipe(
        kind, field(UP), wea=str(WEATHER), radiance_parameters="-ab 1 -ad 200000"
    )
    conditions = sky_conditions(read_weather(WEATHER), spectrum="solar")
    watts = conditions.direct_horizontal() + conditions.diffuse_horizontal
    place = "metrics" if kind == "annual-irradiance" else "results"
    total = np.loadtxt(folder / place / "cumulative_radiation" / "g.res")
    mean = np.loadtxt(folder / place / "average_irradiance" / "g.res")
    assert float(total) == pytest.approx(watts.sum() / 1000, rel=0.01)
    assert float(mean) == pytest.approx(watts.mean(), rel=0.01)
    if kind == "annual-irradiance":
        peak = np.loadtxt(folder / "metrics" / "peak_irradiance" / "g.res")
        assert float(peak) == pytest.approx(watts.max(), rel=0.02)
        hours = np.loadtxt(folder / "results" / "total" / "sun-up-hours.txt")
        hourly = np.loadtxt(folder / "results" / "total" / "g.ill")
        # Of 200,000 paths, those that meet the patch of the sun, weighted by the cosine
        steps = hours.astype(int)
        paths = 200_000 * 2 * np.sin(conditions.sun.altitude[steps]) / 2304
        error = conditions.direct_horizontal()[steps] / np.sqrt(np.maximum(paths, 1))
        assert np.all(
            np.abs(hourly - watts[steps]) < 4 * error + 0.02 * watts[steps] + 2
        )


def grid(identifier="desk", **more):
    places = [[2, 1, 0.8], [2, 3, 0.8]]
    return {
        "identifier": identifier,
        "sensors": [{"pos": p, "dir": UP} for p in places],
        **more,
    }


def test_grids_are_filtered_and_have_groups(recipe):
    grids = [grid("a1", group_identifier="east"), grid("a2"), grid("b1")]
    model = honeybee_model(office(), sensor_grids=grids)
    folder = recipe(
        "daylight-factor", model, grid_filter="a*", radiance_par="-ab 2 -ad 512"
    )
    info = json.loads((folder / "results" / "grids_info.json").read_text())
    assert [each["full_id"] for each in info] == ["east/a1", "a2"]
    assert np.loadtxt(folder / "results" / "east" / "a1.res").shape == (2,)
    assert not (folder / "results" / "b1.res").exists()


@pytest.fixture
def dynamic():
    """An office whose window is clear or tinted."""
    room = office()
    states = [{"modifier": "pane"}, {"modifier": "tint"}]
    radiance = {"dynamic_group_identifier": "south", "states": states}
    room["faces"][2]["apertures"][0]["properties"] = {"radiance": radiance}
    tint = TINT | {"r_transmissivity": 0.1, "b_transmissivity": 0.1}
    return honeybee_model(room, modifiers=[GLASS, tint], sensor_grids=[grid()])


@pytest.mark.slow
def test_states_of_dynamic_groups_are_light_paths(recipe, dynamic):
    """Light in each state is that of a static model with the glass of the state."""
    effort = {"wea": str(WEATHER), "radiance_parameters": "-ab 2 -ad 20000"}
    found = read_honeybee(recipe("annual-daylight", dynamic, **effort) / "results")
    ((path, states),) = found.states.items()
    assert states == ("0_pane", "1_tint")
    for number, glass in enumerate(("pane", "tint")):
        room = office()
        room["faces"][2]["apertures"][0]["properties"] = {
            "radiance": {"modifier": glass}
        }
        model = {**dynamic, "rooms": [room]}
        static = read_honeybee(recipe("annual-daylight", model, **effort) / "results")
        expected = static.illuminance("desk").mean("time")
        lux = found.illuminance("desk", states={path: number}).mean("time")
        assert lux.values == pytest.approx(expected.values, rel=0.05)


def glass_transmittance(transmissivity, sine):
    """Transmittance of a pane of n = 1.52 by the sine of the angle of incidence."""
    inside = np.sqrt(1 - (sine / 1.52) ** 2)
    outside = np.sqrt(1 - sine**2)
    passed = transmissivity ** (1 / inside)
    reflected = (
        ((outside - 1.52 * inside) / (outside + 1.52 * inside)) ** 2,
        ((1.52 * outside - inside) / (1.52 * outside + inside)) ** 2,
    )
    parts = [(1 - r) ** 2 * passed / (1 - (r * passed) ** 2) for r in reflected]
    return np.mean(parts, axis=0)


@pytest.fixture
def diffusing(tmp_path):
    """An office whose window is a diffuser of 60 % or one of 30 %, or clear."""
    modifiers = [GLASS]
    for name, share in (("light", 0.6), ("dense", 0.3)):
        write_bsdf(tmp_path / "bsdf.xml", lambertian(share, klems("quarter")))
        xml = (tmp_path / "bsdf.xml").read_text()
        modifiers.append({"type": "BSDF", "identifier": name, "bsdf_data": xml})
    room = office()
    states = [{"modifier": name} for name in ("light", "dense", "pane")]
    radiance = {"dynamic_group_identifier": "south", "states": states}
    room["faces"][2]["apertures"][0]["properties"] = {"radiance": radiance}
    return honeybee_model(room, modifiers=modifiers, sensor_grids=[grid()])


@pytest.mark.slow
def test_states_may_be_bsdfs(recipe, call, diffusing, tmp_path):
    """Three-phase groups: light of a diffuser is that of a study of it, in proportion.

    A diffuser of half the transmittance has half the light, sunlight and all.
    """
    effort = {"wea": str(WEATHER), "radiance_parameters": "-ab 3 -ad 5000"}
    found = read_honeybee(recipe("annual-daylight", diffusing, **effort) / "results")
    ((path, states),) = found.states.items()
    assert states == ("0_light", "1_dense", "2_pane")
    light, dense, clear = found.by_state("desk", path)
    direct = found.by_state("desk", path, light="direct")
    for one in (np.stack([light, dense]), direct):
        assert one[1].sum(axis=1) == pytest.approx(one[0].sum(axis=1) / 2, rel=1e-3)
    assert np.all(direct[0] <= light + 1e-3)
    # By clear glass more light is near the window, where the sun shines in
    assert clear[0].sum() > light[0].sum()

    room = office()
    alone = {"radiance": {"modifier": "light"}}
    room["faces"][2]["apertures"][0]["properties"] = alone
    (tmp_path / "static.hbjson").write_text(json.dumps({**diffusing, "rooms": [room]}))
    study, results = tmp_path / "study", tmp_path / "run"
    words = ["import", tmp_path / "static.hbjson", "-o", study, "--weather", WEATHER]
    assert call(*words).status == 0
    with (study / "study.toml").open("a") as stream:
        stream.write("\n[trace]\nsamples = 20000\nbounces = 3\n")
    outcome = call("run", study / "study.toml", "--out", results, "--quiet")
    assert outcome.status == 0, outcome.err
    with xr.open_dataset(results / "results.nc") as data:
        expected = data["illuminance"].values.mean(axis=1)
    assert light.mean(axis=1) == pytest.approx(expected, rel=0.03)


@pytest.mark.slow
def test_the_postprocessing_package_operates_our_states(recipe, dynamic, tmp_path):
    """By a schedule: the daylight autonomy is that of our arrays of the states."""
    program = shutil.which("honeybee-radiance-postprocess")
    if program is None:
        pytest.skip("honeybee-radiance-postprocess is not installed")
    effort = {"wea": str(WEATHER), "radiance_parameters": "-ab 2 -ad 1000"}
    folder = recipe("annual-daylight", dynamic, **effort)
    found = read_honeybee(folder / "results")
    (path,) = found.dynamic_paths("desk")
    hours = np.arange(8760)
    state = np.where(hours % 24 < 12, 0, np.where(hours % 7 == 0, -1, 1))
    group = {"identifier": path, "schedule": state.tolist()}
    (tmp_path / "states.json").write_text(json.dumps({path: group}))
    words = [program, "post-process", "annual-daylight", "results", "-sf", "theirs"]
    words += ["-st", str(tmp_path / "states.json")]
    subprocess.run(words, cwd=folder, check=True, timeout=300)
    lux = found.illuminance("desk", states={path: state}).values
    occupied = (hours % 24 >= 8) & (hours % 24 < 18)
    expected = 100 * (lux[:, occupied] >= 300).mean(axis=1)
    theirs = np.loadtxt(folder / "theirs" / "da" / "desk.da")
    assert theirs == pytest.approx(expected, abs=0.011)
    first = np.loadtxt(folder / "metrics" / "da" / "desk.da")
    assert np.all(theirs < first)


@pytest.mark.slow
def test_blinds_are_the_second_state_of_each_window(recipe, diffusing):
    """Blinds transmit 5 % diffusely, and 0.01 % of the direct sunlight straight on.

    Diffuse light is that of a window which is a diffuser of 60 %, in proportion.
    """
    model = honeybee_model(office(), sensor_grids=[grid()])
    effort = {"wea": str(WEATHER), "radiance_parameters": "-ab 2 -ad 5000"}
    folder = recipe("leed-daylight-option-one", model, **effort)
    found = read_honeybee(folder / "results")
    (path,) = found.paths["desk"]
    opened, closed = found.by_state("desk", path)
    annual = read_honeybee(recipe("annual-daylight", diffusing, **effort) / "results")
    ((group, _),) = annual.states.items()
    diffuser = annual.by_state("desk", group)[0]
    # Cosine-weighted mean of the transmittance of the pane, for white light
    sine = np.sqrt((np.arange(1000) + 0.5) / 1000)
    pane = sum(
        weight * glass_transmittance(GLASS[f"{name}_transmissivity"], sine).mean()
        for name, weight in {"r": 0.265, "g": 0.67, "b": 0.065}.items()
    )
    expected = pane * 0.05 / 0.6 * diffuser.sum(axis=1)
    assert closed.sum(axis=1) == pytest.approx(expected, rel=0.03)
    opened, closed = found.by_state("desk", path, light="direct")
    assert closed == pytest.approx(1e-4 * opened, rel=1e-3)
    summary = json.loads((folder / "leed_summary" / "summary.json").read_text())
    assert summary["total_sensor_count"] == 2


@pytest.mark.slow
def test_glare_of_an_eye_that_faces_the_window(recipe, tmp_path):
    """Facing the window there is glare, facing the wall there is none."""
    eyes = [{"pos": [2, 2, 1.2], "dir": d} for d in (SOUTH, [0, 1, 0])]
    grids = [{"identifier": "eyes", "sensors": eyes}]
    model = honeybee_model(office(), sensor_grids=grids)
    effort = {"wea": str(WEATHER), "radiance_parameters": "-ab 3 -ad 500"}
    folder = recipe("annual-glare", model, **effort)
    dgp = np.loadtxt(folder / "results" / "eyes.dgp")
    hours = np.loadtxt(folder / "results" / "sun-up-hours.txt")
    assert dgp.shape == (2, len(hours))
    facing, away = np.loadtxt(folder / "metrics" / "ga" / "eyes.ga")
    assert facing < 95 < away
    program = shutil.which("honeybee-radiance")
    if program is not None:
        schedule = tmp_path / "hours.csv"
        schedule.write_text("\n".join(str(int(8 <= h % 24 < 18)) for h in range(8760)))
        words = ["post-process", "annual-glare", "results", "-sf", "theirs"]
        words += ["-sch", str(schedule)]
        subprocess.run([program, *words], cwd=folder, check=True, timeout=300)
        theirs = folder / "results" / "theirs" / "ga" / "eyes.ga"
        assert np.loadtxt(theirs) == pytest.approx([facing, away], abs=0.01)


@pytest.mark.slow
def test_the_postprocessing_package_finds_the_same_metrics(recipe, tmp_path):
    program = shutil.which("honeybee-radiance-postprocess")
    if program is None:
        pytest.skip("honeybee-radiance-postprocess is not installed")
    model = honeybee_model(office(), sensor_grids=[grid()])
    folder = recipe(
        "annual-daylight",
        model,
        wea=str(WEATHER),
        radiance_parameters="-ab 2 -ad 500",
        thresholds="-t 500 -lt 200 -ut 2000",
    )
    options = ["-t", "500", "-lt", "200", "-ut", "2000", "-sf", "theirs"]
    words = [program, "post-process", "annual-daylight", "results", *options]
    subprocess.run(words, cwd=folder, check=True, env={**os.environ}, timeout=300)
    for metric in ("da", "cda", "udi", "udi_lower", "udi_upper"):
        suffix = metric.partition("_")[0]
        ours, theirs = (
            np.loadtxt(folder / name / metric / f"desk.{suffix}")
            for name in ("metrics", "theirs")
        )
        assert ours == pytest.approx(theirs, abs=0.011)


def test_faults_are_one_line(call, tmp_path):
    (tmp_path / "model.hbjson").write_text(json.dumps(honeybee_model(office())))
    file = tmp_path / "inputs.json"
    for name, inputs, message in (
        ("spam", {}, "recipe is 'spam'; one of annual-daylight"),
        ("sky-view", {}, 'input "model" is missing'),
        (
            "point-in-time-view",
            {"model": "model.hbjson", "sky": "cie -alt 45 -az 180"},
            "no view matches '*'; one of none expected",
        ),
        (
            "sky-view",
            {"model": "model.hbjson", "grid-filter": "x*"},
            "no sensor grid matches 'x*'; one of office expected",
        ),
        (
            "annual-daylight",
            {"model": "model.hbjson", "wea": str(WEATHER), "timestep": 2},
            'input "timestep" is 2, but a step of the weather file is 60 min; 1',
        ),
    ):
        file.write_text(json.dumps(inputs))
        outcome = call("recipe", name, file, "--folder", tmp_path / "out")
        assert outcome.status == 2
        assert message in outcome.err
        assert len(outcome.err.strip().splitlines()) == 1
        assert not (tmp_path / "out").exists()
