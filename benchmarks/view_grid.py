"""Annual glare of a view grid whose worst view controls the shades of two windows.

    python benchmarks/view_grid.py [--positions 2 4] [--whole] [--write FILE]

The test room of the demo with its window divided in two groups, each with four states:
clear double glazing, a venetian blind, and two diffusing shades. A position has eight
directions; the rule "glare" takes the most open state with DGP up to 0.40 in all views.
Weather is the year of Greensboro, the method has five phases. Two small grids are run,
and the time of 100 positions is extrapolated from their difference; `--whole` runs 100.
Times are processor time of all threads.
"""

import argparse
import json
import resource
import shutil
import subprocess
import sys
import tempfile
from importlib import resources
from pathlib import Path

import numpy as np
from duel import stamp

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.study.results import read_results

WEATHER = "723170TYA.CSV"
GOAL = 100

# Diffusing shades: transmittance
SHADES = {"screen": 0.10, "dimout": 0.02}

# Sills and heads of the two windows [m]
WINDOWS = {"lower": (0.85, 1.9), "upper": (1.9, 2.65)}

STATES = {"clear": "double_pane.xml", "blind": "venetian_blind.xml"} | {
    name: f"{name}.xml" for name in SHADES
}


def study_text(positions: list[list[float]]) -> str:
    """Return the study file."""
    lines = [
        'title = "Worst view of a grid"',
        'method = "5-phase"',
        '[scene]\nfiles = ["materials.rad", "room.rad"]',
        '[[sensors]]\nfile = "desks.pts"',
        f'[weather]\nfile = "{WEATHER}"',
    ]
    for name in WINDOWS:
        lines.append(f'[[window]]\nname = "{name}"\nfile = "{name}.rad"')
        for state, file in STATES.items():
            peak = "true" if state == "clear" else "false"
            lines.append(
                f'[[window.state]]\nname = "{state}"\nbsdf = "{file}"\npeak = {peak}'
            )
        lines.append('[window.control]\nrule = "glare"\nview_grids = ["room"]')
    lines.append(
        f'[[view_grid]]\nname = "room"\nplaces = {positions}\npicture_resolution = 0'
    )
    return "\n".join(lines)


def places(count: int) -> list[list[float]]:
    """Return positions spread over the room, near and far from the windows."""
    columns = int(np.ceil(np.sqrt(count)))
    x = np.linspace(0.8, 5.3, columns)
    y = np.linspace(0.9, 8.2, -(-count // columns))
    points = [[round(a, 3), round(b, 3), 1.2] for b in y.tolist() for a in x.tolist()]
    chosen = np.linspace(0, len(points) - 1, count).round().astype(int)
    return [points[k] for k in chosen]


def prepare(folder: Path) -> None:
    """Write the input files of the study."""
    demo = resources.files("clerestory") / "demo"
    for source in demo.iterdir():
        shutil.copy(str(source), folder)
    shutil.copy(str(resources.files("pvlib") / "data" / WEATHER), folder)
    for name, tau in SHADES.items():
        write_bsdf(folder / f"{name}.xml", lambertian(tau, klems("full")))
    for name, (sill, head) in WINDOWS.items():
        corners = f"6.1 -0.1 {sill} 0 -0.1 {sill} 0 -0.1 {head} 6.1 -0.1 {head}"
        text = f"#@rfluxmtx h=kf u=Z\nvoid polygon {name}\n0\n0\n12 {corners}\n"
        (folder / f"{name}.rad").write_text(text)


def run(folder: Path, count: int) -> dict[str, float]:
    """Run the study with some positions; return processor time and memory."""
    study = folder / f"grid_{count}.toml"
    study.write_text(study_text(places(count)))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    out = folder / f"out_{count}"
    code = "import sys; from clerestory.cli.main import main; sys.exit(main())"
    command = [sys.executable, "-c", code, "run", str(study), "--out", str(out), "-q"]
    subprocess.run(command, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    found = {
        "seconds": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
        "memory": after.ru_maxrss / 1e6,
    }
    stages = json.loads((out / "run.json").read_text())["seconds"]
    data = read_results(out / "results.nc").data
    found["wall"] = sum(stages.values())
    found["closed"] = float((data["state"] > 0).mean())
    return found | {f"stage {name}": spent for name, spent in stages.items()}


def report(small: int, large: int, folder: Path, *, whole: bool) -> str:
    """Measure, and return the table."""
    found = {count: run(folder, count) for count in (small, large)}
    each = (found[large]["seconds"] - found[small]["seconds"]) / (large - small)
    start = found[small]["seconds"] - small * each
    lines = [
        "| positions | processor time | peak memory | hours with closed shades |",
        "|---|---|---|---|",
    ]
    if whole:
        found[GOAL] = run(folder, GOAL)
    for count, one in found.items():
        lines.append(
            f"| {count} | {one['seconds']:.0f} s | {one['memory']:.2f} GB |"
            f" {100 * one['closed']:.0f} % |"
        )
    total = (start + GOAL * each) / 60
    lines += [
        "",
        f"Each position: {each:.1f} s of processor time. {GOAL} positions,"
        f" extrapolated: {total:.0f} min of processor time, {total / 2:.0f} min on two"
        " cores if both are always busy.",
    ]
    return "\n".join(lines)


def main() -> None:
    """Print or write the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--positions", type=int, nargs=2, default=[2, 4])
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = asked.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        prepare(folder)
        small, large = sorted(asked.positions)
        table = report(small, large, folder, whole=asked.whole)
    text = f"{__doc__.split(chr(10))[0]}\n\n{stamp()}\n\n{table}\n"
    print(text)
    if asked.write:
        asked.write.write_text(text)


if __name__ == "__main__":
    main()
