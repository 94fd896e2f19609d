"""`clerestory view`: the page of a run as a file, and served by another process."""

import http.client
import json
import os
import signal
import subprocess
import sys
import zipfile
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest
import xarray as xr

from clerestory.study.results import Results, save_results


@pytest.fixture
def results(tmp_path):
    """Folder with the results of three sensors on one day."""
    times = np.datetime64("2023-06-21T00:30", "s") + np.arange(24) * np.timedelta64(
        3600, "s"
    )
    lux = np.outer([100.0, 200, 400], np.sin(np.arange(24) / 23 * np.pi))
    axes = ("sensor", "time")
    data = xr.Dataset(
        {
            "illuminance": (axes, lux.astype(np.float32)),
            "standard_error": (axes, (0.01 * lux).astype(np.float32)),
            "occupied": ("time", np.ones(24, bool)),
        },
        coords={
            "sensor": ["desk.1", "desk.2", "desk.3"],
            "grid": ("sensor", ["desk"] * 3),
            "time": times,
            "position": (("sensor", "xyz"), np.eye(3)),
            "direction": (("sensor", "xyz"), np.tile([0.0, 0, 1], (3, 1))),
        },
        attrs={"title": "Three desks"},
    )
    (tmp_path / "results").mkdir()
    save_results(Results(data), tmp_path / "results")
    return tmp_path / "results"


def test_the_page_is_written_to_a_file(call, results, tmp_path):
    outcome = call("view", results, "-o", tmp_path / "explore.html")
    assert (outcome.status, outcome.err) == (0, "")
    page = (tmp_path / "explore.html").read_text(encoding="utf-8")
    assert "Three desks · interactive results" in page
    assert 'id="part-operated"' in page


def test_results_are_a_scene_for_viewers_of_vtk(call, results, tmp_path):
    outcome = call("view", results, "-o", tmp_path / "desk.vtkjs")
    assert (outcome.status, outcome.err) == (0, "")
    archive = zipfile.ZipFile(tmp_path / "desk.vtkjs")
    scene = json.loads(archive.read("index.json"))
    [grid] = scene["scene"]
    assert grid["name"] == "grid desk"
    assert grid["mapper"]["colorByArrayName"] == "Daylight autonomy [%]"
    assert "Mean illuminance [lux]" in scene["lookupTables"]


def test_a_file_of_another_type_is_an_error(call, results, tmp_path):
    outcome = call("view", results, "-o", tmp_path / "desk.vtk")
    assert outcome.status == 2
    assert ".vtkjs expected" in outcome.err
    assert not (tmp_path / "desk.vtk").exists()


def test_a_folder_without_results_is_an_error(call, tmp_path):
    outcome = call("view", tmp_path)
    assert outcome.status == 2
    assert "results.nc" in outcome.err


def test_the_page_is_served_until_the_process_is_interrupted(results):
    program = "from clerestory.cli.main import main; exit(main())"
    words = [sys.executable, "-u", "-c", program, "view", str(results)]
    paths = [str(Path(__file__).parents[2] / "src"), os.environ.get("PYTHONPATH", "")]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(paths)}
    with subprocess.Popen(
        words, env=environment, stdout=subprocess.PIPE, text=True
    ) as process:
        address = urlsplit(process.stdout.readline().split()[-1])
        assert address.hostname == "127.0.0.1"
        status, page = _get(address, address.path)
        assert status == 200
        assert b"Three desks" in page
        assert _get(address, f"{address.path}part/operated")[0] == 200
        assert _get(address, "/guess/")[0] == 403
        assert _get(address, f"{address.path}../results.nc")[0] == 404
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=20) == 0


def _get(address, path):
    connection = http.client.HTTPConnection(address.hostname, address.port, timeout=20)
    connection.request("GET", path)
    answer = connection.getresponse()
    found = answer.status, answer.read()
    connection.close()
    return found
