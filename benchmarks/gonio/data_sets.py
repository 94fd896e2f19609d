"""Measurements in one plane, for trees of rank 3."""

from clerestory.gonio.measurement_files import read_measurement
from goniometer import Goniophotometer, pane, rings


def data_sets(folder):
    """Yield names and measurements in one plane, for trees of rank 3."""
    layer = Goniophotometer().measure(pane, rings(azimuths_deg=[0], step_deg=10.0))
    yield "rough pane (virtual)", layer
    eds = sorted((folder / "viavi_eds10").glob("EDS10 *-0.txt"))
    yield "EDS10", read_measurement(*eds)[0]
    for name, file in (
        ("AnoBlack EC1", "AnoBlackEC1onAlum.bsdf"),
        ("NiTE on steel", "NiTE_on_steel_v1o0A_20250915.xls"),
        ("BrownVinyl", "ValidationTest_of_TIS_via_BrownVinyl.bsdf"),
    ):
        yield name, read_measurement(folder / "rt300s" / file)[0]
