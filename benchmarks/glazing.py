"""How far stacked glazing is from LBNL's WINDOW engine, and how long both take.

    python benchmarks/glazing.py DATA [--stacks] [--shade FILE] [--write FILE]

DATA is a folder with LBNL's products and expected results (`wincalc/products`,
`wincalc/expected`). With --stacks, stacks are computed by pywincalc too, which takes
minutes. Differences are the largest of all directions, sides and both bands, absolute.

LBNL's results of several layers (`tests/parity/wincalc_systems.py`) are asked whether
what passes, what goes back and what layers keep make up all light. Its four layers are
made again if `test/products/shade_full.xml` of its repository is given as --shade.
"""

import argparse
import json
import sys
import time
import warnings
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pywincalc as engine
from duel import stamp

from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.errors import ClerestoryWarning
from clerestory.glazing.layer_files import read_layer
from clerestory.glazing.stack import StackedLayers, stack_layers
from clerestory.hemisphere.klems import klems

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "parity"))
from wincalc_systems import FOUR_LAYERS, SCATTERING

QUARTER = klems("quarter")
METHODS = {"solar": "solar", "visible": "photopic"}
PARTS = {"transmission": "transmittance", "reflection": "reflectance"}
SINGLE = {
    "nfrc_102": "CLEAR_3.json",
    "cgdb_31017": "ILC2019_1_LaminateDiffuseInterlayer.txt",
    "cgdb_31018": "ILC2019_2_LowEonFrits.txt",
    "perforated_screen_cgdb_18000": "cgdb_18000.json",
    "venetian_cgdb_24000": "cgdb_24000*.json",
    "venetian_cgdb_24001": "cgdb_24001*.json",
    "venetian_cgdb_24002": "cgdb_24002*.json",
    "woven_shade": "woven_shade.json",
}
STACKS = {
    "clear, clear": ["CLEAR_3.json", "igsdb_product_364.json"],
    "three clear panes": ["CLEAR_3.json", "igsdb_product_364.json", "igsdb_5406.json"],
    "perforated screen, clear": ["cgdb_18000.json", "CLEAR_3.json"],
    "clear, woven cloth": ["CLEAR_3.json", "woven_shade.json"],
    "low-e, clear": ["nfrc_2191.json", "CLEAR_3.json"],
    "clear, venetian at 45°": ["CLEAR_3.json", "cgdb_24002*.json"],
}


def product(data: Path, pattern: str) -> Path:
    """Return a product by its name."""
    return sorted((data / "wincalc" / "products").glob(pattern))[0]


def single(data: Path, case: str) -> tuple[float, float, float]:
    """Return the largest differences of one layer: shares, matrix flux, absorptance."""
    stacked = stack_layers([read_layer(product(data, SINGLE[case]))], partition=QUARTER)
    folder = data / "wincalc" / "expected" / "1_layer" / case / "quarter_basis"
    measure = QUARTER.projected_solid_angles()
    share = flux = kept = 0.0
    for channel, method in METHODS.items():
        file = folder / "full_spectrum" / "theta=0_phi=0" / f"{method}.json"
        theirs = json.loads(file.read_text())
        for name in FUNCTIONS:
            kind, side = name.split("_")
            table = np.array(theirs["system_results"][side][PARTS[kind]]["matrix"])
            gap = stacked.bsdf.function(name, channel=channel).values - table
            share = max(share, float(np.abs(measure @ gap).max()))
            flux = max(flux, float(np.abs(measure[:, None] * gap).max()))
        for side in ("front", "back"):
            truth = theirs["layer_results"]["layer 0"][side]["absorptance"]
            ours = stacked.absorptance[channel, side][0, 0]
            kept = max(kept, abs(float(ours) - truth["total_direct"]))
    return share, flux, kept


def pair(data: Path, names: list[str]) -> tuple[float, float, float, float]:
    """Return the largest differences of a stack, and seconds of both engines."""
    files = [product(data, name) for name in names]
    parsed = [
        engine.parse_json_file(str(f))
        if f.suffix == ".json"
        else engine.parse_optics_file(str(f))
        for f in files
    ]
    begin = time.perf_counter()
    system = engine.GlazingSystem(
        [engine.convert_to_solid_layer(one) for one in parsed],
        [engine.Layers.gap(thickness=0.0127)] * (len(files) - 1),
        bsdf_hemisphere=engine.BSDFHemisphere.create(engine.BSDFBasisType.QUARTER),
    )
    results = {c: system.optical_method_results(m.upper()) for c, m in METHODS.items()}
    theirs = time.perf_counter() - begin
    layers = [read_layer(file) for file in files]
    begin = time.perf_counter()
    stacked = stack_layers(layers, partition=QUARTER)
    ours = time.perf_counter() - begin
    return *differences(results, stacked), theirs, ours


def differences(results: dict, stacked: StackedLayers) -> tuple[float, float]:
    """Return the largest differences of shares and of absorptances."""
    measure = QUARTER.projected_solid_angles()
    share = kept = 0.0
    for channel, result in results.items():
        for name in FUNCTIONS:
            kind, side = name.split("_")
            part = getattr(getattr(result.system_results, side), PARTS[kind])
            found = stacked.bsdf.function(name, channel=channel).values
            gap = measure @ (found - np.array(part.matrix))
            share = max(share, float(np.abs(gap).max()))
        for number, layer in enumerate(result.layer_results):
            for side in ("front", "back"):
                truth = np.array(getattr(layer, side).absorptance.angular_total)
                gap = stacked.absorptance[channel, side][number] - truth
                kept = max(kept, float(np.abs(gap).max()))
    return share, kept


def sums() -> list[str]:
    """Return what the shares of LBNL's own results of several layers add up to."""
    few = [
        abs(along[side] + along[side + 2] + sum(kept[side]) - 1)
        for along, _, kept in SCATTERING.values()
        for side in (0, 1)
    ]
    lines = ["", "## Whether LBNL's expected shares add up", ""]
    lines += ["| layers | light | what passes, goes back and is kept, in all |"]
    lines += ["|---|---|---|"]
    lines.append(f"| two and three | {len(few)} cases | 1, to {max(few):.0e} |")
    for (channel, side), (passed, thrown, kept) in FOUR_LAYERS.items():
        lines.append(
            f"| four | {channel}, {side} | {passed + thrown + sum(kept):.4f} |"
        )
    return [*lines, "", "Ours add up to 1 by construction, which tests show."]


def four(data: Path, shade: Path) -> list[str]:
    """Return what ours are off LBNL's results of four layers, along the normal."""
    panes = ("nfrc_9962.json", "CLEAR_3.json", "nfrc_11561.json")
    layers = [read_layer(file) for file in (*(product(data, n) for n in panes), shade)]
    stacked = stack_layers(layers, partition=klems("full"))
    lines = [
        "",
        "| light on four layers | passes | goes back | shade keeps | panes keep |",
    ]
    lines += ["|---|---|---|---|---|"]
    for (channel, side), (passed, thrown, kept) in FOUR_LAYERS.items():
        t, r = (
            stacked.direct_hemispherical(f"{kind}_{side}", channel=channel)[0]
            for kind in PARTS
        )
        off = stacked.absorptance[channel, side][:, 0] - kept
        lines.append(
            f"| {channel}, {side} | {t - passed:+.6f} | {r - thrown:+.6f}"
            f" | {off[-1]:+.6f} | {' '.join(f'{pane:+.4f}' for pane in off[:-1])} |"
        )
    return [*lines, "", "Ours less LBNL's, along the normal."]


def main() -> None:
    """Read the command line, compare, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--stacks", action="store_true")
    parser.add_argument("--shade", type=Path, help="WinCalc's shade_full.xml")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    warnings.simplefilter("ignore", ClerestoryWarning)
    lines = ["# Glazing and WINDOW", "", f"{stamp()}.", ""]
    lines += ["## Single layers, against LBNL's expected results", ""]
    lines += ["| layer | shares | flux, patch to patch | absorptance |"]
    lines += ["|---|---|---|---|"]
    for case in SINGLE:
        a, b, c = single(options.data, case)
        lines.append(f"| {case} | {a:.5f} | {b:.5f} | {c:.5f} |")
    lines += sums()
    if options.shade:
        lines += four(options.data, options.shade)
    if options.stacks:
        lines += ["", f"## Stacks, against pywincalc {version('pywincalc')}", ""]
        lines += ["| stack | shares | absorptance | pywincalc [s] | ours [s] |"]
        lines += ["|---|---|---|---|---|"]
        for title, names in STACKS.items():
            a, b, s, o = pair(options.data, names)
            lines.append(f"| {title} | {a:.5f} | {b:.5f} | {s:.1f} | {o:.2f} |")
        lines += [
            "",
            "The engine in this wheel is older than LBNL's expected results: its",
        ]
        lines += ["coated panes and its blinds differ equally from them and from ours."]
        lines += ["Times are of one run each, on a shared machine."]
    print("\n".join(lines))
    if options.write:
        options.write.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
