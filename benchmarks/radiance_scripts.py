"""Shell scripts of LBNL's tutorial by Radiance and by `clerestory compat`.

    python benchmarks/radiance_scripts.py ROOM --write radiance-scripts.md

ROOM is the folder `room` of the tutorial's files, with its `commands`. The whole script
2PM_DDS.sh runs as it is; of scripts with pictures, which take hours with Radiance, the
commands for sensors run as they are, each taken from the script by its words. `-n`
is set to one process, so that processor time is not inflated by waiting.
"""

import argparse
import datetime
import os
import platform
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyradiance

import clerestory
from clerestory.compat.programs import PROGRAMS, install_programs
from clerestory.matrix.radiance_format import read_matrix

RADIANCE = Path(pyradiance.__file__).parent

# Results by script; of lines with pictures, or with programs of Radiance's Perl
# scripts, none is run
SCRIPTS = {
    "2PM_DDS.sh": ("results/dcDDS/annualR.ill", "results/dcDDS/cds/annualR.ill"),
    "3PM.sh": ("results/3ph/3phAnnual.ill",),
    "5PM.sh": ("results/5ph/3ph/3phAnnual.ill", "results/5ph/3phdir/3phAnnual.ill"),
}
OMITTED = re.compile(
    r"vwrays|rpict|pcomb|genskyvec|\.hdr|NYC_Per|^for |^do$|^done$|cds|solar|suns"
    r"|sunCoefficients|NYCsun|5Phannual"
)


@dataclass(frozen=True)
class Outcome:
    """Processor time of a script [s], and its results by file."""

    seconds: float
    values: dict[str, np.ndarray]


def lines_of(script: Path) -> str:
    """Return the commands of a script to run; pictures are left out of long ones."""
    text = re.sub(r"-n 16\b", "-n 1", script.read_text())
    if script.name == "2PM_DDS.sh":
        return text
    kept = [line for line in text.splitlines() if not OMITTED.search(line)]
    return "\n".join(kept)


def run(room: Path, script: str, shims: Path | None) -> Outcome:
    """Run a script in a copy of the room, with a folder of programs first in PATH."""
    path = f"{RADIANCE / 'bin'}:{os.environ['PATH']}"
    environment = {
        **os.environ,
        "PATH": path if shims is None else f"{shims}:{path}",
        "RAYPATH": f".:{RADIANCE / 'lib'}",
        "PYTHONPATH": str(Path(clerestory.__file__).parents[1]),
    }
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, "room")
        shutil.copytree(room, copy)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            ["bash", "-e", "-c", lines_of(room / "commands" / script)],
            cwd=copy, env=environment, check=True, capture_output=True,
        )  # fmt: skip
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        values = {name: read_matrix(copy / name).values for name in SCRIPTS[script]}
    return Outcome(used, values)


def row(script: str, ours: Outcome, theirs: Outcome) -> list[str]:
    """Return lines of the table: agreement of each result, and ratio of times."""
    found = []
    for name in SCRIPTS[script]:
        one, other = ours.values[name], theirs.values[name]
        lit = other > 0.02 * other.max()
        spread = np.std(one[lit] / other[lit] - 1)
        found.append(
            f"| {script} | `{name}` | {100 * (one.sum() / other.sum() - 1):+.2f} % |"
            f" {100 * spread:.1f} % | {theirs.seconds:.1f} | {ours.seconds:.1f} |"
            f" {theirs.seconds / ours.seconds:.1f} |"
        )
    return found


def main() -> None:
    """Run the scripts and print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("room", type=Path)
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    lines = []
    with tempfile.TemporaryDirectory() as shims:
        install_programs(shims, tuple(PROGRAMS))
        for script in SCRIPTS:
            ours, theirs = (
                run(given.room, script, folder) for folder in (Path(shims), None)
            )
            lines += row(script, ours, theirs)
            sys.stderr.write("\n".join(lines[-1:]) + "\n")
    day = datetime.datetime.now(tz=datetime.UTC).date()
    versions = (
        f"pyradiance {pyradiance.__version__}, clerestory {clerestory.__version__}"
    )
    head = f"""# Radiance's shell scripts

Scripts of LBNL's tutorial by Radiance and by `clerestory compat`
(`benchmarks/radiance_scripts.py`), unmodified but for `-n 1`. 2PM_DDS.sh runs whole; of
3PM.sh and 5PM.sh, the commands for 100 sensors: no pictures, no suns behind the BSDF.
Processor seconds include children and the start of Python, about 0.5 s a program.
The spread is the standard deviation of the ratio where values are above 2 % of the
largest; it contains the noise of both.

{day}, {platform.machine()}, {os.cpu_count()} cores, {versions}.

| script | result | sum | spread | Radiance [CPU s] | compat [CPU s] | ratio |
|---|---|---|---|---|---|---|
"""
    page = head + "\n".join(lines) + "\n"
    if given.write:
        given.write.write_text(page)
    else:
        sys.stdout.write(page)


if __name__ == "__main__":
    main()
