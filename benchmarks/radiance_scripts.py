"""Shell scripts of LBNL's tutorial by Radiance and by `clerestory compat`.

    python benchmarks/radiance_scripts.py ROOM [SCRIPT...] --folder FOLDER --write FILE
        [--ours SCRIPT...]

ROOM is the folder `docs/assets/sample_files/room` of LBNL-ETA/pyradiance, with its
`commands`; the tree `blinds/blindsT4c.xml` is generated if it is not there. The scripts
run whole and in their order in one folder, as some read what others wrote. FOLDER keeps
the results: a script that has run in it does not run again. Of the scripts of `--ours`,
all but the first run of ours are left out.

The first run of ours is of the scripts as they are. `vwrays` and `rpict` of Radiance,
used by both, make pictures of `--pixels` columns, by a script before them in PATH,
since Radiance takes days of processor time for all. Radiance runs with `-n 1`, so that
processor time has no waiting. Further runs of each have more rays (-ad, -c): the
differences of the runs are the noise. rfluxmtx takes the same rays from a window in
every run, and our programs take equal random numbers, unless the number of rays
changes. Only the first run of ours makes the pictures of each of 5,185 suns.
"""

import argparse
import os
import re
import sys
import textwrap
from pathlib import Path

import numpy as np
from duel import stamp
from scipy.stats import t as student
from script_runs import RADIANCE, Outcome, Room, numbered

from clerestory.compat.programs import PROGRAMS, install_programs

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "parity"))

from tutorial_pair import write_tree

# In the order of the tutorial: later ones read matrices and skies of earlier ones
SCRIPTS = (
    "2PM_DayCoeff.sh",
    "2PM_Sky.sh",
    "2PM_Views.sh",
    "2PM_Disc.sh",
    "2PM_DDS.sh",
    "3PM.sh",
    "3PM_Param.sh",
    "3PM_East.sh",
    "3PM_NonCop.sh",
    "3PM_VarShad.sh",
    "4PM_FmtxF1.sh",
    "4PM_ParamF1.sh",
    "4PM_FmtxFH.sh",
    "4PM_FmtxFN.sh",
    "4PM_VarShadF1.sh",
    "5PM.sh",
    "6PM_FMatrixFH.sh",
)

# Standard error of results without random samples, at most [%]
NOISELESS = 0.01

# Rays of each run
RAYS = (1.0, 1.06, 1.12)

# Quantile of noise in units of the standard error by the spread of the runs, two-sided
SHARE = 0.05
QUANTILE = student.ppf(1 - SHARE / 2, 2 * len(RAYS) - 2)

# Programs that make pictures, with their sizes in the scripts
SIZED, SIZES = ("vwrays", "rpict"), (250, 300, 400)


def rooms(source: Path, folder: Path, pixels: int) -> list[list[Room]]:
    """Return the folders of all runs of ours and of Radiance."""
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
            f'  case "$word" in {"|".join(map(str, SIZES))}) word={pixels};; esac\n'
            '  set -- "$@" "$word"\n'
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


def ran(script: Path, outcome: Outcome) -> str:
    """Return whether a script of ours made all results that it names, or the error."""
    named = re.findall(
        # falsecolor is a Perl script, which pyradiance lacks
        r"^(?!falsecolor)[^#\n]*(?:> *|dctimestep .*-o )results/(\S+\.(?:ill|hdr))",
        script.read_text(),
        re.MULTILINE,
    )
    whole = (name.replace("${idx}", "%04d") for name in named)
    expected = {numbered(name) for name in whole}
    results = outcome.sensors | outcome.pictures
    made = {name for name in expected if name in results and results[name].size}
    if made == expected:
        return f"yes, {len(made)} results"
    lines = outcome.messages.splitlines()
    error = next((line for line in lines if "expected" in line), "")
    return f"no, {len(made)} of {len(expected)} results: `{error}`"


def rms(values: np.ndarray) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def noise(runs: np.ndarray) -> float:
    """Return the standard error of one of several runs (run, value)."""
    return float(np.sqrt(np.mean(runs.var(axis=0, ddof=1))))


def sum_deviation(ours: np.ndarray, theirs: np.ndarray) -> tuple[float, float]:
    """Return the deviation of the sum, and its standard error by the spread [%]."""
    one, two = ours.mean(axis=1), theirs.mean(axis=1)
    error = np.sqrt((one.var(ddof=1) + two.var(ddof=1)) / len(one)) / two.mean()
    return 100 * (one.mean() / two.mean() - 1), 100 * error


def rows(
    start: str, ours: list[Outcome], theirs: list[Outcome]
) -> tuple[list[str], list[float]]:
    """Return lines of the table: agreement of sensors and of pictures, and times.

    Also return the deviations of sums with random samples over their standard errors.
    """
    found = []
    every: list[float] = []
    own, other = (np.mean([r.seconds for r in runs[1:]]) for runs in (ours, theirs))
    times = f"{ours[0].seconds:.0f} | {own:.0f} | {other:.0f} | {other / own:.1f}"
    for kind in ("sensors", "pictures"):
        sets = [getattr(each, kind) for each in (*ours, *theirs)]
        missing = set(sets[1]) ^ set(sets[-1])
        if missing:
            sys.stderr.write(f"{start}: only of one: {sorted(missing)}\n")
        # Programs leave empty pictures where an input is missing
        filled = ({name for name in each if each[name].size} for each in sets)
        names = sorted(set.intersection(*filled))
        if not names:
            continue
        sums, levels, noises, expected, clear = [], [], [], [], []
        for name in names:
            both = (np.array([r[name] for r in runs], float) for runs in (
                sets[: len(ours)], sets[len(ours) :]
            ))  # fmt: skip
            one, two = both
            level = rms(two.mean(axis=0)) / 100
            sums.append(sum_deviation(one, two))
            levels.append(rms(one.mean(axis=0) - two.mean(axis=0)) / level)
            noises.append(np.array([noise(one), noise(two)]) / level)
            expected.append(float(np.linalg.norm(noises[-1]) / np.sqrt(len(ours))))
            sys.stderr.write(
                f"  {name} {one.shape[1]}: sum {sums[-1][0]:+.2f} % ±"
                f" {sums[-1][1]:.2f} %, deviation"
                f" {levels[-1]:.2f} % of {expected[-1]:.2f} %, noise"
                f" {noises[-1].round(2)} %\n"
            )
            if expected[-1] < NOISELESS:
                clear.append(f"; no noise, {levels[-1]:.2f} %: `{name}`")
        joint = np.array(expected)
        noisy = joint >= NOISELESS
        ratios = np.where(noisy, np.array(levels) / np.maximum(joint, NOISELESS), 0)
        worst = int(np.argmax(ratios))
        every += [abs(s / e) for (s, e), has in zip(sums, noisy, strict=True) if has]
        total, error = max(sums, key=lambda pair: abs(pair[0]))
        own, other = np.median(np.array(noises)[noisy], axis=0)
        found.append(
            f"| {start} | {kind}: {len(names)} | {total:+.2f} % ± {error:.2f} % |"
            f" {np.median(np.array(levels)[noisy]):.2f} % |"
            f" {own:.2f} %, {other:.2f} % |"
            f" {np.median(ratios[noisy]):.1f} | {ratios[worst]:.1f}: `{names[worst]}`"
            f"{''.join(clear)} | {times} |"
        )
        start, times = " | ", " | | | "
    return found, every


def table(given: argparse.Namespace) -> tuple[list[str], str]:
    """Run the scripts by both, and return the rows of the table, and notes on them."""
    mine, rest = rooms(given.room, given.folder, given.pixels)
    lines, sums = [], []
    codes: dict[str, list[str]] = {}
    for script in given.scripts:
        compared = script not in given.ours
        ours = [room.outcome(script) for room in (mine if compared else mine[:1])]
        first = ours[0]
        start = f"{script} | {ran(given.room / 'commands' / script, first)}"
        for code in sorted({each.code for each in ours}):
            codes.setdefault(code, []).append(script)
        if not compared:
            cells = f"not compared | | | | | | {first.seconds:.0f} | | | |"
            lines.append(f"| {start} | {cells}")
            continue
        added, own = rows(start, ours, [room.outcome(script) for room in rest])
        lines += added
        sums += own
    beyond = sum(each > QUANTILE for each in sums)
    counted = (
        f"Of {len(sums)} results with random samples, the sum of {beyond} deviates by"
        f" more than {QUANTILE:.1f} standard errors."
    )
    return lines, f"{counted} {versions(codes)}"


def versions(codes: dict[str, list[str]]) -> str:
    """Return a sentence on the version of clerestory that ran each script."""
    if len(codes) == 1:
        return f"All our runs are of the sources of commit {next(iter(codes))}."
    parts = (f"{code}: {', '.join(names)}" for code, names in codes.items())
    return f"Commits of our sources by script: {'; '.join(parts)}."


def main() -> None:
    """Run the scripts and print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("room", type=Path)
    parser.add_argument("scripts", nargs="*", default=SCRIPTS)
    parser.add_argument("--pixels", type=int, default=16)
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--ours", nargs="*", default=(), help="scripts not to compare")
    parser.add_argument("--note", default="", help="sentence below the table")
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    given.room, given.folder = given.room.resolve(), given.folder.resolve()
    lines, notes = table(given)
    columns = (
        "script", "ran unmodified", "results", "sum", "deviation",
        "noise: ours, Radiance", "deviation / noise", "largest",
        "unmodified [CPU s]", "compat [CPU s]", "Radiance [CPU s]", "times faster",
    )  # fmt: skip
    head = f"""# Radiance's shell scripts

Scripts of LBNL's tutorial by Radiance and by `clerestory compat`
(`benchmarks/radiance_scripts.py`). First, `clerestory compat` runs each as published.
For the comparison, each program runs a script {len(RAYS)} times: as published, and with
{100 * RAYS[1] - 100:.0f} to {100 * RAYS[-1] - 100:.0f} % more rays (`-ad`, `-c`), so
that all random numbers differ; Radiance with `-n 1`. The runs but the first of ours
leave out the pictures of each of 5,185 suns in 5PM.sh and 6PM_FMatrixFH.sh, and results
that need them are not compared. `vwrays` and `rpict`, Radiance's for both, make
pictures of {given.pixels} columns in place of {SIZES[0]} to {SIZES[-1]}, which costs
Radiance days. The tree of the blind, which the stored tutorial lacks, is generated by
clerestory from the tutorial's blind, and used by both. `falsecolor`, a Perl script that
pyradiance lacks, is missing for both. *Not compared*: only our run as published was
made, to limit processor time.

*Deviation* is the root mean square of the difference between ours and Radiance, of the
means of all runs, over all values of a result: 100 sensors at one time or at 40, or
the pixels of all pictures of one name. *Noise* is the standard error of one run, from
the spread of the runs. All are relative to the root mean square of the result, and
medians over the results of a script. *Deviation / noise* is the deviation over its
standard error by the noise of both: 1 is noise alone. Where all values share one
daylight matrix, it may be 2 by chance. Results without random samples have their
deviation only. *Sum* is the largest deviation of the sum of a result, with its standard
error by the spread of the runs: with {len(RAYS)} runs of each, noise alone exceeds
{QUANTILE:.1f} times that in {100 * SHARE:.0f} % of all results. The
rays of pixels, of `vwrays`, are the same in all runs.

Processor seconds have children and the start of Python, about 0.5 s a program, on a
machine with other work. *Unmodified* is our run of the script as published; the others
are means of the runs with more rays, which do the same work. For pictures of so
few pixels, most of our time is the start of programs.

{stamp()}.

| {" | ".join(columns)} |
{"|---" * len(columns)}|
"""
    page = head + "\n".join(lines) + "\n\n"
    page += textwrap.fill(f"{notes} {given.note}".strip(), 88) + "\n"
    if given.write:
        given.write.write_text(page)
    else:
        sys.stdout.write(page)


if __name__ == "__main__":
    main()
