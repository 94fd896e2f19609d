"""A measured room through the command line: docs/validation/measured-room.md.

    python benchmarks/measured_room.py CHECKOUT [--theirs FOLDER] [--write]

CHECKOUT is a copy of github.com/AltamarMx/radiance_nelier_simsv0p2. FOLDER holds the
tables comparison_26jun.csv and comparison_20nov.csv of its authors' Radiance runs
(edificio/results of radiance_nelier_sims).
"""

import argparse
import csv
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from duel import stamp

from clerestory.metrics.agreement import Agreement, agreement

ROOT = Path(__file__).parents[1]
STUDY = ROOT / "studies" / "measured_classroom"
PAGE = ROOT / "docs" / "validation" / "measured-room.md"
ABOVE = 10.0
DAYS = {"06-26": "26 June", "11-20": "20 November"}

_TEXT = """# A measured room

A classroom of 7.9 m × 9.6 m in Temixco, Mexico (18.85° N), with windows along its north
and its south side and a gallery before the south. Its users measured 63 illuminances at
0.75 m once an hour on 26 June and 20 November 2024, and the irradiance outdoors
([their repository](https://github.com/AltamarMx/radiance_nelier_simsv0p2)). Raw files
in, two commands, no code: `studies/measured_classroom` holds the study and the mapping
of columns to sensors. Made by `benchmarks/measured_room.py`.

{stamp}

| | values | bias | CV(RMSE) | correlation | Δ < 5 % | Δ < 10 % | Δ < 20 % |
|---|---|---|---|---|---|---|---|
{rows}

![Measured and simulated illuminance](measured-room-scatter.png)

![Measured and simulated maps of six scans](measured-room-maps.png)

Notes:

- The agreement is poor; the knowledge of the room limits it, for Radiance as well.
  Materials are those that the authors measured: glass of transmissivity 0.88, floor
  reflectance 0.30, gallery 0.36. Nothing is calibrated here; see
  [the calibrated room](measured-room-calibrated.md). With these values their own
  Radiance runs are too bright as well; to match the measurements, they reduce the
  transmissivity of the glass to 0.70 to 0.80 and the reflectance of the floors. The
  corners beside the windows are darker than in the model, whose windows may extend too
  far. Dirt, trees, and the people who carried the sensors are not modelled.
- The weather is an hourly file made from a station's measurement; a scan takes minutes,
  and clouds pass within the hour. The simulation is interpolated between the middles of
  two hours; the authors take the hour that ends with the scan. `compare` finds no shift
  of the scans' clock that improves the agreement.
- The direct sun of an hour is spread over patches of Reinhart's MF 6 (two phases).
- Two descriptions of the scans disagree on the end of the room to which the first row
  of a file belongs. The study follows *from the front (east)*, in a scene with +x to
  the east. Read from the other end, CV(RMSE) is {other} %.
- Values of {above:g} lux and less do not count ({dark}).
"""


def main() -> None:
    """Run the study, compare, and print or write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkout", type=Path)
    parser.add_argument("--theirs", type=Path)
    parser.add_argument("--write", action="store_true")
    words = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in STUDY.iterdir():
            shutil.copy(file, folder / file.name)
        shutil.copytree(words.checkout, folder / "nelier")
        program("run", "study.toml", folder=folder)
        program(*_compare("measured.toml", "found"), folder=folder)
        other = mirrored(folder)
        pairs = read_pairs(folder / "found")
        rows = [line(f"ours, {word}", pairs, day) for day, word in DAYS.items()]
        rows.append(line("ours, both days", pairs, ""))
        if words.theirs:
            rows += theirs(words.theirs)
        text = _TEXT.format(
            stamp=stamp(),
            rows="\n".join(rows),
            other=f"{100 * other.variation:.0f}",
            above=ABOVE,
            dark=f"{dark(folder / 'found')} of them",
        )
        if not words.write:
            print(text)
            return
        PAGE.write_text(text)
        shutil.copy(
            folder / "found" / "scatter_illuminance.png",
            PAGE.with_name("measured-room-scatter.png"),
        )
        shutil.copy(
            folder / "found" / "maps_lux_1.png",
            PAGE.with_name("measured-room-maps.png"),
        )


def _compare(mapping: str, out: str) -> list[str]:
    return ["compare", mapping, "study_results", "--above", f"{ABOVE:g}", "-o", out]


def program(*words: str, folder: Path) -> None:
    """Call the command line in a folder."""
    start = "import sys; from clerestory.cli.main import main; sys.exit(main())"
    command = [sys.executable, "-c", start, *words, "--quiet"]
    subprocess.run(command, cwd=folder, check=True)


def mirrored(folder: Path) -> Agreement:
    """Return the agreement when rows are read from the other end."""
    text = (folder / "measured.toml").read_text()
    found = re.search(r"row_at = \[(.*)\]", text)
    assert found
    turned = ", ".join(found[1].split(", ")[::-1])
    (folder / "other.toml").write_text(text.replace(found[1], turned))
    program(*_compare("other.toml", "other"), folder=folder)
    return _agreement(read_pairs(folder / "other"), "")


def read_pairs(folder: Path) -> list[tuple[str, float, float]]:
    """Return time, measured and simulated value of each pair."""
    with (folder / "pairs.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    return [(r["time"], float(r["measured"]), float(r["simulated"])) for r in rows]


def dark(folder: Path) -> int:
    """Return how many values were too dark."""
    with (folder / "statistics.csv").open() as stream:
        return sum(int(row["too dark"] or 0) for row in csv.DictReader(stream))


def _agreement(pairs: list[tuple[str, float, float]], day: str) -> Agreement:
    chosen = [(m, s) for time, m, s in pairs if day in time]
    measured, simulated = np.array(chosen).T
    return agreement(measured, simulated)


def line(name: str, pairs: list[tuple[str, float, float]], day: str) -> str:
    """Return a line of the table."""
    found = _agreement(pairs, day)
    shares = " | ".join(f"{100 * share:.0f} %" for share in found.within)
    return (
        f"| {name} | {found.count} | {100 * found.relative_bias:+.0f} % |"
        f" {100 * found.variation:.0f} % | {found.correlation:.2f} | {shares} |"
    )


def theirs(folder: Path) -> list[str]:
    """Return lines for the authors' own runs, from their tables."""
    rows = []
    for file, word in (("26jun", "26 June"), ("20nov", "20 November")):
        with (folder / f"comparison_{file}.csv").open() as stream:
            told = [
                (word, float(r["Experimental_lux"]), float(r["Radiance_lux"]))
                for r in csv.DictReader(stream)
            ]
        bright = [one for one in told if one[1] > ABOVE]
        rows.append(line(f"its authors' Radiance, {word}", bright, ""))
    return rows


if __name__ == "__main__":
    main()
