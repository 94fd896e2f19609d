"""Size of the interactive page of a large study, and the times of its sliders.

A year of hours of 2,088 sensors behind a blind of three states: light of two parts of
the sky and of a sun patch that moves over the floor, with independent errors of 1 % of
each sensor and part. Times are measured in Chromium, by the clock of the page.

    python benchmarks/explore.py [--write docs/benchmarks/explore.md]
"""

import argparse
import datetime
import http.server
import json
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from time import process_time

import numpy as np
import xarray as xr

import clerestory
from clerestory.report.explore_page import write_explorer
from clerestory.study.results import Results

COLUMNS, ROWS, ERROR, REPEATS = 58, 36, 0.01, 15
SHARES = (1.0, 0.3, 0.08)

PROBE = """
const wait = setInterval(async () => {
  if (!document.documentElement.dataset.scripts) return;
  clearInterval(wait);
  const opened = document.documentElement.dataset.opened, times = {};
  const pause = () => new Promise(done => setTimeout(done, 0));
  const measure = async (name, count, act) => {
    const found = [];
    for (let k = 0; k < count; k++) {
      const start = performance.now();
      await act(k);
      explorer.year.canvas.getContext("2d").getImageData(0, 0, 1, 1);
      found.push(performance.now() - start);
      await pause();
    }
    times[name] = found;
  };
  const set = (name, value) => { byId(name).value = value; };
  const limit = k => { set("low", 200 + 10 * k); explorer.showYear(); };
  const hour = k => { set("hour", 8 + k % 10); explorer.showMoment(); };
  const operate = async kind => {
    set("kind-a", kind);
    await explorer.load();
    explorer.showYear();
  };
  await measure("limit of daylight autonomy", REPEATS, limit);
  set("metric", "useful");
  await measure("limit of useful illuminance", REPEATS, limit);
  set("hours", "own"); set("from-hour", 0); set("to-hour", 24);
  await measure("the same over 24 hours a day", REPEATS, limit);
  await measure("date or time", REPEATS, hour);
  if (byId("kind-a")) {
    await measure("a state, read for the first time", 1, () => operate("all:1"));
    await measure("a rule, whose states are read", 1, () => operate("rule"));
    await measure("a state, read before", 1, () => operate("all:1"));
  }
  const body = JSON.stringify({ "page opened": [+opened], ...times });
  fetch("/times", { method: "POST", body });
}, 20);
"""


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


def browser_times(page):
    """Times [ms] that Chromium measures in the page, by name."""
    found, done = {}, threading.Event()
    text = re.sub(r"<meta http-equiv[^>]*>", "", page.read_text(encoding="utf-8"))
    probe = PROBE.replace("REPEATS", str(REPEATS))
    body = text.replace("</body>", f"<script>{probe}</script></body>").encode()

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html; charset=utf-8")
            self.end_headers()
            self.wfile.write(body)

        def do_POST(self):
            length = int(self.headers["Content-Length"])
            found.update(json.loads(self.rfile.read(length)))
            self.send_response(204)
            self.end_headers()
            done.set()

        def log_message(self, *_words):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    command = shutil.which("chromium") or shutil.which("google-chrome")
    flags = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"]
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        address = f"http://127.0.0.1:{server.server_port}/"
        browser = subprocess.Popen(
            [
                *(command, *flags, f"--user-data-dir={profile}"),
                *("--remote-debugging-port=0", address),
            ],
            stderr=subprocess.DEVNULL,
        )
        done.wait(300)
        browser.terminate()
        browser.wait()
    server.shutdown()
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
                middle, shortest = np.median(times), np.min(times)
                rows.append(f"| {what} | {middle:.0f} | {shortest:.0f} |")
            fewer = results.data.drop_vars("illuminance_by_state", errors="ignore")
            results = Results(fewer)
    today = datetime.datetime.now(tz=datetime.UTC).date()
    lines = [
        "# The interactive page of a large study",
        "",
        f"`benchmarks/explore.py`: {COLUMNS * ROWS:,} sensors, 8,760 hours. Times are"
        " by the clock of the page: other work on the computer lengthens them, and the"
        " shortest is nearest to those without it.",
        "",
        "| step in the page | median [ms] | shortest [ms] |",
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
