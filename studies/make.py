"""Make the weather and the BSDFs that the gallery's studies share.

    python studies/make.py

writes greensboro.wea, from the TMY3 year of Greensboro, North Carolina (NREL, in the
public domain) that pvlib carries, and bsdf/*.xml by tracing parametric systems; a
minute on two cores. The values are the same in every run on one kind of device.
"""

import importlib.resources
from pathlib import Path

import numpy as np

import clerestory as cl
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.system_catalogue import make_system

HERE = Path(__file__).parent
# Name of the file: kind, numbers, basis, samples
BSDFS = {
    "clear": ("clear_pane", {"transmissivity": 0.80}, "full", 4096),
    "film": ("mirrored_channels", {}, "full", 16384),
    "microlouvre": ("microlouvre", {}, "full", 16384),
    "opal": ("diffuse_pane", {"transmittance": 0.45}, "quarter", 8192),
    "screen": ("fabric", {"openness": 0.05, "reflectance": 0.45}, "full", 8192),
}
DIGITS = 4


def wea() -> str:
    """Return the weather as a WEA file: hours by the middle, direct, diffuse [W/m²]."""
    folder = importlib.resources.files("pvlib") / "data"
    with importlib.resources.as_file(folder / "723170TYA.CSV") as file:
        year = cl.read_weather(file)
    lines = [
        "place Greensboro",
        f"latitude {year.latitude_deg:.2f}",
        f"longitude {-year.longitude_deg:.2f}",
        f"time_zone {-15 * year.utc_offset_hours:.0f}",
        f"site_elevation {year.elevation:.0f}",
        "weather_data_file_units 1",
    ]
    days = year.times.astype("datetime64[D]")
    hours = (year.times - days) / np.timedelta64(3600, "s")
    values = zip(days, hours, year.direct_normal, year.diffuse_horizontal, strict=True)
    for day, hour, direct, diffuse in values:
        _, month, number = str(day).split("-")
        lines.append(
            f"{int(month)} {int(number)} {hour:.1f} {direct:.0f} {diffuse:.0f}"
        )
    return "\n".join(lines) + "\n"


def bsdf(name: str) -> Bsdf:
    """Return the transmission of a system for light from outside."""
    kind, numbers, basis, samples = BSDFS[name]
    traced = cl.generate_bsdf(
        make_system(kind, numbers), basis=basis, sides="front", samples=samples,
        seed=1, geometry=False, device="cpu",
    )  # fmt: skip
    part = traced.functions["visible", "transmission_front"]
    product = Product(name=name, manufacturer="Clerestory", device_type="Other")
    return Bsdf({("visible", "transmission_front"): part}, product)


if __name__ == "__main__":
    (HERE / "greensboro.wea").write_text(wea())
    for name in BSDFS:
        write_bsdf(HERE / "bsdf" / f"{name}.xml", bsdf(name), digits=DIGITS)
