"""The commands, on a room of ten polygons."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.matrix.netcdf import read_netcdf
from clerestory.matrix.radiance_format import read_matrix
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.weather_formats import read_weather

VIEW = "trace view --scene room.rad --window window.rad --sensors desk.pts --samples 64"
DAYLIGHT = (
    "trace daylight --scene room.rad --window window.rad"
    " --sky-subdivision 1 --samples 64"
)
COEFFICIENTS = (
    "trace coefficients --scene room.rad --sensors desk.pts"
    " --sky-subdivision 1 --samples 64"
)
PROGRAM = [sys.executable, "-c", "from clerestory.cli.main import main; exit(main())"]


def test_a_study_is_run_and_reported(call, room):
    outcome = call("run", "study.toml")
    assert outcome.status == 0, outcome.err
    assert outcome.err == ""
    assert "Test room" in outcome.out
    assert "report.html" in outcome.out
    folder = room / "study_results"
    names = {path.name for path in folder.iterdir()}
    assert names == {
        *("results.nc", "run.json", "metrics.csv", "report.html", "matrices"),
        *("illuminance_desk.csv", "illuminance_eye.csv", "desk.ill", "eye.ill"),
    }
    assert "Test room" in (folder / "report.html").read_text()


def test_running_again_gives_the_same_bits_and_traces_nothing(call, room):
    for out in ("one", "one", "two"):
        assert call("run", "study.toml", "--out", out, "--quiet").status == 0
        content = Path(out, "results.nc").read_bytes()
        assert content == Path("one", "results.nc").read_bytes()
    found = json.loads(Path("one/run.json").read_text())["matrices"]
    assert all(matrix["found"] for matrix in found.values())
    found = json.loads(Path("two/run.json").read_text())["matrices"]
    assert not any(matrix["found"] for matrix in found.values())


def test_a_report_is_written_anew_from_results(call, room):
    call("run", "study.toml", "--quiet")
    page = room / "study_results" / "report.html"
    page.unlink()
    assert call("report", "study_results").status == 0
    assert page.is_file()
    assert call("report", "study_results", "-o", "again.html").status == 0
    assert Path("again.html").read_text() == page.read_text()


def test_quiet_commands_say_nothing(call):
    for command in (f"{VIEW} -o V.mtx", "run study.toml", f"{DAYLIGHT} -o D.mtx"):
        outcome = call(*command.split(), "--quiet")
        assert (outcome.status, outcome.out, outcome.err) == (0, "", "")


def test_another_seed_gives_another_result(call):
    call("run", "study.toml", "-q", "--out", "a")
    call("run", "study.toml", "-q", "--out", "b", "--seed", "8")
    assert Path("a/results.nc").read_bytes() != Path("b/results.nc").read_bytes()


def test_traced_matrices_have_the_shape_their_names_promise(call):
    for command, shape in (
        (f"{VIEW} -o A.mtx", (3, 3, 41)),
        (f"{DAYLIGHT} -o A.mtx", (3, 41, 146)),
        (f"{COEFFICIENTS} -o A.mtx", (3, 3, 146)),
    ):
        outcome = call(*command.split())
        assert outcome.status == 0, outcome.err
        assert "standard error of the row sums" in outcome.out
        assert read_matrix("A.mtx").values.shape == shape


def test_formats_hold_the_same_numbers(call):
    for name, kind in (("a", "ascii"), ("f", "float"), ("d", "double")):
        call(*f"{VIEW} -o {name}.mtx --format {kind}".split())
    call(*f"{VIEW} -o n.nc".split())
    exact = read_netcdf("n.nc")
    assert exact.standard_error.max() > 0
    for name, error in (("a", 1e-14), ("f", 1e-7), ("d", 0)):
        values = read_matrix(f"{name}.mtx").values
        colour = np.broadcast_to(exact.values, (3, 3, 41))
        np.testing.assert_allclose(values, colour, rtol=error)


def test_several_scene_files_follow_one_option(call):
    Path("more.rad").write_text("void plastic red 0 0 5 .5 .1 .1 0 0\n")
    command = VIEW.replace("room.rad", "room.rad more.rad")
    assert call(*f"{command} -o V.mtx".split()).status == 0


def test_windows_of_several_groups_write_a_file_each(call):
    pane = Path("window.rad").read_text()
    text = pane.replace("void polygon", "left polygon")
    text += pane.replace("void polygon", "right polygon")
    Path("window.rad").write_text(text)
    assert call(*f"{VIEW} -o V.mtx".split()).status == 0
    assert {path.name for path in Path().glob("V*")} == {"V-left.mtx", "V-right.mtx"}


def test_four_factors_multiply_as_in_python(call):
    call(*f"{VIEW} -o V.mtx --format double".split())
    call(*f"{DAYLIGHT} -o D.mtx --format double".split())
    sky = "sky matrix two_days.wea --subdivision 1 -o S.smx --format double"
    call(*sky.split())
    command = "multiply V.mtx diffuser.xml D.mtx S.smx -o E.mtx --format double"
    assert call(*command.split()).status == 0
    V, D = read_matrix("V.mtx").values, read_matrix("D.mtx").values
    T = read_bsdf("diffuser.xml").transmission_matrix().values
    S = sky_matrix(read_weather("two_days.wea"), subdivision=1).values
    expected = V @ T @ D @ S.astype(float)
    assert expected.max() > 0
    np.testing.assert_allclose(read_matrix("E.mtx").values, expected, rtol=1e-5)


def test_two_factors_multiply_in_netcdf_with_their_errors(call):
    call(*f"{COEFFICIENTS} -o C.nc".split())
    call(*["sky", "matrix", "two_days.wea", "--subdivision", "1", "-o", "S.nc"])
    assert call(*["multiply", "C.nc", "S.nc", "-o", "E.nc"]).status == 0
    product = read_netcdf("E.nc")
    assert product.columns.kind == "time"
    assert product.standard_error.max() > 0


def test_parts_of_the_sky_sum_to_the_whole(call):
    for name, option in (("all", ""), ("sky", "--no-direct"), ("sun", "--sun-only")):
        command = f"sky matrix two_days.wea --subdivision 1 -o {name}.smx {option}"
        assert call(*command.split()).status == 0
    parts = read_matrix("sky.smx").values + read_matrix("sun.smx").values
    np.testing.assert_allclose(parts, read_matrix("all.smx").values, rtol=1e-6)


def test_sun_positions_are_tabled(call):
    assert call(*["sky", "sun", "two_days.wea", "-o", "suns.csv"]).status == 0
    rows = [line.split(",") for line in Path("suns.csv").read_text().splitlines()]
    assert len(rows) == 49
    noon = rows[1 + 24 + 11]
    assert noon[0] == "2023-06-21 11:30"
    # Spherical triangle of pole, zenith and sun, half an hour before noon less the
    # equation of time of -1.8 min; refraction adds 0.01°
    latitude, declination, angle = np.radians([51.5, 23.43, 7.5 + 1.8 / 4])
    sine = np.sin(latitude) * np.sin(declination)
    sine += np.cos(latitude) * np.cos(declination) * np.cos(angle)
    assert abs(float(noon[1]) - np.degrees(np.arcsin(sine))) < 0.05
    assert 150 < float(noon[2]) < 180


def test_weather_and_bsdf_are_described(call):
    outcome = call("sky", "describe", "two_days.wea")
    assert "51.500° north" in outcome.out
    assert "48 of 60 min" in outcome.out
    outcome = call("bsdf", "info", "diffuser.xml")
    assert "41 x 41" in outcome.out
    assert "0.500 from the normal, 0.500 diffuse" in outcome.out


def test_doubts_are_one_line_each_and_do_not_stop(call):
    Path("eye.pts").write_text("2 2.5 -5 0 -1 0\n")
    outcome = call("run", "study.toml", "--quiet")
    assert outcome.status == 0
    lines = outcome.err.splitlines()
    assert lines
    assert all(line.startswith("warning: ") for line in lines)
    assert any("eye.1" in line for line in lines)


@pytest.mark.slow
@pytest.mark.parametrize(
    "stop", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
)
@pytest.mark.parametrize("wait", [3.0, 5.0])
def test_a_stopped_run_goes_on_to_the_same_bits(room, stop, wait):
    text = Path("study.toml").read_text()
    Path("study.toml").write_text(text.replace("samples = 256", "samples = 20000"))
    words = ["run", "study.toml", "--quiet", "--out"]
    environment = {**os.environ, "PYTHONWARNINGS": "ignore"}
    child = subprocess.Popen(
        [*PROGRAM, *words, "stopped"], env=environment, stderr=subprocess.PIPE
    )
    time.sleep(wait)
    child.send_signal(stop)
    _, said = child.communicate()
    if child.returncode == 128 + stop:
        assert said == b"interrupted; run again to resume\n"
    for out in ("stopped", "whole"):
        subprocess.run([*PROGRAM, *words, out], env=environment, check=True)
    one, other = (Path(out, "results.nc").read_bytes() for out in ("stopped", "whole"))
    assert one == other
