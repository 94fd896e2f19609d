"""Annual glare of an office with three façades against full Radiance renderings.

    python benchmarks/annual_glare_reference.py FOLDER [--peer FOLDER] [--steps N]
                                                [--check N] [--write FILE]

FOLDER is raytraverse's data set (stephanwaz/raytraverse): an office with clear glass,
with translucent glass above, and with clear glass opposite a façade of glossy metal;
three views; vertical illuminance, DGP and UGP in 2,022 hours, by Radiance. The glazing
is part of the scene: `glazed_view_glare` is the two-phase method with the sun exact.

With --peer, results of raytraverse for the same views are compared too: the tables that
`raytraverse … pull` writes, and `seconds.txt` with a façade and the processor time of
its three views in each line. With --check, vertical illuminance in N hours is also
path-traced under gendaylit's continuous sky.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from duel import stamp

from clerestory.phases.rendering import irradiance
from clerestory.radiance.generated_sky import sky_scene
from clerestory.scene.sensors import Sensors

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "parity"))

from annual_glare_office import (
    FACADES,
    VIEWS,
    Facade,
    Found,
    ours,
    reference,
    scene_of,
    skies_of,
    views_of,
    weather_of,
)

# Classes of DGP: imperceptible, perceptible, disturbing, intolerable
CLASSES = (0.35, 0.40, 0.45)

# Luminance above which a picture of the reference shows the sun's disc [cd/m²]
DISC = 1e7


def peers(folder: Path, facade: Facade, hours: slice) -> Iterator[Found]:
    """Yield the results of raytraverse for each view."""
    lines = (folder / "seconds.txt").read_text().splitlines()
    seconds = dict(line.split() for line in lines)
    points = np.loadtxt(folder / f"{facade.name}_points.txt")
    for row in points:
        place = "_".join(f"{value:05.2f}" for value in row)
        file = folder / f"{facade.name}_point_{place}_metric.txt"
        table = np.genfromtxt(file, names=True)[hours]
        each = float(seconds[facade.name]) / len(points)
        yield Found(table["illum"], table["dgp"], table["ugp"], each)


def classes(dgp: np.ndarray) -> np.ndarray:
    """Return the class of glare, 0 (imperceptible) to 3 (intolerable)."""
    return np.searchsorted(CLASSES, dgp)


def row_of(title: str, found: Found, truth: np.ndarray) -> str:
    """Return a line of the table: errors of one view, over the hours."""
    lux = found.lux / truth["illum"] - 1
    dgp = found.dgp - truth["dgp"]
    moved = abs(classes(found.dgp) - classes(truth["dgp"]))
    cells = (
        f"{abs(lux).mean():.2%}", f"{lux.mean():+.2%}",
        f"{abs(dgp).mean():.4f}", f"{dgp.mean():+.4f}",
        f"{np.quantile(abs(dgp), 0.95):.3f}",
        f"{abs(found.ugp - truth['ugp']).mean():.3f}",
        f"{np.mean(moved == 1):.1%}", f"{np.mean(moved > 1):.1%}",
        f"{found.seconds:.0f} s",
    )  # fmt: skip
    return f"| {title} | " + " | ".join(cells) + " |"


HEAD = (
    "| façade, view | Ev | bias | DGP | bias | 95 % within | UGP | one class | two or"
    " more | processor |\n|---|---|---|---|---|---|---|---|---|---|"
)


def mean_row(pairs: list[tuple[Found, np.ndarray]]) -> str:
    """Return the means of all lines."""
    lux = [abs(f.lux / t["illum"] - 1).mean() for f, t in pairs]
    lux_bias = [(f.lux / t["illum"] - 1).mean() for f, t in pairs]
    dgp = [abs(f.dgp - t["dgp"]).mean() for f, t in pairs]
    dgp_bias = [(f.dgp - t["dgp"]).mean() for f, t in pairs]
    ugp = [abs(f.ugp - t["ugp"]).mean() for f, t in pairs]
    moved = [abs(classes(f.dgp) - classes(t["dgp"])) for f, t in pairs]
    return (
        f"| **mean** | **{np.mean(lux):.2%}** | {np.mean(lux_bias):+.2%} |"
        f" **{np.mean(dgp):.4f}** | {np.mean(dgp_bias):+.4f} | |"
        f" {np.mean(ugp):.3f} | {np.mean([np.mean(m == 1) for m in moved]):.1%} |"
        f" {np.mean([np.mean(m > 1) for m in moved]):.1%} |"
        f" {np.mean([f.seconds for f, _ in pairs]):.0f} s |"
    )


def causes(pairs: list[tuple[Found, np.ndarray]]) -> list[str]:
    """Return a table of the deviations by kind of hour."""
    lines = [
        "| hours | share | Ev bias | DGP | DGP bias | of which by Ev |",
        "|---|---|---|---|---|---|",
    ]
    truth = np.concatenate([t for _, t in pairs])
    lux = np.concatenate([f.lux for f, _ in pairs])
    dgp = np.concatenate([f.dgp for f, _ in pairs])
    seen, clipped = truth["maxlum"] > DISC, (truth["dgp"] >= 1) & (dgp >= 1)
    bright = ~seen & (truth["dgp_t2"] > 0.005)
    for name, some in (
        ("DGP is 1 in both", clipped),
        ("sun's disc seen, DGP below 1", seen & ~clipped),
        ("other glare sources", bright & ~clipped),
        ("hardly any contrast", ~(seen | bright | clipped)),
    ):
        if some.any():
            relative = (lux / truth["illum"] - 1)[some]
            apart = (dgp - truth["dgp"])[some]
            by_lux = 5.87e-5 * (lux - truth["illum"])[some]
            lines.append(
                f"| {name} | {some.mean():.0%} | {relative.mean():+.2%} |"
                f" {abs(apart).mean():.4f} | {apart.mean():+.4f} |"
                f" {by_lux.mean():+.4f} |"
            )
    return lines


def checked(folder: Path, count: int) -> list[str]:
    """Return a table of path-traced vertical illuminances in some hours."""
    lines = [
        "| façade, view | Radiance / path tracing | standard error |",
        "|---|---|---|",
    ]
    for facade in FACADES:
        scene, views = scene_of(folder, facade), views_of(folder, facade)
        tables = [reference(folder, facade, view) for view in range(VIEWS)]
        sensors = Sensors(
            np.array([view.position for view in views]),
            np.array([view.direction for view in views]),
        )
        ratios, errors = [], []
        for row in np.linspace(20, len(tables[0]) - 20, count).astype(int):
            lit = scene + sky_scene(_gendaylit(folder, tables[0][row]))
            made = irradiance(lit, sensors, samples=32768, seed=int(row))
            lux = made.illuminance()
            ratios.append([t["illum"][row] for t in tables] / lux)
            errors.append(made.illuminance_error / lux)
        error = np.sqrt(np.square(errors).sum(axis=0)) / count
        both = enumerate(zip(np.mean(ratios, axis=0), error, strict=True), start=1)
        lines += [f"| {facade.title}, {n} | {r:.3f} | {e:.3f} |" for n, (r, e) in both]
    return lines


def _gendaylit(folder: Path, row: np.ndarray) -> str:
    sky = np.loadtxt(folder / "weather/skydata.txt")[int(row["ann_hour"])]
    return (
        f"gendaylit {int(row['month'])} {int(row['day'])} {row['hour']}"
        f" -W {sky[3]:g} {sky[4]:g} -a 46.25 -o -6.13 -m -15"
    )


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="raytraverse's data set")
    parser.add_argument("--peer", type=Path, help="folder of raytraverse's results")
    parser.add_argument("--steps", type=int, help="about so many hours, to try")
    parser.add_argument("--check", type=int, default=0, help="hours path-traced")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    folder, mine, theirs = options.folder, [], []
    lines = [f"{stamp()}. Made by `benchmarks/annual_glare_reference.py`.", "", HEAD]
    other = [HEAD]
    for facade in FACADES:
        tables = [reference(folder, facade, view) for view in range(VIEWS)]
        hours = slice(None, None, max(1, len(tables[0]) // (options.steps or 1 << 30)))
        tables = [table[hours] for table in tables]
        weather = weather_of(folder, tables[0]["ann_hour"].astype(int))
        scene, skies = scene_of(folder, facade), skies_of(weather)
        for number, view in enumerate(views_of(folder, facade)):
            found = ours(scene, view, skies)
            mine.append((found, tables[number]))
            lines.append(row_of(f"{facade.title}, {number + 1}", *mine[-1]))
            print(lines[-1], f"± {found.error.mean():.4f}", flush=True)
        if options.peer:
            results = peers(options.peer, facade, hours)
            for number, found in enumerate(results):
                theirs.append((found, tables[number]))
                other.append(row_of(f"{facade.title}, {number + 1}", *theirs[-1]))
    lines += [mean_row(mine), "", *causes(mine), ""]
    if theirs:
        lines += ["### raytraverse", "", *other, mean_row(theirs), ""]
    if options.check:
        lines += ["### Who is right", "", *checked(folder, options.check), ""]
    text = "\n".join(lines)
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
