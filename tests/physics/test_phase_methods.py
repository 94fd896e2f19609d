"""Two phases with the exact sun, and four and six phases in studies."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from physics_scenes import box

import clerestory as cl
from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.metrics.spatial_metrics import sunlight_exposure
from clerestory.phases.direct_light import blackened
from clerestory.phases.illuminance import illuminance
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    WindowMatrices,
    window_chain,
)
from clerestory.phases.methods import METHODS, five_phase, three_phase
from clerestory.phases.separate_coefficients import separate_coefficients
from clerestory.phases.sun_coefficients import sun_coefficients
from clerestory.phases.unscattered_light import unscattered_sun
from clerestory.scene.model import DistantSource, Glass, Light, Scene
from clerestory.scene.sensors import Sensors
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import sun_matrix
from clerestory.study.config import read_study
from clerestory.study.model_import import sheet_bsdf
from clerestory.study.new_study import write_demo
from clerestory.study.study_run import run_study

ROOM = Path(__file__).parents[1] / "cli" / "room"
SUN_SR = 2 * np.pi * (1 - np.cos(np.radians(0.533 / 2)))
NOON = "2023-03-21T12:30"


def sunshine(*moments, diffuse=50.0):
    """Sun of 800 W/m² in Oakland."""
    times = np.array(moments, dtype="datetime64[m]")
    return cl.Weather(
        place="Oakland", latitude_deg=37.73, longitude_deg=-122.22, elevation=0.0,
        utc_offset_hours=-8.0, times=times, step_minutes=60.0,
        direct_normal=np.full(len(times), 800.0),
        diffuse_horizontal=np.full(len(times), diffuse), source="a test",
    )  # fmt: skip


def on_floor(*depths):
    """Sensors on the floor of a room 4 m wide, at distances from the south side."""
    points = np.array([[2.0, depth, 0.01] for depth in depths])
    return Sensors(points, np.tile([0, 0, 1.0], (len(points), 1)))


def exact(scene, sensors, weather, *, samples, device):
    """Two phases with the sun at its place."""
    suns = sun_matrix(weather)
    shared = {"sensors": sensors, "device": device}
    C, direct = separate_coefficients(scene, samples=samples, seed=1, **shared)
    sun = unscattered_sun(scene, suns=suns.directions, samples=1024, seed=3, **shared)
    window = WindowMatrices(*(MatrixChain((matrix,)) for matrix in (C, direct, sun)))
    skies = Skies(sky_matrix(weather), sky_matrix(weather, include="sun"), suns)
    terms = METHODS["2-phase"].terms(corrected=True)
    return illuminance([window], terms, skies), C, suns


def test_the_sun_patch_of_an_open_window_is_sharp(device):
    """Sensors in the sun of a black room have E cos θ and the sky, others the sky.

    The edge of the ceiling, at 3 m, casts its shadow at y = 3 cot(altitude of the sun's
    profile), here between the second and the third sensor.
    """
    scene, _ = box(4, 5, 3, 0.0)
    weather, sensors = sunshine(NOON), on_floor(0.5, 1.5, 3.6, 4.5)
    found, C, suns = exact(scene, sensors, weather, samples=1 << 18, device=device)
    sun = suns.directions[0]
    edge = 3 * -sun[1] / sun[2]
    sunny = sensors.position[:, 1] < edge
    assert sunny.tolist() == [True, True, False, False]
    terms = METHODS["2-phase"].terms(corrected=False)
    skies = Skies(sky_matrix(weather, include="sky"))
    sky = illuminance([WindowMatrices(MatrixChain((C,)))], terms, skies)
    beam = suns.direct_normal.max() * 179 * sun[2]
    expected = sky["illuminance"].values[:, 0] + beam * sunny
    error = found["standard_error"].values[:, 0]
    assert np.all(error < 0.02 * beam)
    assert np.all(abs(found["illuminance"].values[:, 0] - expected) < 4 * error + 1)
    direct = found["direct_sun"].values[:, 0]
    np.testing.assert_allclose(direct, beam * sunny, rtol=2e-3, atol=1e-3)


@pytest.mark.parametrize("reflectance", [0.0, 0.5], ids=["black", "grey"])
def test_two_phases_equal_path_tracing_behind_glass(device, reflectance):
    """The sun through a pane, at the instant.

    What is reflected keeps the spread sun, whose patches are 8° apart: within 4 %.
    """
    scene, south = box(4, 5, 3, reflectance)
    panes = tuple(replace(polygon, material="pane") for polygon in south.polygons)
    room = scene + Scene({"pane": Glass("pane", np.full(3, 0.96))}, panes)
    weather, sensors = sunshine(NOON, diffuse=1e-3), on_floor(0.7, 1.6, 3.9)
    found, _, suns = exact(room, sensors, weather, samples=1 << 18, device=device)
    source = DistantSource(suns.directions[0], 0.533, "sun", "sun")
    sun = Scene({"sun": Light("sun", np.full(3, 1 / SUN_SR))}, (), (source,))
    traced = cl.irradiance(room + sun, sensors, samples=1 << 16, seed=6, device=device)
    normal = suns.direct_normal.max()
    expected = traced.illuminance() * normal
    noise = np.hypot(
        found["standard_error"].values[:, 0], traced.error[:, 1] * 179 * normal
    )
    off = abs(found["illuminance"].values[:, 0] - expected)
    assert np.all(noise < 0.05 * expected.max())
    assert np.all(off < 4 * noise + 0.04 * reflectance * expected + 1)


PORTS = """#@rfluxmtx h=kq u=Z
void polygon front
0
0
12 4 -0.5 0.5  0 -0.5 0.5  0 -0.5 3  4 -0.5 3
"""
AWNING = """void plastic cloth 0 0 5 0.4 0.4 0.4 0 0
cloth polygon awning
0
0
12 1 -0.05 2.5  1 -0.4 2.3  3 -0.4 2.3  3 -0.05 2.5
"""
STATES = """ports = "ports.rad"
[[window.state]]
name = "in"
bsdf = "pane.xml"
[[window.state]]
name = "out"
bsdf = "pane.xml"
shade = ["awning.rad"]
[window.control]
rule = "schedule"
file = "states.csv"
"""


@pytest.fixture
def facade_study(tmp_path):
    """The room of ten polygons with an awning that is out every second hour."""
    folder = tmp_path / "study"
    shutil.copytree(ROOM, folder)
    write_bsdf(folder / "pane.xml", lambertian(0.5, klems("quarter")))
    (folder / "ports.rad").write_text(PORTS)
    (folder / "awning.rad").write_text(AWNING)
    weather = cl.read_weather(folder / "two_days.wea")
    lines = [
        f"{str(time.astype('datetime64[m]')).replace('T', ' ')},{number % 2}"
        for number, time in enumerate(weather.times)
    ]
    (folder / "states.csv").write_text("time,south\n" + "\n".join(lines) + "\n")
    text = (folder / "study.toml").read_text()
    text = text.replace('bsdf = "diffuser.xml"\n', STATES)
    text = text.replace("samples = 256", "samples = 4096")

    def written(method):
        made = text.replace('method = "3-phase"', f'method = "{method}"')
        (folder / "study.toml").write_text(made)
        return folder / "study.toml"

    return written


def python_route(folder, *, direct, device):
    """V, T and F D of both states, from functions of the package."""
    room = cl.read_rad(folder / "room.rad")
    awning = cl.read_rad(folder / "awning.rad")
    window, ports = (
        cl.read_window(folder / "window.rad"),
        cl.read_windows(folder / "ports.rad"),
    )
    sensors = sensors_of(folder)
    scene, shade = (blackened(room), blackened(awning)) if direct else (room, awning)
    inside = {"bounces": 1} if direct else {}
    outside = {"bounces": 0} if direct else {}
    shared = {"samples": 4096, "device": device}
    V = cl.view_matrix(scene, window, sensors=sensors, seed=101, **shared, **inside)
    D = cl.daylight_matrices(scene, ports, subdivision=1, seed=102, **shared, **outside)
    states = [
        cl.facade_daylight(
            cl.facade_matrices(each, window, ports, seed=seed, **shared, **outside), D
        )
        for seed, each in ((103, scene), (104, scene + shade))
    ]
    T = cl.read_bsdf(folder / "pane.xml").transmission_matrix()
    return window_chain(V, [T, T], states)


def sensors_of(folder):
    """Sensors of both grids."""
    grids = [cl.read_sensors(folder / f"{name}.pts") for name in ("desk", "eye")]
    return Sensors(
        np.concatenate([grid.position for grid in grids]),
        np.concatenate([grid.direction for grid in grids]),
    )


def agree(data, expected):
    """Both are one light, within four standard errors, and these are small."""
    lit = expected["illuminance"].values > 1
    ours, theirs = (each["illuminance"].values[lit] for each in (data, expected))
    noise = np.hypot(*(each["standard_error"].values[lit] for each in (data, expected)))
    assert np.median(noise / theirs) < 0.05
    assert np.all(abs(ours - theirs) < 4 * noise + 1e-3 * theirs)


def test_a_study_of_four_phases_is_the_python_route(facade_study, tmp_path):
    file = facade_study("4-phase")
    data = run_study(read_study(file), out=tmp_path / "out").data
    weather = cl.read_weather(file.with_name("two_days.wea"))
    states = [np.arange(len(weather)) % 2]
    assert data["state"].values.tolist() == [states[0].tolist()]
    whole = python_route(file.parent, direct=False, device="cpu")
    sky = sky_matrix(weather, subdivision=1)
    expected = three_phase([WindowMatrices(whole)], sky, states)
    agree(data, expected)
    shaded = expected["illuminance"].values[:, 12:14].mean(axis=0)
    assert np.all(shaded > 0)


@pytest.mark.slow
def test_a_study_of_six_phases_is_the_python_route(facade_study, tmp_path):
    file = facade_study("6-phase")
    data = run_study(read_study(file), out=tmp_path / "out").data
    folder, weather = file.parent, cl.read_weather(file.with_name("two_days.wea"))
    window = cl.read_window(folder / "window.rad")
    scene = cl.read_rad(folder / "room.rad")
    suns = sun_matrix(weather, tolerance_deg=0.25)
    C = [
        sun_coefficients(
            each, [window], window.name, cl.read_bsdf(folder / "pane.xml"),
            sensors=sensors_of(folder), suns=suns.directions, samples=1024, seed=5,
        )
        for each in (scene, scene + cl.read_rad(folder / "awning.rad"))
    ]  # fmt: skip
    parts = WindowMatrices(
        python_route(folder, direct=False, device="cpu"),
        python_route(folder, direct=True, device="cpu"),
        MatrixChain(tuple(C)),
    )
    skies = (
        sky_matrix(weather, subdivision=1),
        sky_matrix(weather, subdivision=1, include="sun"),
        suns,
    )
    states = [np.arange(len(weather)) % 2]
    agree(data, five_phase([parts], *skies, states))
    assert {"four_phase", "direct_in_patches", "direct_sun"} <= set(data)


GLASS = """void glass pane
0
0
3 0.96 0.96 0.96
"""
ASE = """title = "Glass room"
method = "{method}"
[scene]
files = [{files}]
{window}
[[sensors]]
file = "floor.pts"
[weather]
file = "723170TYA.CSV"
every = 7
[sky]
subdivision = 1
[trace]
samples = 256
"""


def test_hours_of_sun_in_a_glass_room_are_those_of_five_phases(tmp_path):
    """Glass as geometry, and as the BSDF of a window: hours above 1000 lux.

    A Klems patch has one transmittance, so hours near the limit differ.
    """
    write_demo(tmp_path)
    for name in ("room.rad", "window.rad"):
        text = (ROOM / name).read_text().replace("h=kq", "h=kf")
        (tmp_path / name).write_text(text)
    window = (ROOM / "window.rad").read_text().replace("void polygon", "pane polygon")
    (tmp_path / "glass.rad").write_text(GLASS + window)
    pane = sheet_bsdf(Glass("pane", np.full(3, 0.96)))
    write_bsdf(tmp_path / "pane.xml", pane)
    (tmp_path / "floor.pts").write_text(
        "".join(f"{x} {y} 0.75 0 0 1\n" for x in (1.2, 2, 2.8) for y in (0.5, 1.2, 2.5))
    )
    table = '[[window]]\nfile = "window.rad"\nbsdf = "pane.xml"\npeak = true'
    hours = {}
    for method, files, more in (
        ("2-phase", '"room.rad", "glass.rad"', ""),
        ("5-phase", '"room.rad"', table),
    ):
        file = tmp_path / f"{method}.toml"
        file.write_text(ASE.format(method=method, files=files, window=more))
        data = run_study(read_study(file), out=tmp_path / method).data
        hours[method] = data["sun_hours"].values
    assert hours["5-phase"].max() > 50
    np.testing.assert_allclose(hours["2-phase"], hours["5-phase"], rtol=0.08, atol=3)


BLINDS = """[[window]]
file = "window.rad"
[[window.state]]
name = "glass"
bsdf = "pane.xml"
peak = true
[[window.state]]
name = "blind"
bsdf = "blind.xml"
[window.control]
rule = "LM-83"
"""


def test_blinds_of_lm83_and_hours_of_sun_by_two_phases(tmp_path):
    """The blind closes when the sun behind open glass reaches any of three sensors."""
    folder = tmp_path / "study"
    shutil.copytree(ROOM, folder)
    write_bsdf(folder / "pane.xml", sheet_bsdf(Glass("pane", np.full(3, 0.96))))
    write_bsdf(folder / "blind.xml", lambertian(0.05, klems("full")))
    window = (folder / "window.rad").read_text()
    (folder / "window.rad").write_text(window.replace("h=kq", "h=kf"))
    room = (folder / "room.rad").read_text()
    (folder / "room.rad").write_text(room.split("grey polygon overhang")[0])
    depths = (0.6, 1.0, 3.0)
    (folder / "floor.pts").write_text("".join(f"2 {y} 0.1 0 0 1\n" for y in depths))
    text = ASE.format(method="2-phase", files='"room.rad"', window=BLINDS)
    text = text.replace("723170TYA.CSV", "two_days.wea").replace("every = 7", "")
    (folder / "study.toml").write_text(text)
    data = run_study(read_study(folder / "study.toml"), out=tmp_path / "out").data
    sunny = data["direct_open"].values > 1000
    assert sunny.any(axis=0).tolist() == data["state"].values[0].astype(bool).tolist()
    assert data["rule_kept"].values.all()
    occupied = data["occupied"].values
    hours = sunny[:, occupied].sum(axis=1)
    np.testing.assert_array_equal(data["sun_hours"], hours)
    assert hours.max() > 0
    assert hours[-1] == 0
    found = sunlight_exposure(data["direct_open"], occupied, most_hours=1)
    assert found.value == np.mean(hours > 1) > 0
