"""How far skies are from gendaymtx, over whole years, and from gendaylit.

    python benchmarks/sky_parity.py YEAR.epw… [--subdivisions 1 4] [--write FILE]

A patch may differ by 0.5 % or by 10⁻³ of the dome's mean: the first column is the
largest difference as a share of that. The others are relative differences of
irradiance on the horizontal and four vertical planes, and of the sum over the dome.

Random skies are compared with gendaylit's in a hundred directions each, seen by
rtrace: as they are, and scaled by the coarse sum that gendaylit scales by.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
from duel import stamp

from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.weather_formats import read_weather

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "parity"))
from gendaylit import likeness
from gendaymtx import Distance, distance, epw_to_wea, gendaymtx


def farthest(epw: Path, subdivision: int) -> Distance:
    """Return the largest differences over a year."""
    with tempfile.TemporaryDirectory() as name:
        wea = Path(name) / "year.wea"
        epw_to_wea(epw, wea)
        theirs = gendaymtx(wea, "-m", str(subdivision))
        sky = sky_matrix(
            read_weather(wea), subdivision=subdivision, sun_formula="radiance"
        )
    found = Distance(0, 0, 0)
    for start in range(0, len(sky.times), 365):
        part = slice(start, start + 365)
        found = found.worse(
            distance(sky.block(part), theirs[:, :, part], sky.partition)
        )
    return found


def random_skies(count: int) -> list[str]:
    """Return a table of differences from gendaylit over some random skies."""
    random = np.random.default_rng(0)
    with tempfile.TemporaryDirectory() as name:
        found = [likeness(random, Path(name)) for _ in range(count)]
    columns = {
        "gendaylit's sum over the integral": [abs(one.excess) for one in found],
        "radiance, as it is": [one.as_is for one in found],
        "radiance, scaled by that sum": [one.rescaled for one in found],
    }
    lines = ["| largest difference in a sky | least | median | most |"]
    lines.append("|---|---|---|---|")
    for name, values in columns.items():
        least, middle, most = np.min(values), np.median(values), np.max(values)
        lines.append(f"| {name} | {least:.3%} | {middle:.3%} | {most:.3%} |")
    return lines


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("epw", type=Path, nargs="+")
    parser.add_argument("--subdivisions", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--skies", type=int, default=200)
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    lines = ["### Sky matrices and gendaymtx", "", f"{stamp()}.", ""]
    lines += ["| | | patch / allowed | planes | dome |", "|---|---|---|---|---|"]
    for subdivision in options.subdivisions:
        for epw in options.epw:
            d = farthest(epw, subdivision)
            figures = f"{d.patch:.3f} | {d.plane:.1e} | {d.direct:.1e}"
            lines.append(f"| MF {subdivision} | {epw.stem} | {figures} |")
            print(lines[-1], file=sys.stderr)
    lines += ["", "### Skies and gendaylit", ""]
    lines += [f"{options.skies} random skies, a hundred directions each.", ""]
    lines += random_skies(options.skies)
    print("\n".join(lines))
    if options.write:
        options.write.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
