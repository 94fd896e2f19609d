"""Size of the report of a large study, and the time to write it.

A year of hours, 500 sensors, three views with states, glare, the terms of five phases,
and noisy pictures of two days, which compress worst. Values are closed forms.

    python benchmarks/report.py [--write docs/benchmarks/report.md]
"""

import argparse
import datetime
import importlib.util
import platform
import sys
import tempfile
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

import clerestory
from clerestory.image.picture import Picture
from clerestory.image.picture_files import write_picture
from clerestory.report.page import write_report

TESTS = Path(__file__).parents[1] / "tests" / "unit" / "report"
SENSORS, SIZE = 500, (600, 800)
VIEWS = ("desk", "door", "window")
MOMENTS = [f"06-21T{hour:02d}:30" for hour in range(5, 20)]
MOMENTS += [f"12-21T{hour:02d}:30" for hour in range(8, 17)]


def module(name):
    """Load the closed forms of the tests."""
    spec = importlib.util.spec_from_file_location(name, TESTS / f"{name}.py")
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


def write_pictures(folder):
    """Write pictures of nothing but noise before a ramp of light."""
    rng = np.random.default_rng(1)
    ramp = np.linspace(0.1, 30, SIZE[1], dtype=np.float32)[None, :, None]
    for view in VIEWS:
        for moment in MOMENTS:
            noise = rng.gamma(2, size=(*SIZE, 1)).astype(np.float32)
            pixels = noise * ramp * np.ones(3, dtype=np.float32)
            name = f"{view}_{moment.replace(':', '')}.hdr"
            write_picture(Picture(pixels), folder / name)


def measure(results, page, pictures):
    """Size [MB], processor and wall time [s] of a page."""
    wall, cpu = perf_counter(), process_time()
    write_report(results, page, pictures=pictures)
    return page.stat().st_size / 1e6, process_time() - cpu, perf_counter() - wall


def table():
    """Rows of the table: a study of the demo's size, and a large one."""
    room, course = module("analytic_room"), module("course")
    course.VIEWS = VIEWS
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_pictures(folder)
        small = room.analytic_results()
        points = room.desk_points(0.295)[:SENSORS]
        large = room.analytic_results(points=points, with_eyes=False)
        full = course.with_course(large, pictures=MOMENTS)
        for words, results, pictures in (
            ("81 sensors", small, None),
            ("500 sensors", large, None),
            ("500 sensors, 3 views, states, five phases, no pictures", full, None),
            ("the same, with 72 pictures of noise", full, folder),
        ):
            size, cpu, wall = measure(results, folder / "page.html", pictures)
            rows.append(f"| {words} | {size:.1f} | {cpu:.1f} | {wall:.1f} |")
    return rows


def main():
    """Print the table, or write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path, help="a Markdown file")
    target = parser.parse_args().write
    today = datetime.datetime.now(tz=datetime.UTC).date()
    lines = [
        "# The size of reports",
        "",
        "`benchmarks/report.py`: a year of hours in closed form.",
        "",
        "| study | page [MB] | processor [s] | wall [s] |",
        "|---|---|---|---|",
        *table(),
        "",
        f"{today}, {platform.machine()}, Python {platform.python_version()},"
        f" clerestory {clerestory.__version__}.",
    ]
    text = "\n".join(lines) + "\n"
    if target:
        target.write_text(text, encoding="utf-8")
    sys.stdout.write(text)


if __name__ == "__main__":
    main()
