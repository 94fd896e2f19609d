"""Table of test coverage: for each package, the share of its statements that ran.

    scripts/test --cov=clerestory --cov-report=
    python scripts/coverage_table.py

reads `.coverage` in the current folder. Statements of GPU kernels count as run when
they were compiled; what runs in other processes does not count.
"""

import json
import sys
import tempfile
from collections import Counter
from pathlib import Path

import coverage

import clerestory

ROOT = Path(clerestory.__file__).resolve().parent


def counts() -> tuple[Counter[str], Counter[str]]:
    """Return the statements of each package, and those of them that ran."""
    measured = coverage.Coverage()
    measured.load()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "coverage.json"
        measured.json_report(outfile=str(file), ignore_errors=True)
        files = json.loads(file.read_text("utf-8"))["files"]
    statements: Counter[str] = Counter()
    ran: Counter[str] = Counter()
    for name, found in files.items():
        parts = Path(name).resolve().relative_to(ROOT).parts
        package = parts[0] if len(parts) > 1 else "clerestory"
        statements[package] += found["summary"]["num_statements"]
        ran[package] += found["summary"]["covered_lines"]
    return statements, ran


def main() -> None:
    """Print the table, the total last."""
    statements, ran = counts()
    rows = [(name, ran[name], statements[name]) for name in sorted(statements)]
    rows.append(("all", ran.total(), statements.total()))
    sys.stdout.write(f"{'coverage by tests':20} {'statements':>10} {'ran':>6}\n")
    for name, some, every in rows:
        sys.stdout.write(f"{name:20} {every:10} {100 * some / every:5.1f}%\n")


if __name__ == "__main__":
    main()
