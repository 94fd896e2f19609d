"""Precomputed window emitters (mkillum): gain in work at equal error, and their bias.

    python benchmarks/illum.py [--bsdf FILE] [--samples 256] [--write FILE]

The illuminance of the tutorial room's sensors behind a BSDF, under sun and sky, with
the window as it is and as a precomputed emitter. The gain is time × variance without,
divided by that with the emitter; the time to compute its tables is listed separately.
"""

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from duel import stamp
from rooms import room, workplace
from sun_matrix import SHARED

import clerestory as cl
from clerestory.phases.rendering import irradiance
from clerestory.scene.model import BsdfSurface, Glass, Material, Polygon

SKIES = {"sun": "gensky -ang 50 0 +s", "overcast": "gensky -ang 50 0 -c"}
REFERENCE = 32


def timed(work: Callable[[], object]) -> tuple[object, float]:
    """Return what work returns, and its processor time [s]."""
    begin = time.process_time()
    made = work()
    return made, time.process_time() - begin


def rows(material: Material, name: str, samples: int) -> list[str]:
    """Return rows of the table for a window."""
    place = room(workplace())
    panes = cl.Scene(
        {"pane": material},
        tuple(
            Polygon(p.vertices, "pane", f"pane{i}")
            for i, p in enumerate(cl.read_window(place.window).polygons)
        ),
    )
    sensors = cl.read_sensors(place.points)
    lines = []
    for sky, command in SKIES.items():
        here = place.scene() + cl.sky_scene(command)
        lamps, tables = timed(
            lambda scene=here: cl.precompute_illums(
                scene, panes, samples=64, device="cpu"
            )
        )

        def gathered(windows: cl.Scene, count: int, scene: cl.Scene = here):
            return irradiance(
                scene + windows, sensors, samples=count, seed=1, device="cpu"
            )

        found = []
        for windows in (panes, lamps):
            gathered(windows, 16)  # compile
            found.append(timed(lambda w=windows: gathered(w, samples)))
        truth = gathered(panes, REFERENCE * samples).illuminance()
        cost = [
            np.median((m.error / m.irradiance.mean()) ** 2) * seconds
            for m, seconds in found
        ]
        noise = [np.median(m.error / m.irradiance) for m, _ in found]
        bias = found[1][0].illuminance().sum() / truth.sum()
        lines.append(
            f"| {name} | {sky} | {found[0][1]:.2f} s, {noise[0]:.1%}"
            f" | {found[1][1]:.2f} s, {noise[1]:.1%} | {cost[0] / cost[1]:.2f}"
            f" | {tables:.1f} s | {bias:.4f} |"
        )
        print(lines[-1], flush=True)
    return lines


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bsdf", type=Path, help="BSDF file of the window")
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    file = options.bsdf or SHARED / "tutorial_room" / "blinds" / "blinds.xml"
    upright = np.array([0.0, 0.0, 1.0])
    windows = {
        "glass": Glass("pane", np.full(3, 0.88)),
        file.name: BsdfSurface("pane", cl.read_bsdf(file), 0.0, upright),
    }
    lines = [
        "### Precomputed window emitters",
        "",
        stamp(),
        "",
        f"Sensors of the tutorial room, {options.samples} paths each.",
        "",
        "| window | sky | window: time, noise | lamp: time, noise | gain | tables"
        " | lamp over window |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, material in windows.items():
        lines += rows(material, name, options.samples)
    if options.write:
        options.write.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
