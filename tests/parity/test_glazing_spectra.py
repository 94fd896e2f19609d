"""Spectral BSDFs of stacks against LBNL's engine at each wavelength, and Radiance.

pywincalc has no spectral results, but standards from files: here, one with a method for
each interval of wavelengths, under light of equal energy.
"""

import re

import numpy as np
import pytest
from radiance import run

from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.glazing.layer_files import read_layer
from clerestory.glazing.stack import stack_layers
from clerestory.hemisphere.klems import klems
from clerestory.spectral.band_sets import band_set, wavelength_bands

pytestmark = pytest.mark.filterwarnings(
    "ignore::clerestory.errors.ClerestoryWarning",
    "ignore::DeprecationWarning",
)

QUARTER = klems("quarter")
PARTS = {"transmission": "transmittance", "reflection": "reflectance"}
SOURCE = "Description: flat\nType: Source\nWavelength Units: Nanometers\n\n"
METHOD = """
Name : From{low}
Description : flat
Source Spectrum : flat.ssp
Detector Spectrum : None
Wavelength Set : Source
Integration Rule : Trapezoidal (Normalized, k=1.0)
Minimum Wavelength : {low}
Maximum Wavelength : {high}
"""

# Intervals of 5 nm, between wavelengths of which all products have data
LOW = np.arange(380, 780, 25)
BANDS = wavelength_bands(np.sort(np.append(LOW, LOW + 5)))


@pytest.fixture(scope="module")
def engine():
    return pytest.importorskip("pywincalc")


@pytest.fixture
def standard(engine, tmp_path):
    """A standard of pywincalc with a method for each interval."""
    rows = "".join(f"{nm} 1.0\n" for nm in range(380, 785, 5))
    (tmp_path / "flat.ssp").write_text(SOURCE + rows)
    methods = [METHOD.format(low=nm / 1000, high=(nm + 5) / 1000) for nm in LOW]
    head = "Standard Name: intervals\nStandard Description: intervals\n"
    (tmp_path / "intervals.std").write_text(head + "".join(methods))
    return engine.load_standard(str(tmp_path / "intervals.std"))


STACKS = (
    ["CLEAR_3.json", "nfrc_6046.json", "igsdb_product_364.json"],
    ["igsdb_5406.json", "CLEAR_3.json", "nfrc_21467.json"],
    ["nfrc_9223.json", "igsdb_product_364.json", "nfrc_18100.json"],
)


@pytest.mark.slow
@pytest.mark.parametrize("names", STACKS)
def test_three_panes_equal_pywincalc_at_every_wavelength(
    shared_data, engine, standard, names
):
    """Transmittances and reflectances of both sides, 380 to 780 nm, within 1e-4."""
    folder = shared_data / "glazing" / "wincalc" / "products"
    theirs = engine.GlazingSystem(
        optical_standard=standard,
        solid_layers=[
            engine.convert_to_solid_layer(engine.parse_json_file(str(folder / name)))
            for name in names
        ],
        gap_layers=[engine.Layers.gap(thickness=0.0127)] * 2,
    )
    ours = stack_layers(
        [read_layer(folder / name) for name in names], partition=QUARTER, bands=BANDS
    ).bsdf
    most = 0.0
    for nm in LOW:
        found = theirs.optical_method_results(f"From{nm / 1000}").system_results
        for name in FUNCTIONS:
            kind, side = name.split("_")
            part = getattr(getattr(found, side), PARTS[kind])
            value = ours.direct_hemispherical(name, channel=f"{nm}-{nm + 5} nm")[0]
            most = max(most, abs(value - part.direct_hemispherical))
    assert most < 1e-4


@pytest.mark.slow
def test_radiance_reads_the_visible_part_of_spectral_files(shared_data, tmp_path):
    """Other blocks of data are ignored by Radiance."""
    folder = shared_data / "glazing" / "wincalc" / "products"
    layers = [read_layer(folder / name) for name in STACKS[0]]
    scenes = []
    for bands in (None, band_set("9")):
        write_bsdf(
            tmp_path / "layer.xml",
            stack_layers(layers, partition=QUARTER, bands=bands).bsdf,
        )
        text = run("bsdf2rad layer.xml", folder=tmp_path)
        scenes.append(re.sub(r"\S+/rf\d+\.txt", "FILE", text))
    assert "WavelengthDataBlock" in (tmp_path / "layer.xml").read_text()
    assert scenes[0] == scenes[1]
