"""Models of buildings: import, study and report of each file.

    python benchmarks/building_models.py FILE... --weather WEATHER.epw
        [--moment 06-21T11:30]... [--samples N | --relative-error E] [--spacing M]
        [--keep FOLDER] [--write PAGE | --add PAGE]

Each file is imported and its study run by the command line, whole and with the defaults
of a study or, to see that all models run, at some moments with few samples. Each is run
in a process of its own; processor seconds do not include its start. `--add` adds a
table to a page or, if its last table has the same date and effort, rows to that table.
A run that was interrupted is resumed by the same command, if its study is in `--keep`;
its processor time and duration are added.
"""

import argparse
import contextlib
import io
import json
import multiprocessing
import resource
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import xarray as xr
from duel import stamp

from clerestory.cli.main import main as clerestory
from clerestory.study.config import read_study

HEAD = """# Models of buildings

Models of Ladybug Tools' packages: import, run and report
(`benchmarks/building_models.py`). *Left out*: lines of `left_out.txt`. *Mean*:
illuminance over the steps and sensors. Durations are those of a machine with other
load.
"""

# Exit status of a command that a signal ended, less the number of the signal
INTERRUPTED = 128


@dataclass(frozen=True)
class Spent:
    """Exit status and message of a command, its processor time and duration [s]."""

    status: int
    message: str
    cpu: float
    wall: float


def command(*words: str | Path) -> Spent:
    """Run a command of this package."""
    start, begin, errors = time.process_time(), time.perf_counter(), io.StringIO()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(errors):
        status = clerestory([str(word) for word in words])
    said = errors.getvalue().strip().splitlines()
    spent = time.process_time() - start, time.perf_counter() - begin
    return Spent(status, said[-1] if said else "", *spent)


def peak_gb() -> float:
    """Return the largest memory of this process [GB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024e-9


def row(model: Path, folder: Path, given: argparse.Namespace) -> str:
    """Import and run a model; return its row of the table."""
    name = f"| `{model.name}` |"
    before = folder / "interrupted.json"
    if before.exists():
        return finished(name, folder, Spent(**json.loads(before.read_text())))
    words = ["import", model, "-o", folder, "--weather", given.weather]
    if given.spacing:
        words += ["--spacing", given.spacing]
    made = command(*words)
    if made.status:
        wrote = " FILES WRITTEN" if folder.exists() else ""
        reason = made.message.rpartition(f"{model.name}: ")[2].replace("|", "/")
        return f"{name} refused: {reason}{wrote} |" + " |" * 9
    study = folder / "study.toml"
    if not study.exists():
        return f"{name} no sensors, and no rooms with floors |" + " |" * 9
    text = study.read_text()
    if given.moment:
        text = text.replace("[weather]", f"[weather]\nmoments = {given.moment}")
    if given.samples:
        text += f"\n[trace]\nsamples = {given.samples}\nbounces = {given.bounces}\n"
    if given.relative_error:
        text += f"\n[trace]\nrelative_error = {given.relative_error}\n"
    study.write_text(text)
    return finished(name, folder, replace(made, wall=0.0))


def finished(name: str, folder: Path, before: Spent) -> str:
    """Run or resume an imported study, for which time was spent; return its row."""
    study, results = folder / "study.toml", folder / "results"
    left = (folder / "left_out.txt").read_text().splitlines()
    omitted = 0 if left == ["nothing"] else len(left)
    config, done = read_study(study), command("run", study, "--out", results, "--quiet")
    done = replace(done, cpu=done.cpu + before.cpu, wall=done.wall + before.wall)
    if done.status > INTERRUPTED:
        (folder / "interrupted.json").write_text(json.dumps(asdict(done)))
        return f"{name} interrupted after {done.cpu:.0f} CPU s |" + " |" * 9
    if done.status:
        return f"{name} run failed: {done.message} |" + " |" * 9
    with xr.open_dataset(results / "results.nc") as data:
        lux = data["mean_illuminance"].values
    size = (results / "report.html").stat().st_size / 1e6
    return (
        f"{name} {', '.join(config.methods)} | {len(config.window)} |"
        f" {len(config.sensors)} | {len(lux)} | {omitted} | {np.nanmean(lux):.0f} |"
        f" {done.cpu:.1f} | {done.wall:.0f} | {peak_gb():.1f} |"
        f" {size:.1f} |"
    )


def main() -> None:
    """Print the rows, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", type=Path, nargs="+")
    parser.add_argument("--weather", type=Path, required=True)
    parser.add_argument("--moment", action="append", help="run moments of the year")
    parser.add_argument("--samples", type=int)
    parser.add_argument("--relative-error", type=float)
    parser.add_argument("--bounces", type=int, default=4)
    parser.add_argument("--spacing", type=float)
    parser.add_argument("--keep", type=Path, help="folder for the studies")
    parser.add_argument("--write", type=Path)
    parser.add_argument("--add", type=Path, help="page to which the table is added")
    given = parser.parse_args()
    head = [
        "| model | method | groups | grids | sensors | left out | mean [lux] |"
        " import and run [CPU s] | run [s] | memory [GB] | report [MB] |",
        "|---" * 11 + "|",
    ]
    new, rows = multiprocessing.get_context("spawn"), []
    with (
        tempfile.TemporaryDirectory() as scratch,
        ProcessPoolExecutor(1, mp_context=new, max_tasks_per_child=1) as pool,
    ):
        for number, model in enumerate(given.models):
            folder = (given.keep or Path(scratch)) / f"{number:02d}-{model.stem}"
            rows.append(pool.submit(row, model, folder, given).result())
            print(rows[-1], flush=True)
    title = "\n".join([stamp(), "", effort(given), "", *head]) + "\n"
    body = "\n".join(rows) + "\n"
    if given.write:
        given.write.write_text(f"{HEAD}\n{title}{body}")
    if given.add:
        page = given.add.read_text()
        same = title in page and "\n\n" not in page.rpartition(title)[2]
        given.add.write_text(page + (body if same else f"\n{title}{body}"))


def effort(given: argparse.Namespace) -> str:
    """Return in words what was run."""
    hours = "Whole years"
    if given.moment:
        hours = "Moments " + ", ".join(given.moment)
    aim = "with the default effort"
    if given.samples:
        aim = f"with {given.samples} samples and {given.bounces} bounces"
    elif given.relative_error:
        aim = f"with relative_error = {given.relative_error}"
    grid = f", grids at {given.spacing} m where the model has none"
    weather = f"Weather {given.weather.name}. {hours}"
    return f"{weather} {aim}{grid if given.spacing else ''}."


if __name__ == "__main__":
    main()
