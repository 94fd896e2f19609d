r"""Make the BSDFs of the study: the blind behind its glazing, in four tilts.

    python studies/crash_course_day/blinds/make_blinds.py [FOLDER]

writes tilt_0.xml, tilt_20.xml, tilt_40.xml and tilt_70.xml, in half a minute on two
cores; the values are the same in every run on one kind of device. It is what

    clerestory bsdf generate system.rad --periodic --sides front \
        --dim 0 1 0 1.008 -0.15 0

does with each tilt in system.rad, kept short: transmission from outside, four digits.
"""

import sys
import tempfile
from pathlib import Path

import clerestory as cl
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.shading_system import System, area_from_dimensions

HERE = Path(__file__).parent
TILTS_DEG = (0, 20, 40, 70)
AREA = (0.0, 1.0, 0.0, 1.008, -0.15, 0.0)
SAMPLES = 16384
DIGITS = 4


def blind(tilt_deg: int) -> Bsdf:
    """Return the transmission of the blind and its glazing, from outside."""
    text = (HERE / "system.rad").read_text().replace("TILT", str(tilt_deg))
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "system.rad")
        file.write_text(text)
        scene = cl.read_rad(file)
    system = System(scene, area_from_dimensions(AREA, periodic=True))
    traced = cl.generate_bsdf(
        system, sides="front", samples=SAMPLES, seed=1, geometry=False, device="cpu"
    )
    product = Product(
        name=f"Outer blind at {tilt_deg} degrees, double glazing",
        manufacturer="Clerestory",
        device_type="Venetian Blinds",
        thickness=AREA[5] - AREA[4],
    )
    part = traced.functions["visible", "transmission_front"]
    return Bsdf({("visible", "transmission_front"): part}, product)


def main() -> None:
    """Write the files into the folder of the first argument, or beside this one."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE
    for tilt in TILTS_DEG:
        comment = "Made by studies/crash_course_day/blinds/make_blinds.py"
        name = f"tilt_{tilt}.xml"
        write_bsdf(folder / name, blind(tilt), digits=DIGITS, comment=comment)


if __name__ == "__main__":
    main()
