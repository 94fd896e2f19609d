"""Sky matrices of a year against gendaymtx: seconds and memory, in turns.

    python benchmarks/sky_matrix.py YEAR.epw [--runs 3] [--write FILE]

Each run is a process of its own, as a user starts it; "in Python" is the call alone.
Memory is the most that a process held. Both programs write float matrices.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from duel import ENVIRONMENT, stamp

# Prints seconds of the call and the most memory held [MB]
_CALL = """
import resource, sys, time
from clerestory.sky.read import read_weather
from clerestory.sky.sky_matrix import sky_matrix
weather = read_weather(sys.argv[1])
start = time.perf_counter()
sky_matrix(weather, subdivision=int(sys.argv[2]))
print(time.perf_counter() - start, end=" ")
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
"""


def timed(command: list[str]) -> tuple[float, float, str]:
    """Run a process: seconds, the most memory it held [MB], what it printed."""
    start = time.perf_counter()
    program = (
        "import resource, subprocess, sys;"
        "done = subprocess.run(sys.argv[1:], check=True, capture_output=True,"
        " text=True);"
        "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024);"
        "print(done.stdout)"
    )
    done = subprocess.run(
        [sys.executable, "-S", "-c", program, *command],
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        check=True,
    )
    seconds = time.perf_counter() - start
    memory, _, printed = done.stdout.partition("\n")
    return seconds, float(memory), printed.strip()


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
    found: dict[str, list[tuple[float, float]]] = {
        "gendaymtx": [],
        "clerestory sky matrix": [],
        "in Python": [],
    }
    for _ in range(runs):
        found["gendaymtx"].append(timed(shell)[:2])
        found["clerestory sky matrix"].append(timed(ours)[:2])
        seconds, memory = map(float, timed(call)[2].split())
        found["in Python"].append((seconds, memory))
    median = {name: np.median(values, axis=0) for name, values in found.items()}
    peer = median["gendaymtx"][0]
    return [
        f"| MF {m} | {name} | {seconds:.2f} | {peer / seconds:.1f} | {memory:.0f} |"
        for name, (seconds, memory) in median.items()
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
    lines += ["| | | seconds | times faster | memory [MB] |", "|---|---|---|---|---|"]
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
