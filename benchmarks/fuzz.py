"""Page on damaged files: number of mutants that each reader read or refused.

    python benchmarks/fuzz.py --count 10000 -o docs/benchmarks/fuzz.md

runs the harness of the tests (`tests/fuzz`) for the readers that the state file lacks.
"""

import argparse
import json
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

_HARNESS = (sys.executable, str(Path(__file__).parents[1] / "tests/fuzz/harness.py"))

HEAD = """# Damaged files

Every reader of the package is given damaged files, made at random from sound ones:
changed bytes, words, numbers, lines and XML elements, and deep nesting
(`tests/fuzz/mutation.py`). A file is either refused by an error of one line and fewer
than 500 characters, or read. BSDFs that are read are evaluated, integrated and written;
pictures are evaluated for glare; results are prepared for a report. The checksums of
two formats are recomputed after the damage, so that the damaged data are read.

Not allowed, and counted as defects: other exceptions, a file that takes more than 5 s
of processor time, more than 1 GB of additional memory, longer messages.
"""


def measured(state: Path, count: int) -> list[dict]:
    """Return the outcomes of all readers; those in the state file are kept."""
    names = json.loads(subprocess.check_output([*_HARNESS, "--names"]))
    lines = state.read_text().splitlines() if state.exists() else []
    known = {outcome["reader"]: outcome for outcome in map(json.loads, lines)}
    missing = [name for name in names if name not in known]
    words = [*_HARNESS, *missing, "--count", str(count)]
    if missing:
        with state.open("a") as stream:
            subprocess.run(words, stdout=stream, check=True)
        return measured(state, count)
    return [known[name] for name in names]


def page(outcomes: list[dict]) -> str:
    """Return the page."""
    rows = [
        f"| {o['reader']} | {o['count']:,} | {o['count'] - o['loaded']:,} |"
        f" {o['loaded']:,} | {len(o['defects'])} | {o['slowest_s']:.2f} |"
        f" {o['memory_mb']:.0f} |"
        for o in outcomes
    ]
    total = sum(o["count"] for o in outcomes)
    spent = sum(o["cpu_s"] for o in outcomes) / 60
    return (
        f"{HEAD}\n{total:,} files for {len(outcomes)} readers; {spent:.0f} min of"
        " processor time. Made by `benchmarks/fuzz.py` on"
        f" {datetime.now(UTC):%d %B %Y}.\n\n"
        "| reader | files | refused | read | defects | longest [s] | memory [MB] |\n"
        "|---|---|---|---|---|---|---|\n" + "\n".join(rows) + "\n"
    )


def main() -> None:
    """Run what is missing and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--state", type=Path, default=Path("fuzz.jsonl"))
    parser.add_argument("-o", "--output", type=Path, required=True)
    options = parser.parse_args()
    outcomes = measured(options.state, options.count)
    options.output.write_text(page(outcomes), encoding="utf-8")
    for outcome in outcomes:
        print(outcome["reader"], *outcome["defects"], sep="\n  ")


if __name__ == "__main__":
    main()
