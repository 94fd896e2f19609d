"""Models of buildings: import, study and report of each file.

    python benchmarks/building_models.py FILE... --weather WEATHER.epw [--write PAGE]
        [--moment 06-21T11:30] [--samples N] [--spacing M] [--keep FOLDER]

Each file is imported and its study run by the command line, whole and with the defaults
of a study or, to see that all models run, at one moment with few samples. All are run
in one process: processor seconds do not include its start.
"""

import argparse
import contextlib
import io
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from duel import stamp

from clerestory.cli.main import main as clerestory
from clerestory.study.config import read_study


@dataclass(frozen=True)
class Spent:
    """Exit status and message of a command, and its processor time [s]."""

    status: int
    message: str
    cpu: float


def command(*words: str | Path) -> Spent:
    """Run a command of this package."""
    start, errors = time.process_time(), io.StringIO()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(errors):
        status = clerestory([str(word) for word in words])
    said = errors.getvalue().strip().splitlines()
    return Spent(status, said[-1] if said else "", time.process_time() - start)


def row(model: Path, folder: Path, given: argparse.Namespace) -> str:
    """Import and run a model; return its row of the table."""
    name = f"| `{model.name}` |"
    words = ["import", model, "-o", folder, "--weather", given.weather]
    if given.spacing:
        words += ["--spacing", given.spacing]
    made = command(*words)
    if made.status:
        wrote = " FILES WRITTEN" if folder.exists() else ""
        reason = made.message.rpartition(f"{model.name}: ")[2].replace("|", "/")
        return f"{name} refused: {reason}{wrote} |" + " |" * 7
    study = folder / "study.toml"
    left = (folder / "left_out.txt").read_text().splitlines()
    omitted = 0 if left == ["nothing"] else len(left)
    if not study.exists():
        return f"{name} no sensors, and no rooms with floors |" + " |" * 7
    text = study.read_text()
    if given.moment:
        found = f'[weather]\nmoments = ["{given.moment}"]'
        text = text.replace("[weather]", found)
    if given.samples:
        text += f"\n[trace]\nsamples = {given.samples}\nbounces = {given.bounces}\n"
    study.write_text(text)
    config, results = read_study(study), folder / "results"
    done = command("run", study, "--out", results, "--quiet")
    if done.status:
        return f"{name} run failed: {done.message} |" + " |" * 7
    with xr.open_dataset(results / "results.nc") as data:
        lux = data["illuminance"].values.mean(axis=1)
    size = (results / "report.html").stat().st_size / 1e6
    return (
        f"{name} {', '.join(config.methods)} | {len(config.window)} |"
        f" {len(config.sensors)} | {len(lux)} | {omitted} | {np.nanmean(lux):.0f} |"
        f" {made.cpu:.1f} + {done.cpu:.1f} | {size:.1f} |"
    )


def main() -> None:
    """Print the rows, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", type=Path, nargs="+")
    parser.add_argument("--weather", type=Path, required=True)
    parser.add_argument("--moment", help="run one moment of the year only")
    parser.add_argument("--samples", type=int)
    parser.add_argument("--bounces", type=int, default=4)
    parser.add_argument("--spacing", type=float)
    parser.add_argument("--keep", type=Path, help="folder for the studies")
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    lines = [
        "| model | method | groups | grids | sensors | left out | mean [lux] |"
        " import + run [CPU s] | report [MB] |",
        "|---" * 9 + "|",
    ]
    with tempfile.TemporaryDirectory() as scratch:
        for number, model in enumerate(given.models):
            folder = (given.keep or Path(scratch)) / f"{number:02d}-{model.stem}"
            lines.append(row(model, folder, given))
            print(lines[-1], flush=True)
    if given.write:
        effort = "whole years with the defaults"
        if given.moment:
            effort = f"one moment, {given.moment}, with {given.samples} samples"
        head = [
            "# Models of buildings",
            "",
            "Models of Ladybug Tools' packages and of other collections: import, run",
            f"and report (`benchmarks/building_models.py`), {effort}.",
            "",
            stamp(),
            "",
        ]
        given.write.write_text("\n".join([*head, *lines]) + "\n")


if __name__ == "__main__":
    main()
