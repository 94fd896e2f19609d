"""Files that we write and insert, read and evaluated by pywincalc, WINDOW's engine."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.xml_insertion import insert_blocks
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems

wincalc = pytest.importorskip("pywincalc")

NAMES = {
    "transmission_front": "transmittance_front",
    "transmission_back": "transmittance_back",
    "reflection_front": "reflectance_front",
    "reflection_back": "reflectance_back",
}


def assert_read_alike(path, bsdf):
    measured = wincalc.parse_bsdf_xml_file(str(path)).measurements
    for channel in ("visible", "solar"):
        for ours, theirs in NAMES.items():
            data = np.array(getattr(getattr(measured, channel), theirs).data)
            np.testing.assert_array_equal(data, bsdf.functions[channel, ours].values)


def assert_evaluated_alike(path, bsdf):
    """A glazing system of this layer alone, weighted for the eye."""
    layer = wincalc.parse_bsdf_xml_file(str(path))
    # The thermal side of the engine wants to know all of these
    layer.conductivity, layer.ir_transmittance = 1.0, 0.0
    layer.emissivity_front = layer.emissivity_back = 0.84
    system = wincalc.GlazingSystem(
        optical_standard=wincalc.load_standard(),
        solid_layers=[layer],
        bsdf_hemisphere=wincalc.BSDFHemisphere.create(wincalc.BSDFBasisType.FULL),
    )
    sides = system.optical_method_results("PHOTOPIC").system_results
    for ours, theirs in NAMES.items():
        kind, side = theirs.split("_")
        found = getattr(getattr(sides, side), kind)
        part = bsdf.functions["visible", ours]
        scale = part.values.max()
        np.testing.assert_allclose(found.matrix, part.values, atol=1e-9 * scale)
        shares = bsdf.direct_hemispherical(ours)
        np.testing.assert_allclose(found.direct_hemispherical, shares, atol=1e-6)


def layer(seed):
    """A layer without symmetry that loses half of the light."""
    full, rng = klems("full"), np.random.default_rng(seed)
    even = full.projected_solid_angles()[:, None]
    functions = {}
    for channel in ("visible", "solar"):
        for name in FUNCTIONS:
            table = rng.random((145, 145)) ** 8
            table *= 0.25 / np.sum(even * table, axis=0)
            functions[channel, name] = ScatteringMatrix(table, full, full)
    return Bsdf(functions)


@pytest.mark.parametrize(
    "product", [Product(), Product("Blind", "Nobody", thickness=0.0123)]
)
def test_written_files_are_accepted_and_evaluated_alike(tmp_path, product):
    bsdf = replace(layer(1), product=product)
    write_bsdf(tmp_path / "layer.xml", bsdf)
    assert_read_alike(tmp_path / "layer.xml", bsdf)
    read = wincalc.parse_bsdf_xml_file(str(tmp_path / "layer.xml"))
    assert read.product_name.strip() == product.name
    assert read.thickness == pytest.approx(1000 * (product.thickness or 0))  # mm


@pytest.mark.slow
def test_inserted_files_are_accepted_and_evaluated_alike(tmp_path):
    write_bsdf(tmp_path / "template.xml", replace(layer(2), product=Product("Shade")))
    traced = layer(3)
    write_bsdf(tmp_path / "traced.xml", traced)
    out = tmp_path / "out.xml"
    insert_blocks(tmp_path / "traced.xml", tmp_path / "template.xml", out)
    assert_read_alike(out, traced)
    assert_evaluated_alike(out, traced)


@pytest.mark.parametrize("name", ["ven45.xml", "clear.xml"])
def test_files_that_the_engine_refuses_are_accepted_once_we_have_written_them(
    shared_data, tmp_path, name
):
    """These name no manufacturer, on which pywincalc 3.3.1 ends with a fault."""
    bsdf = read_bsdf(shared_data / "bsdf" / "pyradiance_tutorial" / name)
    write_bsdf(tmp_path / name, bsdf)
    assert_read_alike(tmp_path / name, bsdf)


def test_a_layer_inserted_into_a_file_of_window(shared_data, tmp_path):
    """genBSDF's slats as a shade of WINDOW: data of one file, all else of the other."""
    folder, out = shared_data / "bsdf", tmp_path / "out.xml"
    source = folder / "wincalc" / "SquareSlat_genBSDF.xml"
    template = folder / "wincalc" / "shade_full.xml"
    insert_blocks(source, template, out)
    assert_read_alike(out, read_bsdf(source))
    read = wincalc.parse_bsdf_xml_file(str(out))
    assert read.emissivity_front == pytest.approx(0.79626)
