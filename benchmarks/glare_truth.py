"""DGP by three and five phases against path tracing of real slats, hour by hour.

    python benchmarks/glare_truth.py [--only louvre tilted flat] [--pixel 16]
                                     [--keep DIR] [--write FILE]

The room, systems and eyes are those of `five_phase_truth.py`; twelve sunny hours. The
slats of a microlouvre are so small that the assumption of the method holds: what a
point of the window transmits does not depend on the point. The slats of the venetian
blinds are 8 cm wide. The truth is traced in independent parts; its standard error, and
the change of DGP by the noise of pixels, are computed from DGP of the parts.
"""

import argparse
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from duel import stamp
from five_phase_truth import EFFORT, PIXEL
from truth import methods, reference
from truth.facades import kinds
from truth.kept import Arrays, kept
from truth.setting import EDGE, cameras, weather

# Largest standard error of hours that are compared
LARGEST = 0.004


def rows(name: str, found: Arrays) -> list[str]:
    """Return the lines of the table: both methods, in hours of small error."""
    truth, error = found["glare"][0], found["glare_error"][0]
    sure = error <= LARGEST
    lines = []
    for method in ("three", "five"):
        apart = (found[f"glare_{method}"][0] - truth)[sure]
        lines.append(
            f"| {name} | {method} | {np.count_nonzero(sure)} of {sure.size} |"
            f" {truth[sure].min():.2f}–{truth[sure].max():.2f} |"
            f" {error[sure].mean():.4f} | {abs(apart).mean():.4f} |"
            f" {apart.mean():+.4f} | {np.quantile(abs(apart), 0.95):.4f} |"
            f" {abs(apart).max():.4f} | {np.mean(abs(apart) < 0.01):.0%} |"
        )
    return lines


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    every = ["louvre", "tilted", "flat"]
    parser.add_argument("--only", nargs="*", choices=every, default=every)
    parser.add_argument(
        "--pixel", type=int, default=PIXEL.usual, help="paths per pixel"
    )
    parser.add_argument("--keep", type=Path, help="folder of what was computed")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    paths = replace(PIXEL, usual=options.pixel)
    lines = [
        "# Five-phase glare against path tracing of slats",
        "",
        f"{stamp()}. Made by `benchmarks/glare_truth.py`: twelve sunny hours, four"
        f" eyes, pictures of {EDGE} × {EDGE} pixels, {paths.usual} paths a pixel for"
        f" the truth and {paths.sunny:,} near the sun; hours in which its standard"
        f" error of DGP is at most {LARGEST}.",
        "",
        "| system | phases | hours × eyes | DGP | standard error of the truth | mean"
        " absolute deviation | bias | 95 % within | most | within 0.01 |",
        "|" + "---|" * 10,
    ]
    for name in options.only:
        kind = kinds()[name]
        of = kind, weather(), cameras()
        found = kept(
            options.keep,
            f"{name}-hourly-{paths.usual}",
            partial(reference.glares, *of, paths=paths),
        ) | kept(
            options.keep,
            f"{name}-hourly-phases",
            partial(methods.glares, *of, paths=EFFORT, folder=options.keep),
        )
        lines += rows(kind.name, found)
        print("\n".join(lines[-2:]), flush=True)
    text = "\n".join([*lines, ""])
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
