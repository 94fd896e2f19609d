"""Shell scripts of LBNL's tutorial by Radiance and by `clerestory compat`.

    python benchmarks/radiance_scripts.py ROOM [SCRIPT...] --folder FOLDER --write FILE

ROOM is the folder `docs/assets/sample_files/room` of LBNL-ETA/pyradiance, with its
`commands`; the tree `blinds/blindsT4c.xml` is generated if it is not there. The scripts
run whole and in their order in one folder, as some read what others wrote. FOLDER keeps
the results: a script that has run in it does not run again.

The first run of ours is of the scripts as they are. `vwrays` and `rpict` of Radiance,
used by both, make pictures of `--pixels` in place of 400 × 400, by a script before them
in PATH, since Radiance takes days of processor time for all. Radiance runs with `-n 1`,
so that processor time has no waiting. The second run of each has 17 % more rays (-ad,
-c): the differences of the two runs are the noise, and the times are theirs. Only the
first run of ours makes the pictures of each of 5,185 suns.
"""

import argparse
import os
import sys
from pathlib import Path

import numpy as np
from duel import stamp
from script_runs import RADIANCE, Outcome, Room

from clerestory.compat.programs import PROGRAMS, install_programs

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "parity"))

from tutorial_pair import write_tree

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

# Standard error of results without random samples, at most [%]
NOISELESS = 0.01

# Rays of the first and of the second run
RAYS = (1.0, 1.17)

# Programs that make pictures, with the size in the scripts
SIZED, SIZE = ("vwrays", "rpict"), 400


def rooms(source: Path, folder: Path, pixels: int) -> list[list[Room]]:
    """Return the folders of both runs of ours and of Radiance."""
    folder.mkdir(parents=True, exist_ok=True)
    tree = source / "blinds" / "blindsT4c.xml"
    if not tree.exists():
        write_tree(source, tree)
    small, own, rest = (folder / name for name in ("small", "own", "rest"))
    small.mkdir(exist_ok=True)
    for name in SIZED:
        program = RADIANCE / "bin" / name
        (small / name).write_text(
            '#!/bin/sh\nfor word do\n  shift\n'
            f'  [ "$word" = {SIZE} ] && word={pixels}\n  set -- "$@" "$word"\n'
            f'done\nexec {program} "$@"\n'
        )  # fmt: skip
        (small / name).chmod(0o755)
    install_programs(own, tuple(PROGRAMS))
    # A Perl script of Radiance that pyradiance lacks
    install_programs(rest, ("genskyvec",))
    path = f"{small}:{RADIANCE / 'bin'}:{os.environ['PATH']}"
    found = []
    for name, first in (("ours", own), ("radiance", rest)):
        found.append([
            Room(
                source, folder / f"{name}-{rays}", f"{first}:{path}", rays,
                one_process=first == rest, sun_pictures=first == own and rays == 1,
            )
            for rays in RAYS
        ])  # fmt: skip
    return found


def refusals(outcome: Outcome) -> list[str]:
    """Return the error lines of programs of ours."""
    starts = tuple(f"{name}: " for name in PROGRAMS)
    lines = outcome.messages.splitlines()
    return [line for line in lines if line.startswith((*starts, "Traceback", "error"))]


def rms(values: np.ndarray) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def rows(script: str, ours: list[Outcome], theirs: list[Outcome]) -> list[str]:
    """Return lines of the table: agreement of sensors and of pictures, and times."""
    found = []
    refused = refusals(ours[0])
    times = (
        f"{ours[0].seconds:.0f} | {ours[1].seconds:.0f} | {theirs[1].seconds:.0f} |"
        f" {theirs[1].seconds / ours[1].seconds:.1f}"
    )
    start = f"{script} | {f'no: `{refused[0]}`' if refused else 'yes'}"
    for kind in ("sensors", "pictures"):
        sets = [getattr(each, kind) for each in (*ours, *theirs)]
        missing = set(sets[0]) ^ set(sets[2])
        if missing:
            sys.stderr.write(f"{script}: only of one: {sorted(missing)}\n")
        names = sorted(set.intersection(*(set(each) for each in sets)))
        if not names:
            continue
        sums, levels, noises, clear = [], [], [], []
        for name in names:
            a, b, c, d = (np.asarray(each[name], float) for each in sets)
            own, other = (a + b) / 2, (c + d) / 2
            level = rms(other)
            sums.append(100 * (own.sum() / other.sum() - 1))
            levels.append(100 * rms(own - other) / level)
            # Standard errors of one run of ours and of Radiance
            noises.append(100 * np.array([rms(a - b), rms(c - d)]) / level / np.sqrt(2))
            sys.stderr.write(
                f"  {script} {name} {own.size}: sum {sums[-1]:+.2f} %, deviation"
                f" {levels[-1]:.2f} %, noise {noises[-1].round(2)} %\n"
            )
            if max(noises[-1]) < NOISELESS:
                clear.append(f"; no noise, {levels[-1]:.2f} %: `{name}`")
        joint = np.linalg.norm(noises, axis=1) / np.sqrt(2)
        noisy = joint >= NOISELESS
        ratios = np.where(noisy, np.array(levels) / np.maximum(joint, NOISELESS), 0)
        worst = int(np.argmax(ratios))
        own, other = np.median(np.array(noises)[noisy], axis=0)
        found.append(
            f"| {start} | {kind}: {len(names)} | {max(sums, key=abs):+.2f} % |"
            f" {np.median(np.array(levels)[noisy]):.2f} % |"
            f" {own:.2f} %, {other:.2f} % |"
            f" {np.median(ratios[noisy]):.1f} | {ratios[worst]:.1f}: `{names[worst]}`"
            f"{''.join(clear)} | {times} |"
        )
        start, times = " | ", " | | | "
    return found or [f"| {start} | none | | | | | | {times} |"]


def table(given: argparse.Namespace) -> list[str]:
    """Run the scripts by both, and return the rows of the table."""
    own, rest = rooms(given.room, given.folder, given.pixels)
    lines = []
    for script in given.scripts:
        ours = [room.outcome(script) for room in own]
        for line in refusals(ours[0])[:5]:
            sys.stderr.write(f"  {script}: {line}\n")
        lines += rows(script, ours, [room.outcome(script) for room in rest])
    return lines


def main() -> None:
    """Run the scripts and print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("room", type=Path)
    parser.add_argument("scripts", nargs="*", default=SCRIPTS)
    parser.add_argument("--pixels", type=int, default=16)
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    given.room, given.folder = given.room.resolve(), given.folder.resolve()
    lines = table(given)
    columns = (
        "script", "ran unmodified", "results", "sum", "deviation",
        "noise: ours, Radiance", "deviation / noise", "largest",
        "unmodified [CPU s]", "compat [CPU s]", "Radiance [CPU s]", "times faster",
    )  # fmt: skip
    head = f"""# Radiance's shell scripts

Scripts of LBNL's tutorial by Radiance and by `clerestory compat`
(`benchmarks/radiance_scripts.py`). First, `clerestory compat` runs each as published.
For the comparison, both run each with {100 * RAYS[1] - 100:.0f} % more rays (`-ad`,
`-c`), Radiance with `-n 1`, and Radiance once more with the rays of the script. These
runs leave out the pictures of each of 5,185 suns in 5PM.sh and 6PM_FMatrixFH.sh, and
results that need them are not compared. `vwrays` and `rpict`, Radiance's for both, make
pictures of {given.pixels} columns in place of {SIZE}, which costs Radiance days. The
tree of the blind, which the stored tutorial lacks, is generated by clerestory from the
tutorial's blind, and used by both.

*Deviation* is the root mean square of the difference between ours and Radiance, of the
means of both runs, over all values of a result: 100 sensors at one time or at 40, or
the pixels of all pictures of one name. *Noise* is the standard error of one run, from
the difference of the two. All are relative to the root mean square of the result, and
medians over the results of a script. *Deviation / noise* is the deviation over its
joint standard error: 1 is noise alone. With two runs of each, in which all sensors
share one daylight matrix, it varies by about a factor of two. Results without random
samples have their deviation only. *Sum* is the largest deviation of a result's sum.

Processor seconds have children and the start of Python, about 0.5 s a program, on a
machine with other work. *Unmodified* is our run of the script as published; the ratio
is of the two runs with more rays, which do the same work.

{stamp()}.

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
