"""A recipe of annual daylight by lbt-recipes and by ours, on the same model and inputs.

    python benchmarks/recipes.py MODEL.hbjson WEATHER.epw --lbt PROGRAM [--write FILE]

PROGRAM is `lbt-recipes` of another environment, whose honeybee-radiance finds Radiance.
Processor seconds include children. Compared are the mean illuminance of the sunlit
hours of each sensor and its daylight autonomy.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from duel import stamp

from clerestory.metrics.honeybee import read_honeybee

_OURS = "import sys; from clerestory.cli.main import main; sys.exit(main())"


def spent(words: list[str], *, check: bool = True) -> float:
    """Run a program; return its processor seconds, with those of its children."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(words, check=check, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return sum(
        getattr(after, name) - getattr(before, name)
        for name in ("ru_utime", "ru_stime")
    )


def rows(ours: Path, theirs: Path) -> list[str]:
    """Return a line of a table for each grid."""
    folders = [read_honeybee(folder / "results") for folder in (ours, theirs)]
    lines = []
    for name in folders[0].paths:
        first, second = (folder.illuminance(name).values for folder in folders)
        up = np.unique(folders[1].sun_up_hours.astype(int))
        mean, expected = first[:, up].mean(axis=1), second[:, up].mean(axis=1)
        bright = expected > 100
        apart = 100 * (mean / np.maximum(expected, 1e-9) - 1)[bright]
        autonomy = [
            np.loadtxt(folder / "metrics" / "da" / f"{name}.da", ndmin=1)
            for folder in (ours, theirs)
        ]
        change = autonomy[0] - autonomy[1]
        lines.append(
            f"| {name} | {len(mean)} | {bright.sum()} | {apart.mean():+.2f} % |"
            f" {np.quantile(abs(apart), 0.95):.2f} % | {abs(apart).max():.2f} % |"
            f" {change.mean():+.2f} | {abs(change).max():.2f} |"
        )
    return lines


def table(given: argparse.Namespace, folder: Path) -> str:
    """Run both recipes and return the page."""
    inputs = folder / "inputs.json"
    values = {
        "model": str(given.model.resolve()),
        "wea": str(given.weather.resolve()),
        "grid-filter": given.grids,
        "radiance-parameters": given.parameters,
        "cpu-count": 2,
    }
    inputs.write_text(json.dumps(values))
    name, ours, theirs = given.recipe, folder / "ours", folder / "theirs"
    own = folder / "own.json"
    own.write_text(json.dumps(values | {"radiance-parameters": given.own_parameters}))
    words = ["recipe", name, str(own), "--folder", str(ours), "--workers", "2"]
    seconds = spent([sys.executable, "-c", _OURS, *words, "--quiet"])
    theirs.mkdir()
    words = ["run", name, str(inputs), "-p", str(theirs), "-w", "2"]
    # Some versions fail after the last step, when they report the duration
    others = spent([given.lbt, *words], check=False)
    compared = rows(*(each / name.replace("-", "_") for each in (ours, theirs)))
    page = [
        "# Recipes of Ladybug Tools",
        "",
        f"`{name}` by lbt-recipes (Radiance) and by `clerestory recipe`, from",
        "the same file of inputs (`benchmarks/recipes.py`). Mean illuminance over the",
        "sunlit hours, of the sensors where it is above 100 lux, ours over Radiance's:",
        "mean of the sensors, 95 % of them, and the worst; then daylight autonomy,",
        "ours minus Radiance's, in points.",
        "",
        stamp(),
        "",
        f"Model {given.model.name}, weather {given.weather.name},"
        f" radiance-parameters `{given.parameters}`.",
        "",
        "| grid | sensors | above 100 lux | mean | 95 % | worst | DA: mean | worst |",
        "|---|---|---|---|---|---|---|---|",
        *compared,
        "",
        f"Processor seconds: lbt-recipes {others:.0f}, ours {seconds:.0f}.",
    ]
    return "\n".join(page) + "\n"


def main() -> None:
    """Print the page, or write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", type=Path)
    parser.add_argument("weather", type=Path)
    parser.add_argument("--lbt", required=True, help="the program lbt-recipes")
    parser.add_argument("--recipe", default="annual-daylight-enhanced")
    parser.add_argument("--grids", default="*", help="filter of the grids")
    parser.add_argument("--parameters", default="-ab 4 -ad 5000 -lw 2e-05 -dr 0")
    parser.add_argument("--own-parameters", help="of ours; default: the same")
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    given.own_parameters = given.own_parameters or given.parameters
    with tempfile.TemporaryDirectory() as folder:
        text = table(given, Path(folder))
    if given.write:
        given.write.write_text(text)
    else:
        sys.stdout.write(text)


if __name__ == "__main__":
    main()
