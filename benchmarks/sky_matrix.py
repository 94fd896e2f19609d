"""Sky matrices of a year against gendaymtx: time and memory, in turns.

    python benchmarks/sky_matrix.py YEAR.epw [--runs 3] [--write FILE]

Each run is a process of its own, as a user starts it; "in Python" is the call alone.
Processor seconds are those of the user and of the system, over all cores; memory is
the most that a process held. Both programs write float matrices of three channels.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from duel import ENVIRONMENT, stamp

# Prints processor seconds, seconds and the most memory [MB] of the call
_CALL = """
import resource, sys, time
from clerestory.sky.weather_formats import read_weather
from clerestory.sky.sky_matrix import sky_matrix
weather = read_weather(sys.argv[1])
cpu, start = time.process_time(), time.perf_counter()
sky_matrix(weather, subdivision=int(sys.argv[2]))
print(time.process_time() - cpu, time.perf_counter() - start, end=" ")
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
"""

# Prints the same of a child process, and what it prints itself
_CHILD = """
import resource, subprocess, sys, time
start = time.perf_counter()
done = subprocess.run(sys.argv[1:], check=True, capture_output=True, text=True)
wall = time.perf_counter() - start
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime, wall, used.ru_maxrss / 1024)
print(done.stdout)
"""


def timed(command: list[str]) -> tuple[list[float], str]:
    """Run a process: processor seconds, seconds, memory [MB], and what it printed."""
    done = subprocess.run(
        [sys.executable, "-S", "-c", _CHILD, *command],
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        check=True,
    )
    figures, _, printed = done.stdout.partition("\n")
    return [float(word) for word in figures.split()], printed.strip()


def rows(epw: Path, subdivision: int, runs: int, folder: Path) -> list[str]:
    """Return the lines of the table for one fineness."""
    wea, out = folder / "year.wea", str(folder / "S.smx")
    m = str(subdivision)
    shell = ["sh", "-c", f"gendaymtx -of -m {m} {wea} > {out}"]
    ours = [
        sys.executable,
        "-c",
        "from clerestory.cli.main import main; raise SystemExit(main())",
        *("sky", "matrix", str(epw), "--subdivision", m, "-o", out, "-q"),
    ]
    call = [sys.executable, "-c", _CALL, str(epw), m]
    found: dict[str, list[list[float]]] = {
        "gendaymtx": [],
        "clerestory sky matrix": [],
        "in Python": [],
    }
    for _ in range(runs):
        found["gendaymtx"].append(timed(shell)[0])
        found["clerestory sky matrix"].append(timed(ours)[0])
        found["in Python"].append([float(word) for word in timed(call)[1].split()])
    median = {name: np.median(values, axis=0) for name, values in found.items()}
    peer = median["gendaymtx"]
    return [
        f"| MF {m} | {name} | {cpu:.2f} | {peer[0] / cpu:.1f} | {wall:.2f}"
        f" | {peer[1] / wall:.1f} | {memory:.0f} |"
        for name, (cpu, wall, memory) in median.items()
    ]


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("epw", type=Path)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--subdivisions", type=int, nargs="+", default=[1, 4, 6])
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    lines = ["### Sky matrix of a year", ""]
    lines += [f"{stamp()}; medians of {options.runs} runs in turns.", ""]
    lines += [
        "| | | processor [s] | times less | passed [s] | times faster | memory [MB] |",
        "|---|---|---|---|---|---|---|",
    ]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        wea = str(folder / "year.wea")
        subprocess.run(
            ["epw2wea", str(options.epw), wea],
            env=ENVIRONMENT,
            capture_output=True,
            check=True,
        )
        for subdivision in options.subdivisions:
            lines += rows(options.epw, subdivision, options.runs, folder)
    print("\n".join(lines))
    if options.write:
        options.write.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
