"""The package as a whole: its import is fast and light, its names are there."""

import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import clerestory
from clerestory.image.picture import Picture
from clerestory.image.picture_files import write_picture
from clerestory.scene.view import View

REPOSITORY = Path(__file__).parents[1]

# What takes long to import, and what needs a device
HEAVY = ("mitsuba", "drjit", "scipy", "xarray", "pandas", "pvlib", "matplotlib")
TRACERS = ("mitsuba", "drjit")

# Seconds from the start of the import to its end, in a process of its own
STOPWATCH = """
import time
start = time.perf_counter()
import clerestory
print(time.perf_counter() - start)
"""


def run_python(code):
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    return done.stdout


def loaded_after(code):
    """Top-level packages in memory after some code."""
    code += "\nimport sys; print('loaded:', *{n.split('.')[0] for n in sys.modules})"
    return set(run_python(code).rpartition("loaded:")[2].split())


def test_import_takes_less_than_three_tenths_of_a_second():
    assert min(float(run_python(STOPWATCH)) for _ in range(3)) < 0.3


def test_import_loads_no_heavy_package():
    assert not loaded_after("import clerestory") & set(HEAVY)


def test_public_names_load_no_tracer():
    """Functions that trace load it when they are called."""
    look_up = "for name in clerestory.__all__: getattr(clerestory, name)"
    code = f"import clerestory\n{look_up}"
    assert not loaded_after(code) & set(TRACERS)


@pytest.mark.parametrize("arguments", [["--help"], ["trace", "view", "--help"]])
def test_help_needs_no_tracer(arguments):
    code = f"from clerestory.cli.main import main\nmain({arguments!r})"
    assert not loaded_after(code) & set(TRACERS)


def test_a_sky_matrix_loads_no_package_that_it_does_not_need(tmp_path):
    """They took three times as long to load as the year's matrix to make."""
    wea = tmp_path / "day.wea"
    lines = ["place here", "latitude 50", "longitude -8.5", "time_zone -15"]
    lines += ["site_elevation 110", "weather_data_file_units 1", "3 21 11.5 300 120"]
    wea.write_text("\n".join(lines) + "\n")
    words = ["sky", "matrix", str(wea), "-q", "-o", str(tmp_path / "S.smx")]
    code = f"from clerestory.cli.main import main\nassert main({words!r}) == 0"
    needless = {"pandas", "pvlib", "xarray", "h5py", "matplotlib", "rich"}
    assert not loaded_after(code) & needless


def test_the_glare_of_a_picture_loads_no_package_that_it_does_not_need(tmp_path):
    """Loading all commands took longer than evalglare takes."""
    eye = View(kind="angular", horizontal=180, vertical=180)
    path = tmp_path / "even.hdr"
    write_picture(Picture(np.ones((160, 160, 3), np.float32), view=eye), path)
    code = "from clerestory.cli.main import main\n"
    code += f"assert main(['glare', {str(path)!r}, '--trust', '-q']) == 0"
    needless = {"pandas", "pvlib", "xarray", "h5py", "matplotlib", "rich", "lxml"}
    assert not loaded_after(code) & (needless | set(TRACERS))


@pytest.mark.parametrize("name", clerestory.__all__)
def test_public_name_is_there(name):
    assert getattr(clerestory, name) is not None


def test_public_names_are_listed():
    assert set(dir(clerestory)) == set(clerestory.__all__)


def test_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'sky_matrx'"):
        clerestory.sky_matrx  # noqa: B018 - the look-up is the test


def test_version_is_that_of_the_project():
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())["project"]
    assert clerestory.__version__ == project["version"]


def test_the_types_are_offered_to_users():
    assert (Path(clerestory.__file__).parent / "py.typed").is_file()
