"""Small input files and values that several tests share."""

import importlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

# A pane in version 1 of the IGSDB's JSON
PRODUCT = {
    "name": "Test glass",
    "nfrc_id": 7,
    "type": "glazing",
    "subtype": "monolithic",
    "coated_side": "Neither",
    "manufacturer_name": "Nobody",
    "measured_data": {
        "thickness": 4.0,
        "conductivity": 1.0,
        "emissivity_front": 0.84,
        "emissivity_back": 0.2,
        "tir_front": 0.0,
    },
    "spectral_data": {
        "spectral_data": [
            {"T": 0.8, "Rf": 0.1, "Rb": 0.15, "wavelength": 0.3},
            {"T": 0.6, "Rf": 0.2, "Rb": 0.25, "wavelength": 2.5},
        ]
    },
}

# A mapping file of a grid scan of four points
SCAN = """utc_offset_hours = -6
[layout.room]
columns = ["north", "south"]
column_axis = "y"
column_at = [3.0, 1.0]
row_at = [0.5, 1.5]
height = 0.75
factor = 1000
grid = "lux"
[[scan]]
file = "nine.csv"
at = 2024-06-26T09:00:00
layout = "room"
row_minutes = 2
backwards = true
"""

# A station file, and the measurements that it names
STATION = """file = "roof.csv"
stands_for = "end"
separator = ";"
[site]
latitude_deg = 50.0
longitude_deg = 8.5
utc_offset_hours = 1
place = "roof"
[columns]
time = ["day", "clock"]
global_horizontal = "GHI"
diffuse_horizontal = "DHI"
"""
ROOF = "day;clock;GHI;DHI\n2022-06-21;12:00;700;120\n2022-06-21;12:05;710;118\n"

# Three shade states of a window, which `write_states` writes
STATES = """
[[window.state]]
name = "open"
bsdf = "open.xml"
[[window.state]]
name = "half"
bsdf = "half.xml"
[[window.state]]
name = "closed"
bsdf = "closed.xml"
"""


def four_sensors() -> Any:
    """Return the series of a study with the four sensors of `SCAN`, along y first."""
    series = importlib.import_module("clerestory.comparison.series").Series
    places = [(0.5, 1, 0.75), (0.5, 3, 0.75), (1.5, 1, 0.75), (1.5, 3, 0.75)]
    hours = np.array(["2024-06-26T08:30", "2024-06-26T09:30"], "datetime64[s]")
    names = tuple(f"lux.{i}" for i in range(1, 5))
    values, position = np.ones((4, 2)), np.array(places)
    return series(names, hours, values, 60.0, -6.0, position=position)


def write_states(folder: Path, transmittances: Sequence[float]) -> None:
    """Write the diffusing layers of `STATES`."""
    analytic = importlib.import_module("clerestory.bsdf.analytic")
    klems = importlib.import_module("clerestory.hemisphere.klems")
    writer = importlib.import_module("clerestory.bsdf.xml_writer")
    for name, tau in zip(("open", "half", "closed"), transmittances, strict=True):
        layer = analytic.lambertian(tau, klems.klems("quarter"))
        writer.write_bsdf(folder / f"{name}.xml", layer)
