"""Models of buildings: import, annual study and report of each file.

    python benchmarks/building_models.py FILE... --weather WEATHER.epw [--write PAGE]
        [--samples N] [--keep FOLDER]

Each file is imported, run with the defaults of a study or with `--samples`, and its
report written, by the command line in processes of their own. Processor seconds include
children; seconds by the clock are for this machine and its load.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from duel import stamp

import clerestory
from clerestory.study.config import read_study

_ENTRY = "import sys; from clerestory.cli.main import main; sys.exit(main())"


@dataclass(frozen=True)
class Spent:
    """Exit status and message of a command, processor time and clock time [s]."""

    status: int
    message: str
    cpu: float
    clock: float


def command(*words: str | Path) -> Spent:
    """Run a command of this package."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    source = str(Path(clerestory.__file__).parents[1])
    done = subprocess.run(
        [sys.executable, "-c", _ENTRY, *map(str, words)],
        env={**os.environ, "PYTHONPATH": source},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    errors = done.stderr.strip().splitlines()
    message = errors[-1] if errors else ""
    return Spent(done.returncode, message, used, time.monotonic() - start)


def row(model: Path, folder: Path, given: argparse.Namespace) -> str:
    """Import, run and report a model; return its row of the table."""
    name = f"| `{model.parent.name}/{model.name}` |"
    words = ["import", model, "-o", folder, "--weather", given.weather]
    if given.spacing:
        words += ["--spacing", given.spacing]
    made = command(*words)
    if made.status:
        wrote = "" if not folder.exists() else " FILES WRITTEN"
        reason = made.message.rpartition(f"{model.name}: ")[2].replace("|", "/")
        return f"{name} refused: {reason}{wrote} |" + " |" * 7
    study = folder / "study.toml"
    left = (folder / "left_out.txt").read_text().splitlines()
    omitted = 0 if left == ["nothing"] else len(left)
    if not study.exists():
        return f"{name} no sensors and no rooms with a floor |" + " |" * 7
    if given.samples:
        effort = f"\n[trace]\nsamples = {given.samples}\nbounces = {given.bounces}\n"
        study.write_text(study.read_text() + effort)
    config = read_study(study)
    results = folder / "results"
    done = command("run", study, "--out", results, "--quiet")
    if done.status:
        return f"{name} run failed: {done.message} |" + " |" * 7
    with xr.open_dataset(results / "results.nc") as found:
        lux = found["mean_illuminance"].values
    size = (results / "report.html").stat().st_size / 1e6
    return (
        f"{name} {'+'.join(config.methods)} | {len(config.window)} |"
        f" {len(config.sensors)} | {len(lux)} | {omitted} | {np.nanmean(lux):.0f} |"
        f" {made.cpu:.0f} + {done.cpu:.0f} | {made.clock + done.clock:.0f} |"
        f" {size:.1f} |"
    )


def main() -> None:
    """Print the rows, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", type=Path, nargs="+")
    parser.add_argument("--weather", type=Path, required=True)
    parser.add_argument("--samples", type=int)
    parser.add_argument("--bounces", type=int, default=4)
    parser.add_argument("--spacing", type=float)
    parser.add_argument("--keep", type=Path, help="folder for the studies")
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    lines = [
        "| model | method | groups | grids | sensors | left out | mean [lux] |"
        " import + run [CPU s] | clock [s] | report [MB] |",
        "|---" * 10 + "|",
    ]
    with tempfile.TemporaryDirectory() as scratch:
        for number, model in enumerate(given.models):
            folder = (given.keep or Path(scratch)) / f"{number:02d}-{model.stem}"
            lines.append(row(model, folder, given))
            print(lines[-1], flush=True)
    if given.write:
        given.write.write_text("\n".join([stamp(), "", *lines]) + "\n")


if __name__ == "__main__":
    main()
