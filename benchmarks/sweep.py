"""Cost of a sweep of 24 variants, tilt × glass × reflectance, against one run.

The room is that of the demo, with a year of three-phase illuminance and metrics. Both
commands run in processes of their own; processor time includes child processes. The
figures of `docs/benchmarks/sweep.md` are made by

    python benchmarks/sweep.py
"""

import argparse
import platform
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import clerestory as cl
from clerestory.bsdf.analytic import thin_pane
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.venetian_geometry import venetian
from clerestory.hemisphere.klems import klems
from clerestory.study.new_study import write_demo

TILTS = (0, 20, 40, 60)
GLASSES = {"clear": 0.98, "grey": 0.6, "dark": 0.35}

SWEEP = """
[sweep]
tilt = [0, 20, 40, 60]
glass = ["clear", "grey", "dark"]
scene.files = [["materials.rad", "room.rad"], ["dark.rad", "room.rad"]]
"""


def write_study(folder, method):
    """Write the study of one run and that of the sweep; return both paths."""
    demo = write_demo(folder)
    partition = klems("full")
    for glass, share in GLASSES.items():
        write_bsdf(folder / f"{glass}.xml", thin_pane(share, partition, panes=2))
    for tilt in TILTS:
        slats = venetian(slat_width=0.08, spacing=0.072, tilt_deg=tilt, reflectance=0.6)
        write_bsdf(folder / "blind.xml", cl.generate_bsdf(slats, samples=256, seed=1))
        for glass in GLASSES:
            layers = [
                cl.read_layer(folder / f"{name}.xml") for name in (glass, "blind")
            ]
            both = cl.stack_layers(layers, method="bands").bsdf
            write_bsdf(folder / f"{glass}_{tilt}.xml", both)
    text = demo.read_text().replace("ill = true", "ill = false")
    text = text.replace('"3-phase"', f'"{method}"')
    darker = (folder / "materials.rad").read_text().splitlines()
    (folder / "dark.rad").write_text("\n".join(map(halved, darker)) + "\n")
    one, sweep = folder / "one.toml", folder / "sweep.toml"
    one.write_text(text.replace("venetian_blind", "clear_0"))
    sweep.write_text(text.replace("venetian_blind", "{glass}_{tilt}") + SWEEP)
    return one, sweep


def halved(line):
    """Halve the reflectance in a line of numbers of a plastic."""
    words = line.split()
    if len(words) == 6 and words[0] == "5":
        shares = [f"{0.5 * float(word):g}" for word in words[1:4]]
        return " ".join(["5", *shares, *words[4:]])
    return line


def processor_seconds(study):
    """Run a study with the command line; return its processor time [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    call = "import sys; from clerestory.cli.main import main; sys.exit(main())"
    out = study.with_suffix("")
    shutil.rmtree(out, ignore_errors=True)
    words = [sys.executable, "-c", call, "run", study, "--out", out, "--quiet"]
    subprocess.run(words, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    memory = after.ru_maxrss / 1e6
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, memory


def main():
    """Print processor time of one run and of the sweep, and their ratio."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--method", default="3-phase")
    options.add_argument("--repeat", type=int, default=3)
    given = options.parse_args()
    print(platform.machine(), "numpy", np.__version__, "clerestory", cl.__version__)
    with tempfile.TemporaryDirectory() as folder:
        one, sweep = write_study(Path(folder), given.method)
        for _ in range(given.repeat):
            single, _ = processor_seconds(one)
            every, memory = processor_seconds(sweep)
            print(
                f"one run {single:.1f} CPU s, 24 variants {every:.1f} CPU s, ratio"
                f" {every / single:.2f}, peak memory {memory:.2f} GB"
            )


if __name__ == "__main__":
    main()
