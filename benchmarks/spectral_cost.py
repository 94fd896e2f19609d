"""Processor time of V and D of the demo by number of bands, relative to RGB.

    python benchmarks/spectral_cost.py [--samples 4096 32768] [--rounds 5]
        [--write FILE]

The demo room with red carpet and oak desks of `spectral_bands.py`. Band sets take turns
in each round, so that other work on the machine slows all of them alike; the first
round, in which kernels are compiled or loaded, is not counted.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from duel import stamp
from spectral_bands import DEMO, NM, SPECTRA

import clerestory as cl
from clerestory.bands import RGB, Bands
from clerestory.spectra import Spectrum

CHOICES: dict[str, Bands] = {
    "RGB": RGB,
    "melanopic+photopic": cl.band_set("melanopic+photopic"),
    "9": cl.band_set("9"),
    "20": cl.band_set("20"),
    "81": cl.band_set("81"),
}

# Intervals of Radiance's red, green and blue [nm]
THREE = cl.wavelength_bands([380, 480, 588, 780])
SENSORS = ("desks.pts", "eyes.pts")


def main() -> None:
    """Trace in turns, and print or write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, nargs="+", default=[1 << 12, 1 << 15])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    text = page(given.samples, given.rounds)
    if given.write:
        given.write.write_text(text, encoding="utf-8")
    print(text)


def page(samples: list[int], rounds: int) -> str:
    """Return the page with a row for each number of samples."""
    lines = [
        "# Cost of spectral bands",
        "",
        f"{stamp()}. Made by `benchmarks/spectral_cost.py`.",
        "",
        "View matrix of desks and eyes and daylight matrix (MF:1) of the demo room with"
        " red carpet and",
        f"oak desks. Processor seconds of both, medians of {rounds} rounds in which the"
        " band sets take turns;",
        "in brackets relative to RGB, the median and the range of the ratios within"
        " a round.",
        "",
        f"| samples | {' | '.join(CHOICES)} |",
        "|---|" + "---|" * len(CHOICES),
    ]
    for count in samples:
        found = seconds(count, rounds)
        cells = " | ".join(cell(found, name) for name in CHOICES)
        lines.append(f"| {count:,} | {cells} |")
    return "\n".join([*lines, ""])


def cell(found: dict[str, np.ndarray], name: str) -> str:
    """Return the median time of a band set, and its ratio to RGB."""
    whole = found[name].sum(axis=1)
    text = f"{np.median(whole):.2f} s"
    if name == "RGB":
        return text
    ratio = whole / found["RGB"].sum(axis=1)
    return f"{text} ({np.median(ratio):.2f}×; {ratio.min():.2f} to {ratio.max():.2f}×)"


def seconds(samples: int, rounds: int) -> dict[str, np.ndarray]:
    """Return the processor seconds of each round, of V and of D."""
    scenes = {name: room(bands) for name, bands in CHOICES.items()}
    found: dict[str, list] = {name: [] for name in CHOICES}
    for number in range(rounds + 1):
        for name, scene in scenes.items():
            one = matrices(scene, samples)
            if number:
                found[name].append(one)
    return {name: np.array(rows) for name, rows in found.items()}


def room(bands: Bands):
    """Return the coloured demo room in bands."""
    spectra = {name: Spectrum(NM, np.array(value)) for name, value in SPECTRA.items()}
    files = (DEMO / name for name in ("materials.rad", "room.rad", "workstation.rad"))
    intervals = THREE if bands == RGB else bands
    scene = cl.in_bands(cl.read_rad(*files), intervals, spectra=spectra)
    return replace(scene, bands=bands)


def matrices(scene, samples: int) -> tuple[float, float]:
    """Trace V and D, and return the processor seconds of each."""
    window = cl.read_window(DEMO / "window.rad")
    sensors = [cl.read_sensors(DEMO / name) for name in SENSORS]
    begin = time.process_time()
    for some in sensors:
        cl.view_matrix(scene, window, sensors=some, samples=samples)
    middle = time.process_time()
    cl.daylight_matrix(scene, window, subdivision=1, samples=samples)
    return middle - begin, time.process_time() - middle


if __name__ == "__main__":
    main()
