"""Shell scripts of LBNL's tutorial by Radiance and by `clerestory compat`.

    python benchmarks/radiance_scripts.py ROOM [SCRIPT...] --write radiance-scripts.md

ROOM is the folder `room` of the tutorial's files, with its `commands`. The scripts run
whole and in their order in one folder, as some read what others wrote. Changed are the
size of pictures, from 400 × 400 to `--pixels`, since Radiance takes days of processor
time for all, and `-n`, to one process, so that processor time has no waiting. Radiance
runs each script twice, with 17 % more rays (-ad, -c) the second time: the difference is
its noise.
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
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyradiance

import clerestory
from clerestory.compat.programs import PROGRAMS, install_programs
from clerestory.errors import ClerestoryError
from clerestory.image.picture_files import read_picture
from clerestory.matrix.radiance_format import read_matrix

RADIANCE = Path(pyradiance.__file__).parent

# In the order of the tutorial: later ones read matrices and skies of earlier ones
SCRIPTS = (
    "2PM_DDS.sh",
    "2PM_DayCoeff.sh",
    "3PM.sh",
    "3PM_Param.sh",
    "3PM_East.sh",
    "4PM_FmtxF1.sh",
    "4PM_ParamF1.sh",
    "4PM_FmtxFH.sh",
    "5PM.sh",
    "6PM_FMatrixFH.sh",
)


@dataclass(frozen=True)
class Outcome:
    """Processor time of a script [s], its results by name, and what it reported.

    Results are matrices of sensors, and all pictures of one name but for its number.
    """

    seconds: float
    sensors: dict[str, np.ndarray]
    pictures: dict[str, np.ndarray]
    messages: str


def lines_of(script: Path, *, pixels: int, more: float) -> str:
    """Return a script with small pictures and one process, and rays times `more`."""
    text = re.sub(r"-n 16\b", "-n 1", script.read_text())
    text = re.sub(r"-x (\d+) -y \1\b", f"-x {pixels} -y {pixels}", text)
    return re.sub(
        r"-(ad|c) (\d{3,})\b",
        lambda found: f"-{found[1]} {round(more * int(found[2]))}",
        text,
    )


class Room:
    """A copy of the tutorial's folder, in which scripts run one after the other."""

    def __init__(
        self, source: Path, folder: Path, path: str, *, pixels: int, more: float = 1
    ) -> None:
        """Copy the folder; `path` is PATH of the scripts."""
        self.folder, self.pixels, self.more = folder, pixels, more
        shutil.copytree(source, folder)
        self.environment = {
            **os.environ,
            "PATH": path,
            "RAYPATH": f".:{RADIANCE / 'lib'}",
            "PYTHONPATH": str(Path(clerestory.__file__).parents[1]),
        }

    def run(self, script: str) -> Outcome:
        """Run a script; its results are the files that it writes to `results`."""
        known = {path: path.stat().st_mtime_ns for path in self._files()}
        text = lines_of(
            self.folder / "commands" / script, pixels=self.pixels, more=self.more
        )
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(
            ["bash", "-c", text], cwd=self.folder, env=self.environment, check=False,
            stdin=subprocess.DEVNULL, capture_output=True, text=True,
        )  # fmt: skip
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        new = [p for p in self._files() if p.stat().st_mtime_ns != known.get(p)]
        return Outcome(used, *self._read(new), done.stderr)

    def _files(self) -> Iterator[Path]:
        yield from sorted(self.folder.glob("results/**/*.ill"))
        yield from sorted(self.folder.glob("results/**/*.hdr"))

    def _read(
        self, paths: list[Path]
    ) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        sensors, pictures = {}, defaultdict(list)
        for path in paths:
            name = str(path.relative_to(self.folder / "results"))
            try:
                if path.suffix == ".ill":
                    sensors[name] = read_matrix(path).values.ravel()
                else:
                    label = re.sub(r"\d{4}\.hdr$", "%04d.hdr", name)
                    pictures[label].append(read_picture(path).radiance)
            except ClerestoryError:
                # Scripts also loop over numbers that have no picture
                continue
        stacks = {name: np.array(found).ravel() for name, found in pictures.items()}
        return sensors, stacks


def rows(script: str, ours: Outcome, one: Outcome, two: Outcome) -> list[str]:
    """Return lines of the table: agreement of sensors and of pictures, and times."""
    found = []
    for kind in ("sensors", "pictures"):
        sets = [getattr(each, kind) for each in (ours, one, two)]
        missing = set(sets[1]) ^ set(sets[0])
        if missing:
            sys.stderr.write(f"{script}: only of one: {sorted(missing)}\n")
        names = sorted(set(sets[0]) & set(sets[1]) & set(sets[2]))
        if not names:
            continue
        sums, apart, noise = [], [], []
        for name in names:
            own, first, second = (np.asarray(each[name], float) for each in sets)
            theirs = (first + second) / 2
            level = np.sqrt(np.mean(theirs**2))
            sums.append(own.sum() / theirs.sum() - 1)
            apart.append(np.sqrt(np.mean((own - theirs) ** 2)) / level)
            noise.append(np.sqrt(np.mean((first - second) ** 2)) / level)
            sys.stderr.write(
                f"  {script} {name} {own.size} {100 * sums[-1]:+.2f} %"
                f" {100 * apart[-1]:.2f} % {100 * noise[-1]:.2f} %\n"
            )
        worst = int(np.argmax(np.array(apart) / np.maximum(noise, 1e-6)))
        largest = max(sums, key=abs)
        found.append(
            f"| {script} | {kind}: {len(names)} | {100 * largest:+.2f} % |"
            f" {100 * np.median(apart):.1f} %, {100 * np.median(noise):.1f} % |"
            f" `{names[worst]}`: {100 * apart[worst]:.1f} %, {100 * noise[worst]:.1f} %"
            f" | {one.seconds:.0f} | {ours.seconds:.0f} |"
            f" {one.seconds / ours.seconds:.1f} |"
        )
    return found


def table(given: argparse.Namespace, folder: Path) -> list[str]:
    """Run the scripts by both, and return the rows of the table."""
    own, rest = folder / "own", folder / "rest"
    install_programs(own, tuple(PROGRAMS))
    # A Perl script of Radiance that pyradiance lacks
    install_programs(rest, ("genskyvec",))
    path = f"{RADIANCE / 'bin'}:{os.environ['PATH']}"
    make = {
        "ours": (f"{own}:{path}", 1.0),
        "one": (f"{rest}:{path}", 1.0),
        "two": (f"{rest}:{path}", 1.17),
    }
    rooms = {
        name: Room(given.room, folder / name, first, pixels=given.pixels, more=more)
        for name, (first, more) in make.items()
    }
    lines = []
    for script in given.scripts:
        ours, one, two = (room.run(script) for room in rooms.values())
        for each in (ours, one):
            text = [m for m in each.messages.splitlines() if "expected" in m]
            sys.stderr.write("".join(f"  {script}: {m}\n" for m in text[:3]))
        lines += rows(script, ours, one, two)
        sys.stderr.write("\n".join(lines[-2:]) + "\n")
    return lines


def main() -> None:
    """Run the scripts and print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("room", type=Path)
    parser.add_argument("scripts", nargs="*", default=SCRIPTS)
    parser.add_argument("--pixels", type=int, default=16)
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        lines = table(given, Path(folder))
    day = datetime.datetime.now(tz=datetime.UTC).date()
    versions = (
        f"pyradiance {pyradiance.__version__}, clerestory {clerestory.__version__}"
    )
    columns = (
        "script", "results", "sum", "deviation, noise", "worst", "Radiance [CPU s]",
        "compat [CPU s]", "ratio",
    )  # fmt: skip
    head = f"""# Radiance's shell scripts

Scripts of LBNL's tutorial by Radiance and by `clerestory compat`
(`benchmarks/radiance_scripts.py`). They run whole; changed are the size of pictures,
to {given.pixels} × {given.pixels}, and `-n`, to one process. Radiance runs each twice,
the second time with 17 % more rays. Of all results of a script, matrices of 100 sensors
and pictures by name: the largest deviation of the sum; the median of the root mean
square deviations of ours from the mean of both runs of Radiance, and of these from each
other; the result with the largest ratio of the two. Deviations are relative to the root
mean square of the result. Processor seconds include children and the start of Python,
about 0.5 s a program.

{day}, {platform.machine()}, {os.cpu_count()} cores, {versions}.

| {" | ".join(columns)} |
{"|---" * len(columns)}|
"""
    page = head + "\n".join(lines) + "\n"
    if given.write:
        given.write.write_text(page)
    else:
        sys.stdout.write(page)


if __name__ == "__main__":
    main()
