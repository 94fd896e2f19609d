"""A year of hourly pictures reduced to numbers, without a picture written.

    python benchmarks/picture_year.py [--steps 32] [--write FILE]

V T D S of as many pixels as asked for, step by step, each picture reduced to its
vertical illuminance and to mean, median and highest luminance. Time grows with the
pixels and the steps: some steps are measured, and the 4,400 hours of light of a year
told from them. Matrices are made up, as their numbers do not change the time.
"""

import argparse
import resource
import time
from pathlib import Path

import numpy as np
from duel import stamp

import clerestory as cl
from clerestory.hemisphere.klems import klems
from clerestory.image.camera import Camera
from clerestory.matrix.axis import pixel_axis, sky_axis, window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_equation import Skies, WindowMatrices, window_chain
from clerestory.phases.methods import THREE_PHASE
from clerestory.phases.picture_series import pictures_over_time
from clerestory.scene.view import View
from clerestory.sky.patch_radiance import SkyMatrix

SIZES = (200, 400, 800)
HOURS = 4400
EYE = View(kind="angular", horizontal=180, vertical=180)


def sky(steps: int) -> SkyMatrix:
    """Return clear skies of some minutes of June."""
    times = np.datetime64("2023-06-21T09:00", "m") + np.arange(steps)
    weather = cl.Weather(
        place="Oakland", latitude_deg=37.7, longitude_deg=-122.2, elevation=0.0,
        utc_offset_hours=-8.0, times=times, step_minutes=1.0,
        direct_normal=np.full(steps, 700.0), diffuse_horizontal=np.full(steps, 120.0),
        source="clear minutes",
    )  # fmt: skip
    return cl.sky_matrix(weather, subdivision=4)


def window(pixels: int, partition) -> WindowMatrices:
    """Return one window whose V is kept as studies keep it: half precision, grey."""
    patches = klems("full")
    rng = np.random.default_rng(1)
    size = (1, pixels, len(patches))
    view = rng.random(size, dtype=np.float32).astype(np.float16)
    inner = window_axis("interior", patches)
    outer = window_axis("exterior", patches)
    transmission = TransferMatrix(np.full((1, 145, 145), 1e-3), inner, outer)
    columns = sky_axis(partition)
    daylight = TransferMatrix(np.full((1, 145, columns.size), 1e-3), outer, columns)
    return WindowMatrices(
        window_chain(
            TransferMatrix(view, pixel_axis(pixels), inner), transmission, daylight
        )
    )


def measure(size: int, steps: int) -> tuple[float, float]:
    """Return wall and processor time of a step [s]."""
    whole = sky(steps)
    part = window(size * size, whole.partition)
    camera = Camera(EYE, size, size)
    weights = np.maximum(EYE.rays(size, size).direction @ EYE.direction, 0).ravel()

    start, before = time.perf_counter(), time.process_time()
    for picture in pictures_over_time([part], THREE_PHASE, camera, Skies(whole)):
        luminance = picture.luminance().ravel()
        luminance @ weights, luminance.mean(), np.median(luminance), luminance.max()
    wall, processor = time.perf_counter() - start, time.process_time() - before
    return wall / steps, processor / steps


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=32)
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    lines = [
        "### A year of pictures reduced to numbers, three phases",
        "",
        f"{stamp()}; {options.steps} steps of each. Made by"
        " `benchmarks/picture_year.py`.",
        "",
        f"| pixels | ms a step, wall | processor | year of {HOURS:,} hours, wall |"
        " processor | most memory |",
        "|---|---|---|---|---|---|",
    ]
    for size in SIZES:
        wall, processor = measure(size, options.steps)
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        lines.append(
            f"| {size} × {size} | {1000 * wall:.0f} | {1000 * processor:.0f} |"
            f" {wall * HOURS / 60:.1f} min | {processor * HOURS / 60:.1f} min |"
            f" {memory:.2f} GB |"
        )
    lines += [
        "The five-phase method also multiplies the direct part, and adds the suns of"
        " each step, which are traced while the pictures are computed.",
    ]
    text = "\n".join(lines) + "\n"
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
