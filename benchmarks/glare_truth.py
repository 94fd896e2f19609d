"""DGP by three and five phases against path tracing of real slats, hour by hour.

    python benchmarks/glare_truth.py [--only louvre tilted flat] [--pixel 64]
                                     [--keep DIR] [--write FILE]

The room, systems and eyes are those of `five_phase_truth.py`; twelve sunny hours. The
slats of a microlouvre are so small that the assumption of the method holds: what a
point of the window transmits does not depend on the point. The slats of the venetian
blinds are 8 cm wide. The truth is traced in four blocks of paths; its standard error,
and the change of DGP by the noise of pixels, are computed from DGP of the blocks.
"""

import argparse
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from duel import stamp
from five_phase_truth import dgp, kept
from truth import methods
from truth.setting import EDGE, Kind, kinds, weather
from truth.slats import Slats

# Blocks of the truth's paths, and largest standard error of hours that are compared
BLOCKS, LARGEST = 4, 0.004

# Paths per row of D, and per pixel of V
ROWS, COEFFICIENTS = 16384, 128


def truth(kind: Kind, pixel: int) -> dict[str, np.ndarray]:
    """Return DGP (eye, step) of all paths, of blocks, and of all but one block."""
    slats, times = Slats(kind), [time.item() for time in weather().times]
    blocks = []
    for block in range(BLOCKS):
        seed = 1000 * (block + 1)
        found = [
            slats.pictures(weather(), time, samples=pixel // BLOCKS, seed=seed + step)
            for step, time in enumerate(times)
        ]
        blocks.append(np.swapaxes(np.asarray(found, np.float32), 0, 1))
    mean = np.mean(blocks, axis=0)
    others = [(mean * BLOCKS - each) / (BLOCKS - 1) for each in blocks]
    return {
        "all": dgp(mean),
        "others": np.array([*map(dgp, others)]),
    }


def found(kind: Kind) -> dict[str, np.ndarray]:
    """Return DGP (eye, step) by three and five phases."""
    three, five = methods.pictures(
        kind, *methods.bsdfs(kind), rows=ROWS, samples=COEFFICIENTS, hours=weather()
    )
    return {"three": dgp(three), "five": dgp(five)}


@dataclass(frozen=True, eq=False)
class Compared:
    """DGP (eye, step) of a system: the truth, its error, and by the methods."""

    truth: np.ndarray
    error: np.ndarray
    three: np.ndarray
    five: np.ndarray

    @classmethod
    def of(cls, traced: dict[str, np.ndarray], phases: dict[str, np.ndarray]):
        """Return the jackknife estimate, free of the first-order bias by noise."""
        others = traced["others"]
        value = BLOCKS * traced["all"] - (BLOCKS - 1) * others.mean(axis=0)
        spread = np.square(others - others.mean(axis=0)).sum(axis=0)
        error = np.sqrt(spread * (BLOCKS - 1) / BLOCKS)
        return cls(np.minimum(value, 1), error, phases["three"], phases["five"])

    def rows(self, name: str) -> list[str]:
        """Return the lines of the table: both methods, in hours of small error."""
        sure = self.error <= LARGEST
        lines = []
        for method, values in (("three", self.three), ("five", self.five)):
            apart = (values - self.truth)[sure]
            lines.append(
                f"| {name} | {method} | {np.count_nonzero(sure)} of {sure.size} |"
                f" {self.truth[sure].min():.2f}–{self.truth[sure].max():.2f} |"
                f" {self.error[sure].mean():.4f} | {abs(apart).mean():.4f} |"
                f" {apart.mean():+.4f} | {np.quantile(abs(apart), 0.95):.4f} |"
                f" {abs(apart).max():.4f} | {np.mean(abs(apart) < 0.01):.0%} |"
            )
        return lines


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    every = ["louvre", "tilted", "flat"]
    parser.add_argument("--only", nargs="*", choices=every, default=every)
    parser.add_argument("--pixel", type=int, default=64, help="paths per pixel")
    parser.add_argument("--keep", type=Path, help="folder of what was computed")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    lines = [
        "# Five-phase glare against path tracing of slats",
        "",
        f"{stamp()}. Made by `benchmarks/glare_truth.py`: twelve sunny hours, four"
        f" eyes, pictures of {EDGE} × {EDGE} pixels, {options.pixel} paths a pixel for"
        f" the truth; hours in which its standard error of DGP is at most {LARGEST}.",
        "",
        "| system | phases | hours × eyes | DGP | standard error of the truth | mean"
        " absolute deviation | bias | 95 % within | most | within 0.01 |",
        "|" + "---|" * 10,
    ]
    for name in options.only:
        kind = kinds()[name]
        traced = kept(
            options.keep,
            f"{name}-{options.pixel}-truth",
            partial(truth, kind, options.pixel),
        )
        phases = kept(options.keep, f"{name}-phases", partial(found, kind))
        lines += Compared.of(traced, phases).rows(kind.name)
        print("\n".join(lines[-2:]), flush=True)
    text = "\n".join([*lines, ""])
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
