"""Annual glare at a view point by the five-phase method, without pictures.

    python benchmarks/view_point.py [--parts year pictures seeds] [--hours 120]
                                    [--resolution 400] [--tree FILE] [--store FOLDER]
                                    [--write FILE]

The demo room of `annual_pictures.py`, a year of Greensboro, eight directions from one
point. Three parts:

    year      wall and processor time from a cold start, in a process of its own
    pictures  DGP of some hours against five-phase pictures of four of the directions
    seeds     the stated error of DGP against the scatter over eight seeds

Results of the parts are kept in a folder, so that they can be run one at a time.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from annual_pictures import WEATHER, chosen, cut_off_deg, prepare
from duel import stamp

import clerestory as cl
from clerestory.engine.effort import Effort
from clerestory.glare.annual_glare import annual_glare
from clerestory.glare.point_glare import views_around
from clerestory.glare.sphere_refinement import Refinement
from clerestory.glare.view_point_tracer import ViewPointTracer, trace_view_point
from clerestory.image.camera import Camera
from clerestory.phases.direct_light import blackened
from clerestory.phases.matrix_equation import Skies
from clerestory.phases.methods import FIVE_PHASE
from clerestory.phases.picture_matrices import reflected_view_matrices
from clerestory.phases.picture_series import luminance_over_time
from clerestory.phases.shaded_windows import (
    ShadedWindow,
    ShadeState,
    receiving_matrices,
)
from clerestory.phases.traced_matrices import daylight_matrix
from clerestory.phases.window_paths import picture_window_paths
from clerestory.scene.model import Scene
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import sun_matrix
from clerestory.sky.weather import Weather

EYE = np.array([3, 3, 1.2])

# Directions of the pictures, clockwise from north in steps of 45°
LOOKS = (2, 3, 4, 5)

# Paths per pixel of V, and to the windows; number of seeds; limits of DGP classes
SAMPLES, PATHS, SEEDS = 16, 16, 8
CLASSES = (0.35, 0.40, 0.45)


def room(home: Path) -> tuple[Scene, ShadedWindow, Skies, Weather]:
    """Return the scene, its window, the skies and the weather."""
    scene = cl.read_rad(home / "materials.rad", home / "room.rad")
    window = cl.read_window(home / "window.rad")
    layer, weather = cl.read_bsdf(home / "blind.xml"), cl.read_weather(home / WEATHER)
    sky, sun = (
        sky_matrix(weather, subdivision=4, include=part) for part in ("all", "sun")
    )
    T = layer.transmission_matrix(window=window.name)
    how = {"subdivision": 4, "relative_error": 0.01}
    D = daylight_matrix(scene, window, seed=2, **how)
    D_d = daylight_matrix(blackened(scene), window, bounces=0, seed=3, **how)
    state = ShadeState(whole=(T, D), direct=(T, D_d), bsdf=layer, peak=True)
    skies = Skies(sky, sun, sun_matrix(weather))
    return scene, ShadedWindow(window, (state,)), skies, weather


def year(home: Path) -> dict[str, object]:
    """Compute a year in this process; return seconds of each stage and counts."""
    marks = [(time.perf_counter(), time.process_time())]

    def lap() -> tuple[float, float]:
        marks.append((time.perf_counter(), time.process_time()))
        (a, b), (c, d) = marks[-2:]
        return c - a, d - b

    scene, window, skies, _ = room(home)
    stages = {"read, sky, T, D, D_d": lap()}
    point = trace_view_point(scene, [window], EYE, skies=skies, seed=1)
    stages["cells, V, paths to windows"] = lap()
    found = point.glare()
    stages["year of 8 directions"] = lap()
    hours = int(found.dgp[0].notnull().sum())
    return {"stages": stages, "cells": point.samples.count, "hours": hours}


def cold_year(home: Path) -> dict[str, object]:
    """Run `year` in a process that has compiled nothing yet."""
    with tempfile.TemporaryDirectory() as cold:
        start = time.perf_counter()
        child = subprocess.Popen(
            [sys.executable, __file__, "--inside", str(home)],
            env={**os.environ, "HOME": cold},
            stdout=subprocess.PIPE,
            text=True,
        )
        assert child.stdout is not None
        text = child.stdout.read()
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode:
            raise subprocess.CalledProcessError(child.returncode, child.args)
    return {
        **json.loads(text.splitlines()[-1]),
        "wall": time.perf_counter() - start,
        "processor": used.ru_utime + used.ru_stime,
        "memory": used.ru_maxrss / 1e6,
    }


def some_hours(weather: Weather, count: int) -> np.ndarray:
    """Return sunny hours, half of them near the cut-off angle, and cloudy ones."""
    sunny = np.isin(weather.times, chosen(weather, count * 3 // 4).times)
    dull = np.flatnonzero((weather.diffuse_horizontal > 20) & ~sunny)
    dull = dull[weather.direct_normal[dull] < 50]
    cloudy = dull[np.arange(count // 4) * len(dull) // max(1, count // 4)]
    return np.union1d(np.flatnonzero(sunny), cloudy)


def pictures(home: Path, hours: int, resolution: int) -> dict[str, object]:
    """Return DGP and Ev of some hours from pictures and from cells, by direction."""
    scene, window, skies, weather = room(home)
    steps = some_hours(weather, hours)
    point = trace_view_point(scene, [window], EYE, skies=skies, seed=1)
    found, some = point.glare(steps=steps), skies.select(steps)
    table: dict[str, object] = {"times": weather.times[steps].astype(str).tolist()}
    for look in LOOKS:
        view = point.views[look]
        camera, given = Camera(view, resolution, resolution), (scene, [window.window])
        V = reflected_view_matrices(*given, camera, samples=SAMPLES, seed=70 + look)
        paths = picture_window_paths(*given, camera, samples=PATHS, seed=80 + look)
        suns = None if skies.suns is None else skies.suns.directions
        matrices = receiving_matrices([window], V, paths, suns)
        series = luminance_over_time(matrices, FIVE_PHASE, camera, some)
        full = annual_glare(series, view)
        table[str(45 * look)] = {
            "dgp": found.dgp[look].values.tolist(),
            "error": found.dgp_error[look].values.tolist(),
            "ev": found.illuminance[look].values.tolist(),
            "full_dgp": full.dgp.values.tolist(),
            "full_ev": full.illuminance.values.tolist(),
        }
        print(f"direction {45 * look}°: done", file=sys.stderr)
    return table


def seeds(home: Path, hours: int) -> dict[str, object]:
    """Return DGP and its stated error of some hours with several seeds."""
    scene, window, skies, weather = room(home)
    tracer = ViewPointTracer(scene, (window,), skies, tuple(FIVE_PHASE))
    steps, values, errors = some_hours(weather, hours), [], []
    for seed in range(1, SEEDS + 1):
        found = tracer.point(
            EYE,
            views_around(8, position=EYE),
            refinement=Refinement(),
            effort=Effort(samples=256, seed=1000 * seed),
        ).glare(steps=steps)
        values.append(found.dgp.values.tolist())
        errors.append(found.dgp_error.values.tolist())
    return {"dgp": values, "error": errors}


def moved_classes(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return by how many DGP classes values differ."""
    classes = (np.digitize(values, CLASSES) for values in (one, other))
    first, second = classes
    return abs(first - second)


def text_of_year(found: dict) -> list[str]:
    """Return the lines of the page about a year from a cold start."""
    lines = [
        f"A year ({found['hours']:,} daylit hours, {found['cells']:,} cells), nothing"
        f" compiled or cached before: **{found['processor']:.0f} s of processor time**,"
        f" {found['wall']:.0f} s of wall time on a machine shared with other work, at"
        f" most {found['memory']:.2f} GB.",
        "",
        "| stage | wall | processor |",
        "|---|---|---|",
    ]
    for name, (wall, processor) in found["stages"].items():
        lines.append(f"| {name} | {wall:.1f} s | {processor:.1f} s |")
    return [*lines, ""]


def text_of_pictures(found: dict, resolution: int) -> list[str]:
    """Return the lines of the page about pictures."""
    times = found.pop("times")
    lines = [
        f"DGP of {len(times)} hours against five-phase pictures of {resolution}² pixels"
        f" ({SAMPLES} paths per pixel; three quarters of the hours sunny, half of these"
        f" close to the cut-off angle of the blind, {cut_off_deg():.1f}°; noise of both"
        " included):",
        "",
        "| direction | mean absolute error | mean error | 95 % within | at most |"
        " moved by a class | by two | Ev, mean relative error |",
        "|---|---|---|---|---|---|---|---|",
    ]
    every, hours = [], []
    for look, part in found.items():
        dgp, full, ev, full_ev, error = (
            np.array(part[name])
            for name in ("dgp", "full_dgp", "ev", "full_ev", "error")
        )
        every.append((dgp, full, ev, full_ev, error))
        hours += [
            (d - f, f, e, look, t)
            for d, f, e, t in zip(dgp, full, error, times, strict=True)
        ]
        lines.append(_row(f"{look}°", dgp, full, ev, full_ev))
    whole = [np.concatenate(each) for each in zip(*every, strict=True)]
    lines.append(_row("all", *whole[:4]))
    off = whole[0] - whole[1]
    lines += [
        "",
        f"Root mean square of the differences {np.sqrt(np.mean(off**2)):.4f}, of the"
        f" stated errors `dgp_error` {np.sqrt(np.mean(whole[4] ** 2)):.4f};"
        f" {np.mean(abs(off) < 2 * whole[4]):.0%} of the differences are within two"
        " stated errors. Where the sun's disc is seen, it fills whole pixels of the"
        " picture, but its own solid angle among the cells; cells that straddle an edge"
        " of a source lower DGP slightly.",
        "",
        "The hours with the largest differences:",
        "",
        "| hour | direction | pictures | cells less pictures | stated error |",
        "|---|---|---|---|---|",
    ]
    for d, f, e, look, moment in sorted(hours, key=lambda each: -abs(each[0]))[:12]:
        lines.append(f"| {moment[5:16]} | {look}° | {f:.3f} | {d:+.4f} | {e:.4f} |")
    return [*lines, ""]


def _row(name: str, dgp, full, ev, full_ev) -> str:
    off, moved = dgp - full, moved_classes(dgp, full)
    return (
        f"| {name} | {abs(off).mean():.4f} | {off.mean():+.4f} |"
        f" {np.quantile(abs(off), 0.95):.4f} | {abs(off).max():.4f} |"
        f" {(moved == 1).sum()} of {len(off)} | {(moved > 1).sum()} |"
        f" {abs(ev / full_ev - 1).mean():.2%} |"
    )


def text_of_seeds(found: dict) -> list[str]:
    """Return the lines of the page about seeds."""
    values, errors = np.array(found["dgp"]), np.array(found["error"])
    scatter = np.sqrt(values.var(axis=0, ddof=1).mean(axis=-1))
    stated = np.sqrt(np.square(errors).mean(axis=(0, -1)))
    lines = [
        f"Scatter of DGP over {SEEDS} seeds and root mean square of the stated error,"
        " by direction. The stated error also covers the finite size of the cells,"
        " which is nearly the same with all seeds; it matters where windows are seen:",
        "",
        "| direction | scatter | stated | ratio |",
        "|---|---|---|---|",
    ]
    for number, (one, other) in enumerate(zip(scatter, stated, strict=True)):
        lines.append(
            f"| {45 * number}° | {one:.4f} | {other:.4f} | {other / one:.2f} |"
        )
    return [*lines, ""]


def main() -> None:
    """Read the command line, run the parts, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    names = ["year", "pictures", "seeds"]
    parser.add_argument("--parts", nargs="*", default=names, choices=names)
    parser.add_argument("--hours", type=int, default=120)
    parser.add_argument("--resolution", type=int, default=400)
    parser.add_argument("--tree", type=Path, help="file of the tree, made if missing")
    parser.add_argument("--store", type=Path, help="folder of the results of parts")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    parser.add_argument("--inside", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.inside:
        print(json.dumps(year(options.inside)))
        return
    lines = [
        "# A year of glare at a view point",
        "",
        f"{stamp()}. Made by `benchmarks/view_point.py`.",
        "",
        "Demo room behind a tensor tree of a venetian blind (2^6 cells per axis,"
        " unscattered transmission extracted), five phases, one point, eight"
        " directions, a year of Greensboro.",
        "",
    ]
    with tempfile.TemporaryDirectory() as folder:
        store = options.store or Path(folder) / "parts"
        store.mkdir(exist_ok=True)
        home = prepare(Path(folder), options.tree)
        run = {
            "year": lambda: cold_year(home),
            "pictures": lambda: pictures(home, options.hours, options.resolution),
            "seeds": lambda: seeds(home, options.hours),
        }
        for name in options.parts:
            (store / f"{name}.json").write_text(json.dumps(run[name]()))
        kept = {
            name: json.loads(file.read_text())
            for name in names
            if (file := store / f"{name}.json").exists()
        }
    if "year" in kept:
        lines += text_of_year(kept["year"])
    if "pictures" in kept:
        lines += text_of_pictures(kept["pictures"], options.resolution)
    if "seeds" in kept:
        lines += text_of_seeds(kept["seeds"])
    text = "\n".join(lines)
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
