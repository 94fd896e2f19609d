"""Size of the interactive page of a large study, and the times of its sliders.

A year of hours of 2,088 sensors behind a blind of three states: light of two parts of
the sky and of a sun patch that moves over the floor, with independent errors of 1 % of
each sensor and part. Times are those of the page's main thread in Chromium.

    python benchmarks/explore.py [--write docs/benchmarks/explore.md]
"""

import argparse
import datetime
import os
import platform
import sys
import tempfile
from pathlib import Path
from time import perf_counter, process_time

import numpy as np
import xarray as xr
from chromium_pipe import Page

import clerestory
from clerestory.report.explore_page import write_explorer
from clerestory.study.results import Results

COLUMNS, ROWS, ERROR, REPEATS = 58, 36, 0.01, 15
SHARES = (1.0, 0.3, 0.08)

# Waits for the page, and returns the time since its request
OPENED = """
const root = () => document.documentElement;
while (!root()?.dataset.scripts) await new Promise(done => setTimeout(done, 5));
return +root().dataset.opened;
"""

# Steps of the page by name; K is the number of the repetition
YEAR = "explorer.showYear();"
STEPS = {
    "limit of daylight autonomy": "set('low', 200 + 10 * K);" + YEAR,
    "limit of useful illuminance": (
        "set('metric', 'useful'); set('low', 200 + 10 * K);" + YEAR
    ),
    "the same over 24 hours a day": (
        "set('hours', 'own'); set('from-hour', 0); set('to-hour', 24);"
        "set('low', 200 + 10 * K);" + YEAR
    ),
    "date or time": "set('hour', 8 + K % 10); explorer.showMoment();",
}
OPERATIONS = {
    "a state, read for the first time": "all:1",
    "a rule, whose states are read": "rule",
    "a state, read before": "all:1",
}
PAINT = "explorer.year.canvas.getContext('2d').getImageData(0, 0, 1, 1);"
SET = "const set = (name, value) => { byId(name).value = value; };"


def large_results():
    """Results of a year in an open-plan office of 29 m × 18 m."""
    rng = np.random.default_rng(1)
    times = np.datetime64("2023-01-01T00:30", "s") + np.arange(8760) * np.timedelta64(
        3600, "s"
    )
    x, y = (a.ravel() for a in np.meshgrid(np.arange(COLUMNS), np.arange(ROWS)))
    day, hour = np.arange(8760) / 24, np.arange(8760) % 24 + 0.5
    declination = np.radians(23.4) * np.sin(2 * np.pi * (day - 81) / 365)
    sun = np.sin(0.84) * np.sin(declination)
    sun += np.cos(0.84) * np.cos(declination) * np.cos(np.pi * (hour - 12) / 12)
    clear = rng.beta(0.6, 0.5, 365).repeat(24) * np.clip(rng.normal(1, 0.1, 8760), 0, 2)
    bright = np.clip(sun, 0, 1)
    depth, noise = np.exp(-y / 9), 1 + ERROR * rng.normal(size=(3, len(x)))
    lux = np.outer(depth * noise[0], 9000 * bright * (1.2 - clear))
    lux += np.outer((0.02 + depth**2) * noise[1], 6000 * bright * clear)
    reach = 4 / np.tan(np.arcsin(np.clip(sun, 0.05, 0.99)))
    shift = np.tan(np.clip(np.pi * (hour - 12) / 12, -1.2, 1.2)) * y[:, None]
    lit = (y[:, None] < reach) & ((x[:, None] + shift) % 6 < 4) & (sun > 0.05)
    lux += lit * np.outer(noise[2], 40_000 * clear * bright)
    irradiance = 600 * clear * bright
    return results_of(lux.astype(np.float32), times, np.stack([x, y], 1), irradiance)


def results_of(lux, times, place, irradiance):
    """Results with states, of which one acts by hour."""
    count, hour = len(place), times.astype("datetime64[h]").astype(int) % 24
    state = np.select([hour < 10, hour < 15], [0, 1], default=2)
    shares = np.array(SHARES, np.float32)
    axes = ("sensor", "time")
    operated = lux * shares[state]
    position = np.column_stack([0.5 * place, np.full(count, 0.8)])
    data = xr.Dataset(
        {
            "illuminance": (axes, operated),
            "standard_error": (axes, np.float32(ERROR) * operated),
            "occupied": ("time", (hour >= 8) & (hour < 18)),
            "state": (("window", "time"), state[None].astype(np.int8)),
            "state_name": (("window", "state_number"), [["open", "45°", "closed"]]),
            "facade_irradiance": (("window", "time"), irradiance[None]),
            "illuminance_by_state": (
                ("sensor", "window", "state_number", "time"),
                lux[:, None, None] * shares[:, None],
            ),
        },
        coords={
            "sensor": [f"desks.{k + 1}" for k in range(count)],
            "grid": ("sensor", ["desks"] * count),
            "position": (("sensor", "xyz"), position),
            "direction": (("sensor", "xyz"), np.tile([0.0, 0, 1], (count, 1))),
            "time": times,
            "window": ["south"],
        },
        attrs={"title": "Open-plan office"},
    )
    return Results(data)


def browser_times(file):
    """Clock and processor times [ms] of the steps of a page, by name."""
    found = {}
    with Page() as page:
        page.call("Performance.enable", timeDomain="threadTicks")

        def measure(name, script, count):
            times = []
            for number in range(count):
                start, before = perf_counter(), page.processor_time()
                page.evaluate(script.replace("K", str(number)))
                times.append((perf_counter() - start, page.processor_time() - before))
            found[name] = 1000 * np.array(times)

        page.call("Page.navigate", url=file.resolve().as_uri())
        opened = page.evaluate(OPENED)
        found["page opened"] = np.array([[opened, 1000 * page.processor_time()]])
        for name, script in STEPS.items():
            measure(name, SET + script + PAINT, REPEATS)
        if page.evaluate("return Boolean(byId('kind-a'));"):
            for name, kind in OPERATIONS.items():
                load = f"set('kind-a', '{kind}'); await explorer.load();"
                measure(name, SET + load + YEAR + PAINT, 1)
    return found


def main():
    """Print the table, or write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path, help="a Markdown file")
    target = parser.parse_args().write
    results = large_results()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "explore.html"
        for name in ("all states", "as operated"):
            start = process_time()
            write_explorer(results, page)
            spent, size = process_time() - start, page.stat().st_size / 1e6
            held = "states" if "part-state-0-0" in page.read_text() else "no states"
            rows.append(
                f"| {name}: {size:.1f} MB, {held}; {spent:.1f} s to write | | |"
            )
            for what, times in browser_times(page).items():
                clock, spent = np.median(times, axis=0)
                rows.append(f"| {what} | {spent:.0f} | {clock:.0f} |")
            fewer = results.data.drop_vars("illuminance_by_state", errors="ignore")
            results = Results(fewer)
    today = datetime.datetime.now(tz=datetime.UTC).date()
    lines = [
        "# The interactive page of a large study",
        "",
        f"`benchmarks/explore.py`: {COLUMNS * ROWS:,} sensors, 8,760 hours; medians of"
        f" {REPEATS} repetitions. Processor time is that of the page's main thread."
        f" Time by the clock grows with other work on the computer: {os.cpu_count()}"
        f" cores had a load of {os.getloadavg()[0]:.0f}.",
        "",
        "| step in the page | processor time [ms] | by the clock [ms] |",
        "|---|---|---|",
        *rows,
        "",
        f"{today}, {platform.machine()}, Python {platform.python_version()},"
        f" clerestory {clerestory.__version__}, Chromium headless.",
    ]
    text = "\n".join(lines) + "\n"
    if target:
        target.write_text(text, encoding="utf-8")
    sys.stdout.write(text)


if __name__ == "__main__":
    main()
