"""Solar radiation through a window by our matrices and by EnergyPlus, hour by hour.

A window of 3 m² with clear double glazing faces south, without obstructions. EnergyPlus
has the panes as ordinary glazing, whose angular properties it computes itself, and as a
complex fenestration state, also with a blind. The causes of differences are separated:
the sun within the hour, by runs with one time step and with four; sky and ground on the
window; the transmittance for the sun and for diffuse radiation, with the radiation that
EnergyPlus has on the window. The tables of `docs/benchmarks/energy.md` are made by

    python benchmarks/energy_glass.py chicago.epw
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.patch_interpolation import patch_weights

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from energy_models import PANE, PLAIN, blind
from slat_walk import pane_pair, transmitted
from south_window import (
    AREA,
    DIM,
    Ours,
    at_cosine,
    by_energyplus,
    hemispherical,
    systems,
    transmittance,
)

# Hours of random walks
WALKS = 200


def through(ours, passed, found):
    """Return transmitted sun and diffuse radiation [W], with EnergyPlus' radiation.

    `passed` is the transmittance by incident patch.
    """
    sun, rest = ours.beam.irradiance, ours.rest.sum(axis=0)
    share = passed @ ours.beam.patches / np.maximum(sun, 1e-9)
    diffuse = passed @ ours.rest / np.maximum(rest, 1e-9)
    outside = found["sky"] + found["ground"]
    return AREA * share * found["beam"], AREA * diffuse * outside


def compare(name, found, expected, lit):
    """Print mean difference, and share of hours and of radiation within 3 %."""
    ratio = found[lit] / expected[lit] - 1
    weight = expected[lit] / expected[lit].sum()
    near = np.abs(ratio) < 0.03
    print(
        f"| {name} | {100 * (found[lit].sum() / expected[lit].sum() - 1):+.1f} % |"
        f" {100 * (weight @ np.abs(ratio)):.1f} % |"
        f" {100 * weight[near].sum():.0f} % | {100 * near.mean():.0f} % |"
        f" {100 * np.abs(ratio).max():.1f} % |",
        flush=True,
    )


def outdoors(ours, found, steps):
    """Print rows of the radiation on the window."""
    title = f"{steps} time step{'s' if steps > 1 else ''} in the hour"
    sun, rest = ours.beam.irradiance, ours.rest.sum(axis=0)
    whole = found["beam"] + found["sky"] + found["ground"]
    compare(f"sun, {title}", sun, found["beam"], found["beam"] > DIM)
    if steps == 1:
        lit = whole > DIM
        compare("ground", ours.ground, found["ground"], lit & (found["ground"] > 1))
        compare("sky", rest - ours.ground, found["sky"], lit)
    compare(f"all, {title}", sun + rest, whole, whole > DIM)


def from_weather(ours, passed, four, one):
    """Print rows of the transmitted radiation, with the radiation of each program."""
    mine = AREA * passed @ (ours.beam.patches + ours.rest)
    whole = {n: f["beam in"] + f["diffuse in"] for n, f in ((4, four), (1, one))}
    for steps, expected in whole.items():
        title = f"{steps} time step{'s' if steps > 1 else ''} in the hour"
        compare(f"ours, {title}", mine, expected, expected > AREA * DIM / 2)
    expected = whole[4]
    title = "EnergyPlus with 1 time step, 4 time steps in the hour"
    compare(title, whole[1], expected, expected > AREA * DIM / 2)


def indoors(ours, passed, found, name):
    """Print rows of the transmitted radiation, with the same on the window."""
    outside = found["sky"] + found["ground"]
    lit, sunny = found["beam"] + outside > DIM, found["beam"] > DIM
    beam, diffuse = through(ours, passed, found)
    whole = found["beam in"] + found["diffuse in"]
    compare(f"{name}: sun", beam, found["beam in"], sunny)
    compare(f"{name}: diffuse", diffuse, found["diffuse in"], lit)
    compare(f"{name}: all", beam + diffuse, whole, lit)
    return beam, whole, lit


def glass(ours, passed, found, partition):
    """Print rows of clear glass, without differences of methods one by one."""
    name = "clear, ordinary glazing"
    beam, whole, lit = indoors(ours, passed, found, name)
    mean = hemispherical(partition, passed)
    same = AREA * mean * (found["sky"] + found["ground"])
    compare(f"{name}: all, one diffuse transmittance", beam + same, whole, lit)
    cosine = np.clip(found["cosine"], 1e-3, 1)
    between = AREA * at_cosine(partition, passed, cosine) * found["beam"]
    text = f"{name}: all, one diffuse transmittance, EnergyPlus' solar position"
    compare(text, between + same, whole, lit)
    exact = AREA * pane_pair(PANE.material)(cosine)[0] * found["beam"]
    text = f"{name}: all, one diffuse transmittance, sun by Fresnel's equations"
    compare(text, exact + same, whole, lit)


def walks(ours, passed, found, partition):
    """Print errors of the sun's transmittance through a blind, by random walks."""
    sunny = np.flatnonzero((found["beam"] > DIM) & (ours.beam.irradiance > 0))
    chosen = np.random.default_rng(1).choice(sunny, WALKS, replace=False)
    way, panes = ours.travel[chosen], pane_pair(PANE.material)
    slats = {"slats": blind(45).slats, "reflectance": 0.7, "gap": 0.05}
    walked = np.array([transmitted(each, panes, **slats) for each in way])
    print("\n| sun through the blind | year | mean of hours | within 3 % |")
    print("|---|---|---|---|")
    beam = found["beam"][chosen] / found["beam"][chosen].sum()
    for name, share in (
        ("ours", passed @ patch_weights(partition, way)),
        ("EnergyPlus", found["beam in"][chosen] / (AREA * found["beam"][chosen])),
    ):
        ratio = share / walked - 1
        near = 100 * np.mean(np.abs(ratio) < 0.03)
        year = 100 * (beam @ share / (beam @ walked) - 1)
        mean = 100 * (beam @ np.abs(ratio))
        print(f"| {name} | {year:+.1f} % | {mean:.1f} % | {near:.0f} % |")


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("weather", type=Path)
    parser.add_argument("--basis", default="full")
    args = parser.parse_args()
    head = "| year | mean of hours | radiation within 3 % | hours | largest |"
    rule = "|---|---|---|---|---|---|"
    with tempfile.TemporaryDirectory() as place:
        folder, partition = Path(place), klems(args.basis)
        known = systems(partition)
        objects = {"plain": PLAIN} | {name: text for name, (_, text) in known.items()}
        four = by_energyplus(folder, args.weather, "plain", PLAIN, steps=4)
        found = {
            name: by_energyplus(folder, args.weather, name, text)
            for name, text in objects.items()
        }
        passed = {name: transmittance(light) for name, (light, _) in known.items()}
        ours = Ours(folder, args.weather, known["clear"][0], partition)
        print(f"| on the window {head}\n{rule}")
        outdoors(ours, four, 4)
        outdoors(ours, found["plain"], 1)
        print(f"\n| transmitted, from the weather file {head}\n{rule}")
        from_weather(ours, passed["clear"], four, found["plain"])
        print(f"\n| transmitted, same on the window {head}\n{rule}")
        glass(ours, passed["clear"], found["plain"], partition)
        indoors(ours, passed["clear"], found["clear"], "clear, state")
        indoors(ours, passed["blind"], found["blind"], "blind, state")
        walks(ours, passed["blind"], found["blind"], partition)


if __name__ == "__main__":
    main()
