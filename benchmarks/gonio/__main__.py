"""Measurements to BSDFs: known truths, held-out scans, and Radiance on the same files.

    python benchmarks/gonio truth
    python benchmarks/gonio scans
    python benchmarks/gonio radiance --data ../shared/data/gonio
    python benchmarks/gonio smoothing --data ../shared/data/gonio

Each writes its page of docs/benchmarks and its figures of docs/gonio.md.
"""

import argparse
import importlib
import sys
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
sys.path.insert(0, str(REPOSITORY / "tests"))

from clerestory.engine import device  # noqa: E402


def main():
    """Write one page."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("part", choices=("truth", "scans", "radiance", "smoothing"))
    parser.add_argument("--data", type=Path, help="Folder of the measured data sets.")
    wanted = parser.parse_args()
    device.load("cpu", "sample_area")
    written = []
    for line in importlib.import_module(wanted.part).lines(wanted.data):
        print(line, flush=True)
        written.append(line)
    page = REPOSITORY / "docs" / "benchmarks" / f"gonio-{wanted.part}.md"
    page.write_text("\n".join(written) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
