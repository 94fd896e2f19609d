"""Why DGP behind the microlouvre deviates: experiments on the worst cases.

    python benchmarks/glare_causes.py --keep DIR [--write FILE]

Reads what `five_phase_truth.py` kept in the folder. The worst cases are made again with
other random numbers, more paths, a finer tree and a finer sky, and with the light of
the sky by path tracing through the bars.
"""

import argparse
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from duel import stamp
from five_phase_truth import EFFORT, PIXEL, results
from truth import methods
from truth.facades import Kind, kinds
from truth.jackknife import glare, indices
from truth.kept import Arrays, kept
from truth.setting import cameras, pictured
from truth.slats import Slats

SHOWN = (
    "truth",
    "five phases",
    "sky by path tracing",
    "other random numbers of V and D",
    "four times the paths of V and D",
    "other random numbers of T and of the tree",
    "tree of 2^7 in place of 2^6",
    "sky of MF 6 in place of MF 4",
)

CONCLUSION = (
    "Random numbers, paths, tree and sky patches change DGP by much less than the"
    " deviation. The light of the sky changes it most: five phases keep it in Klems"
    " patches, inside and outside."
)

# Worst cases of DGP that are examined
WORST = 3


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
    """Return DGP of the cases of the truth, and with its sky (case)."""
    names = "truth", "sky by path tracing"
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
    return {name: np.array(each) for name, each in values.items()}


def page(found: Arrays, cases: list[tuple[int, int]], variants: Arrays) -> str:
    """Return the whole page."""
    heads = [
        f"eye {eye + 1}, {pictured().times[step].astype(str)}" for eye, step in cases
    ]
    error = [found["glare_error"][0][case] for case in cases]
    lines = [
        "# Causes of five-phase glare deviations behind the microlouvre",
        "",
        f"{stamp()}. Made by `benchmarks/glare_causes.py` in"
        f" {float(variants['seconds']):.0f} seconds of processor time: DGP of the"
        f" {len(cases)} cases of [the table](five-phase.md) in which five phases"
        " deviate most. *Truth* is made again with other random numbers. *Sky by path"
        " tracing*: the sun by five phases, added to a picture of the sky that is"
        " traced through the bars.",
        "",
        f"| | {' | '.join(heads)} |",
        "|---|" + "---|" * len(heads),
    ]
    rows = {"truth, of the table": [found["glare"][0][case] for case in cases]}
    rows |= {"its standard error": error}
    rows |= {name: values for name, values in variants.items() if name in SHOWN}
    for name, values in rows.items():
        cells = " | ".join(f"{value:.4f}" for value in values)
        lines.append(f"| {name} | {cells} |")
    return "\n".join([*lines, "", CONCLUSION]) + "\n"


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--keep", type=Path, required=True, help="folder of results")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    kind = kinds()["louvre"]
    found = results(options.keep, "louvre", kind, ("glare", "glare-phases"))
    cases = worst(found)
    make = partial(louvre, kind, cases, options.keep)
    variants = kept(options.keep, "louvre-causes", make)
    text = page(found, cases, variants)
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
