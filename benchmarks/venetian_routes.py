"""One blind by three routes: our tracing, genBSDF's port, WINDOW's radiosity.

    python benchmarks/venetian_routes.py [--folder docs/figures]

The comparison of the BSDF crash course (genBSDF, WINDOW, ASAP): a blind of 80 mm slats
every 72 mm, diffuse, reflectance 0.48; tilt 0° seen from Klems patch 64, and tilt 45°
from patch 122, counted from 1. Writes a figure for each tilt and a table.
"""

import argparse
import datetime
import os
from pathlib import Path

import numpy as np
import pyradiance
import pywincalc
from duel import ENVIRONMENT, stamp
from pyradiance.genbsdf import SamplingBox

import clerestory as cl
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdfgen.shading_system import System
from clerestory.bsdfgen.venetian_geometry import venetian
from clerestory.hemisphere.klems import klems
from clerestory.radiance.rad_writer import format_rad
from clerestory.report.bsdf_plot import lobe_figure, patch_direction

WIDTH, SPACING, REFLECTANCE = 0.08, 0.072, 0.48
CASES = ((0.0, 64), (45.0, 122))
FULL = klems("full")


def traced(tilt_deg: float) -> cl.Bsdf:
    """Return our BSDF of the endless blind."""
    blind = venetian(
        slat_width=WIDTH, spacing=SPACING, tilt_deg=tilt_deg, reflectance=REFLECTANCE
    )
    return cl.generate_bsdf(blind, samples=1 << 15, geometry=False, seed=1)


def radiance(tilt_deg: float) -> cl.Bsdf:
    """Return that of genBSDF's port, through a large sample's middle."""
    blind: System = venetian(
        slat_width=WIDTH,
        spacing=SPACING,
        tilt_deg=tilt_deg,
        reflectance=REFLECTANCE,
        slats=60,
        length=4.0,
    )
    low, high = blind.area.bounds
    part = SamplingBox(1.8, 2.2, 29 * SPACING, 31 * SPACING, low[2], high[2])
    made = pyradiance.generate_bsdf(
        format_rad(blind.scene, bsdf_file={}).encode(),
        params=["-ad", "1", "-lw", "1e-6", "-ab", "8"],
        nsamp=20000,
        nproc=os.cpu_count(),
        dim=part,
    )
    rows = [
        np.array(line.split(), float)
        for line in made.front.transmittance.decode().splitlines()
    ]
    table = np.array([row for row in rows if len(row)])
    return _bsdf(table / FULL.projected_solid_angles()[:, None], "Radiance")


def window(tilt_deg: float) -> cl.Bsdf:
    """Return that of WINDOW's engine: radiosity with each slat in ten segments."""
    paint = pywincalc.ProductDataOpticalDualBandHemispheric(
        0, 0, REFLECTANCE, REFLECTANCE, 0, 0, REFLECTANCE, REFLECTANCE, 1e-4
    )
    geometry = pywincalc.VenetianGeometry(
        tilt_deg, WIDTH, SPACING, 0.0, number_slat_segments=10
    )
    thermal = pywincalc.ProductDataThermal(160.0, 1e-4)
    blind = pywincalc.create_venetian_blind(geometry, paint, thermal)
    standard = Path(pywincalc.standard_path) / "W5_NFRC_2003.std"
    system = pywincalc.GlazingSystem(
        optical_standard=pywincalc.load_standard(str(standard)),
        solid_layers=[blind],
        bsdf_hemisphere=pywincalc.BSDFHemisphere.create(pywincalc.BSDFBasisType.FULL),
    )
    results = system.optical_method_results("PHOTOPIC").system_results
    return _bsdf(np.array(results.front.transmittance.matrix), "WINDOW")


def _bsdf(values: np.ndarray, name: str) -> cl.Bsdf:
    part = ScatteringMatrix(np.maximum(values, 0), FULL, FULL)
    return cl.Bsdf({("visible", "transmission_front"): part}, Product(name=name))


def main() -> None:
    """Read the command line, compute, draw, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("../docs/figures"))
    options = parser.parse_args()
    os.environ.update(ENVIRONMENT)
    lines = [
        f"### One blind by three routes{stamp()}, pywincalc. Transmission from the sky"
        " side; direct-hemispherical from one patch, diffuse, and the fraction of the"
        " light from that patch that leaves in other directions than ours.",
        "",
        "| tilt | patch | route | direct-hemispherical | diffuse | differs |",
        "|---|---|---|---|---|---|",
    ]
    measure = FULL.projected_solid_angles()
    for tilt_deg, patch in CASES:
        routes = {
            "Clerestory": traced(tilt_deg),
            "Radiance": radiance(tilt_deg),
            "WINDOW": window(tilt_deg),
        }
        tables = {
            name: bsdf.function("transmission_front").values
            for name, bsdf in routes.items()
        }
        first = tables["Clerestory"][:, patch - 1]
        for name, bsdf in routes.items():
            column = tables[name][:, patch - 1]
            differs = measure @ np.abs(column - first) / 2 / (measure @ first)
            lines.append(
                f"| {tilt_deg:g}° | {patch} | {name} | {measure @ column:.4f}"
                f" | {bsdf.diffuse('transmission_front'):.4f} | {differs:.1%} |"
            )
        figure = lobe_figure(
            list(routes.values()),
            [patch_direction(patch - 1, "transmission_front")],
            names=list(routes),
        )
        today = datetime.datetime.now(tz=datetime.UTC).date()
        figure.savefig(
            options.folder / f"venetian-{tilt_deg:.0f}.png",
            dpi=110,
            metadata={"Comment": f"benchmarks/venetian_routes.py, {today}"},
        )
    text = "\n".join(lines)
    print(text)
    (options.folder.parent / "benchmarks" / "venetian_routes.md").write_text(
        text + "\n"
    )


if __name__ == "__main__":
    main()
