"""Headless Chromium, and reports for it to open."""

import importlib.util
import shutil
import subprocess
from pathlib import Path

import pytest

from clerestory.report.page import write_report

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
_FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
    "--virtual-time-budget=10000",
)


@pytest.fixture(scope="session")
def browse(tmp_path_factory):
    """Run Chromium once with some options on a page; return what it printed."""
    found = [path for path in map(shutil.which, _NAMES) if path]
    if not found:
        pytest.skip("no Chromium here: install Debian's package `chromium`")
    profile = tmp_path_factory.mktemp("chromium")

    def run(page, *options):
        command = [found[0], *_FLAGS, f"--user-data-dir={profile}", *options]
        done = subprocess.run(
            [*command, page if str(page).startswith("http") else Path(page).as_uri()],
            capture_output=True,
            text=True,
            timeout=90,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="session")
def room():
    """Module that makes results in closed form, shared with the unit tests."""
    file = Path(__file__).parents[1] / "unit" / "report" / "analytic_room.py"
    spec = importlib.util.spec_from_file_location("analytic_room", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def report(room, tmp_path_factory):
    """Report of a year in the analytic room."""
    page = tmp_path_factory.mktemp("report") / "report.html"
    write_report(room.analytic_results(), page)
    return page


@pytest.fixture(scope="session")
def full_report(room, tmp_path_factory):
    """Report with states, glare of two views, a film and the equation's terms."""
    file = Path(__file__).parents[1] / "unit" / "report" / "course.py"
    spec = importlib.util.spec_from_file_location("course", file)
    course = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(course)
    folder = tmp_path_factory.mktemp("full")
    moments = [f"01-03T{hour:02d}:30" for hour in range(7, 18)]
    course.write_pictures(folder, moments)
    results = course.with_course(
        room.analytic_results(times=room.year(days=30)), pictures=moments
    )
    page = folder / "report.html"
    write_report(results, page, pictures=folder)
    return page
