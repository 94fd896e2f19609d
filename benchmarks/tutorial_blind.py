"""The blind of LBNL's matrix tutorial, made again from its geometry.

    python benchmarks/tutorial_blind.py DATA [--peer 32000] [--write FILE]

DATA is the folder with `blinds.rad` and `blinds.xml`. The file says how it was made:
genBSDF with 10,000 samples a patch and five bounces. A share p of so many samples is
known to √(p (1 - p) / 10,000), which is 1 to 4 % of the shares of many patches: more
than 1 % can be asked of means over rings of patches, and of a run of more samples.
That run is of genBSDF's Python port, one path a sample.
"""

import argparse
import os
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyradiance
from duel import ENVIRONMENT, stamp

import clerestory as cl
from clerestory.hemisphere.klems import klems
from clerestory.radiance.rad_writer import format_rad

FULL = klems("full")
MEASURE = FULL.projected_solid_angles()
RING = np.repeat(np.arange(len(FULL.count)), FULL.count)
PARTS = {
    "transmission_front": ("front", "transmittance"),
    "transmission_back": ("back", "transmittance"),
    "reflection_front": ("front", "reflectance"),
    "reflection_back": ("back", "reflectance"),
}
TUNED = ["-ad", "1", "-lw", "1e-6", "-ab", "5"]
MADE_WITH = 10_000


@dataclass(frozen=True)
class Gaps:
    """How far shares of light from single patches and rings are apart.

    Attributes
    ----------
    errors : root mean square over patches, in joint standard errors
    matrix : the same over single values that more than two samples reached
    noise : relative standard error of the other's patches, median and largest
    patch, ring : largest relative difference
    even : relative difference of the share of even light
    """

    errors: float
    matrix: float
    noise: tuple[float, float]
    patch: float
    ring: float
    even: float


def radiance(scene: cl.Scene, samples: int) -> dict[str, np.ndarray]:
    """Return the matrices of genBSDF's port [1/sr]."""
    made = pyradiance.generate_bsdf(
        format_rad(scene, bsdf_file={}).encode(),
        params=TUNED,
        nsamp=samples,
        nproc=os.cpu_count() or 1,
    )
    found = {}
    for name, (side, part) in PARTS.items():
        text = getattr(getattr(made, side), part).decode()
        rows = [np.array(line.split(), float) for line in text.splitlines()]
        found[name] = np.array([row for row in rows if len(row)]) / MEASURE[:, None]
    return found


def gaps(ours, theirs: np.ndarray, samples: int) -> Gaps:
    """Compare one function of ours with matrices of so many samples."""
    a, b = ours.direct_hemispherical(), MEASURE @ theirs
    noise = np.sqrt(b * (1 - b) / samples)
    own = np.sqrt(((ours.standard_error * MEASURE[:, None]) ** 2).sum(axis=0))
    mean = (ours.values + theirs) / 2
    error = np.hypot(ours.standard_error, np.sqrt(mean / (samples * MEASURE[:, None])))
    seen = mean * MEASURE[:, None] * samples > 2
    score = ((ours.values - theirs)[seen] / error[seen]) ** 2
    rings = [np.bincount(RING, part) / FULL.count for part in (a, b)]
    return Gaps(
        float(np.sqrt(np.mean(((a - b) / np.hypot(noise, own)) ** 2))),
        float(np.sqrt(np.mean(score))),
        (float(np.median(noise / b)), float((noise / b).max())),
        float(np.abs(a / b - 1).max()),
        float(np.abs(rings[0][1:] / rings[1][1:] - 1).max()),
        float((MEASURE @ a) / (MEASURE @ b) - 1),
    )


def table(title: str, ours, theirs: dict[str, np.ndarray], samples: int) -> list[str]:
    """Return the figures of all functions as Markdown."""
    lines = [
        f"## {title}",
        "",
        "| function | patches, in joint errors | values, in joint errors"
        " | its noise: median, worst patch | worst patch | worst ring | even light |",
        "|---|---|---|---|---|---|---|",
    ]
    for name in PARTS:
        g = gaps(ours.functions["visible", name], theirs[name], samples)
        lines.append(
            f"| {name.replace('_', ' ')} | {g.errors:.2f} | {g.matrix:.2f}"
            f" | {g.noise[0]:.2%}, {g.noise[1]:.2%} | {g.patch:.2%} | {g.ring:.2%}"
            f" | {g.even:+.2%} |"
        )
    return [*lines, ""]


def main() -> None:
    """Read the command line, trace, compare, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--samples", type=int, default=1 << 15)
    parser.add_argument("--peer", type=int, default=32_000)
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    os.environ.update(ENVIRONMENT)
    scene = cl.read_rad(options.data / "blinds.rad")
    file = cl.read_bsdf(options.data / "blinds.xml")
    ours = cl.generate_bsdf(
        scene, samples=options.samples, bounces=5, seed=1, geometry=False
    )
    lines = ["# The tutorial's blind, made again", "", f"{stamp()}.", ""]
    lines += [
        f"Ours: {options.samples:,} paths a patch. Rings but the one patch upright.",
        "",
    ]
    stored = {name: file.functions["visible", name].values for name in PARTS}
    lines += table("Its own file, 10,000 samples", ours, stored, MADE_WITH)
    begin = time.perf_counter()
    theirs = radiance(scene, options.peer)
    title = f"genBSDF's port, {options.peer:,} samples"
    lines += table(title, ours, theirs, options.peer)
    lines.append(f"The port took {time.perf_counter() - begin:.0f} s.")
    text = "\n".join(lines) + "\n"
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
