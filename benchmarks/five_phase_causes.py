"""Why five phases deviate from path tracing: experiments on the worst cases.

    python benchmarks/five_phase_causes.py --keep DIR [--write FILE]

Reads what `five_phase_truth.py` kept in the folder. Behind film and microlouvre, the
parts of five phases are compared with path tracing: light of the sky, sun that arrives
straight from the window, sun that the room has reflected, and its flux through the
window. Behind the microlouvre, the worst cases of DGP
are made again with other random numbers, more paths and a finer tree, and with the sky,
or the sun, by path tracing.
"""

import argparse
import importlib
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from five_phase_truth import EFFORT, FEW, PIXEL, results
from truth import cause_tables, methods
from truth.facades import Kind, kinds
from truth.jackknife import glare, indices
from truth.kept import Arrays, kept
from truth.setting import cameras, demo, pictured, weather
from truth.slats import Slats

from clerestory.engine.device import load

# Paths of a sensor for the light of the sky
SKY = 32768

# Worst cases of DGP that are examined
WORST = 3


def sunlight(kind: Kind, folder: Path) -> Arrays:
    """Return the sun through a façade, by rays of its disc through the geometry.

    `exact` is the flux per area of the window (step) [W/m²], `spread` that of V T D S;
    `lux_direct` is the illuminance of the sensors straight from the window
    (sensor, step) [lux].
    """
    # Kernels are built for a device that is loaded before them
    load()
    module = importlib.import_module("truth.sun_rays")
    exact, direct = module.through(kind, weather(), demo()[2])
    spread = methods.sun_flux(kind, weather(), EFFORT, folder)
    return {"spread": spread, "exact": exact, "lux_direct": direct}


def sky(kind: Kind) -> Arrays:
    """Return illuminance by the sky alone (sensor, step) [lux], at some hours."""
    dark = Slats(kind, shines=False)
    lux = [
        dark.illuminance(
            weather(), weather().times[hour].item(), demo()[2], samples=SKY, seed=hour
        )[0]
        for hour in FEW
    ]
    return {"lux_sky_traced": np.array(lux).T}


def worst(found: Arrays) -> list[tuple[int, int]]:
    """Return eye and step of the largest deviations of DGP by five phases."""
    apart = abs(found["glare_five"][0] - found["glare"][0])
    order = np.argsort(apart, axis=None)[::-1][:WORST]
    return [tuple(map(int, np.unravel_index(n, apart.shape))) for n in order]


def louvre(kind: Kind, cases: list[tuple[int, int]], folder: Path) -> Arrays:
    """Return DGP of the worst cases by variants of the method (case)."""
    part = kind.parts[0]
    coarse, fine = methods.bsdfs(part, folder)
    usual = methods.tree_effort(part)
    more = replace(EFFORT, row=4 * EFFORT.row, pixel=4 * EFFORT.pixel)
    variants = {
        "five phases": ((coarse, fine), EFFORT, 0),
        "other random numbers of V and D": ((coarse, fine), EFFORT, 100),
        "four times the paths of V and D": ((coarse, fine), more, 200),
        "other random numbers of T and of the tree": (
            (
                methods.klems_bsdf(part, seed=9),
                methods.tree_bsdf(part, usual, seed=9),
            ),
            EFFORT,
            0,
        ),
        "tree of 2^7 in place of 2^6": (
            (coarse, methods.tree_bsdf(part, methods.TreeEffort(7, 256))),
            EFFORT,
            0,
        ),
        "sky of MF 6 in place of MF 4": (
            (coarse, fine),
            replace(EFFORT, subdivision=6),
            0,
        ),
    }
    found: Arrays = {}
    for name, (pair, paths, seed) in variants.items():
        made = {
            eye: methods.pictures(
                kind, pictured(), cameras()[eye], [pair], paths, seed=seed
            )
            for eye in {eye for eye, _ in cases}
        }
        found[name] = np.array(
            [indices(cameras()[e], made[e]["five"][s])[0] for e, s in cases]
        )
        if name == "five phases":
            found |= by_parts(kind, cases, made)
    return found


def by_parts(
    kind: Kind, cases: list[tuple[int, int]], made: dict[int, Arrays]
) -> Arrays:
    """Return DGP of the cases with the sky or the sun by the other way (case)."""
    names = "truth", "sky by path tracing", "sun by path tracing"
    values: dict[str, list[float]] = {name: [] for name in names}
    for eye, step in cases:
        time = pictured().times[step].item()
        camera = cameras()[eye]
        whole, sky = (
            Slats(kind, shine).picture(pictured(), time, camera, paths=PIXEL, seed=seed)
            for shine, seed in ((True, 5), (False, 6))
        )
        five, own = made[eye]["five"][step], made[eye]["sky"][step]
        values["truth"].append(glare(camera, whole).value[0])
        mixed = sky + np.maximum(five - own, 0)
        values["sky by path tracing"].append(glare(camera, mixed).value[0])
        rest = np.maximum(whole - sky.mean(axis=0), 0) + own
        values["sun by path tracing"].append(glare(camera, rest).value[0])
    return {name: np.array(each) for name, each in values.items()}


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--keep", type=Path, required=True, help="folder of results")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    every = kinds()
    systems = {name: every[name] for name in ("film", "louvre")}
    found = {
        kind: results(options.keep, name, kind, hours=FEW)
        for name, kind in systems.items()
    }
    suns: dict[Kind, Arrays] = {}
    for name, kind in systems.items():
        rays = kept(
            options.keep, f"{name}-sunlight", partial(sunlight, kind, options.keep)
        )
        dark = kept(options.keep, f"{name}-sky", partial(sky, kind))
        seconds = rays["seconds"] + dark["seconds"]
        suns[kind] = rays | dark | {"seconds": seconds}
    of_louvre = found[every["louvre"]]
    cases = worst(of_louvre)
    variants = kept(
        options.keep,
        "louvre-causes",
        partial(louvre, every["louvre"], cases, options.keep),
    )
    text = cause_tables.page(found, suns, of_louvre, cases, variants)
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
