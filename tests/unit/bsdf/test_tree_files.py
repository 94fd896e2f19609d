"""Tensor trees in XML files: read, written, refused, in colour."""

import warnings

import numpy as np
import pytest

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.resample import reciprocal_mean, to_matrices, to_trees
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import reduce_tree
from clerestory.bsdf.tree_parser import parse_tree
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.colorimetry import rgb_from_xyz
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.hemisphere.klems import klems

FILE = """Recover using: genBSDF
<?xml version="1.0"?>
<WindowElement><Optical><Layer>
<DataDefinition><IncidentDataStructure>TensorTree3</IncidentDataStructure>
</DataDefinition>
<WavelengthData><Wavelength>Visible</Wavelength><WavelengthDataBlock>
<WavelengthDataDirection>Transmission Back</WavelengthDataDirection>
<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>
<ScatteringData>
{ .1 .1 .1
.1 .2 .2 .2 .2 }
</ScatteringData></WavelengthDataBlock></WavelengthData>
<WavelengthData><Wavelength>Visible</Wavelength><WavelengthDataBlock>
<WavelengthDataDirection>Reflection Back</WavelengthDataDirection>
<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>
<ScatteringData>{ 0.05 }</ScatteringData>
</WavelengthDataBlock></WavelengthData>
</Layer></Optical></WindowElement>
"""


def tree(values, rank=4):
    text = "{" + " ".join(map(str, np.ravel(values))) + "}"
    table = parse_tree(text.encode(), rank=rank)
    return ScatteringTree(table.slots, rank, table.depth)


def random_tree(seed, rank=4, most=0.2):
    return tree(np.random.default_rng(seed).random((4,) * rank) * most, rank)


@pytest.fixture
def path(tmp_path):
    (tmp_path / "tree.xml").write_text(FILE)
    return tmp_path / "tree.xml"


def test_file_with_trees_is_read(path):
    bsdf = read_bsdf(path)
    assert list(bsdf.functions) == [
        ("visible", "transmission_back"),
        ("visible", "reflection_back"),
    ]
    assert len(bsdf.notes) == 1
    part = bsdf.functions["visible", "transmission_back"]
    assert (part.rank, part.depth) == (3, 1)
    # Incident light from the room; cells of the first half are those in use
    normal = np.array([0.0, 0.0, 1.0])
    assert bsdf.evaluate(normal, -normal) == pytest.approx(0.1)
    assert bsdf.evaluate(normal, normal) == pytest.approx(0.05)
    assert bsdf.evaluate(-normal, -normal) == 0


FAULTS = {
    "a fault in the second line of a tree": ("\n.1 .2", "\n.1 x", "'x' in a", 11),
    "a fault after a tree": ("{ 0.05 }", "{ 0.05 0.05 }", "2 values", 16),
    "numbers without braces": ("{ 0.05 }", "0.05", "no tensor tree but '0.05'", 16),
    "no numbers": ("{ 0.05 }", "", "no tensor tree but ''", 16),
    "a forged number": ("{ 0.05 }", "<!-- -->{0}", "an element or a comment", 16),
    "an element within": ("{ 0.05 }", "{ <a/> 0.05 }", "an element or a comment", 16),
    "a Klems basis": ("LBNL/Shirley-Chiu", "LBNL/Klems Full", "angle basis", 7),
    "negative light": ("{ .1", "{ -.1", "negative values contain 7.85% of the flux", 9),
    "no end": ("</WindowElement>", "", "not well-formed", 19),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faulty_file_is_refused_with_its_line(path, fault):
    old, new, message, line = FAULTS[fault]
    path.write_text(FILE.replace(old, new))
    with pytest.raises(InputError) as caught:
        read_bsdf(path)
    assert message in str(caught.value)
    assert abs(caught.value.line - line) <= 1


@pytest.mark.parametrize("rank", [3, 4])
def test_round_trip_keeps_values_and_product(tmp_path, rank):
    product = Product("Film & co", "Maker", "Film", 0.001, 1.5, 2.0, 0.8, 0.9)
    bsdf = Bsdf(
        {("visible", name): random_tree(i, rank) for i, name in enumerate(FUNCTIONS)},
        product,
    )
    write_bsdf(tmp_path / "t.xml", bsdf)
    again = read_bsdf(tmp_path / "t.xml")
    assert again.product == product
    assert again.functions.keys() == bsdf.functions.keys()
    for key, part in bsdf.functions.items():
        np.testing.assert_array_equal(again.functions[key].slots, part.slots)


def test_matrices_and_trees_do_not_mix_in_a_file(tmp_path):
    basis = klems("quarter")
    matrix = ScatteringMatrix(np.full((41, 41), 0.1), basis, basis)
    bsdf = Bsdf(
        {
            ("visible", "transmission_front"): matrix,
            ("visible", "transmission_back"): random_tree(1),
        }
    )
    with pytest.raises(InputError, match="Columns and TensorTree4"):
        write_bsdf(tmp_path / "t.xml", bsdf)
    write_bsdf(tmp_path / "t.xml", to_trees(bsdf, halvings=3))
    write_bsdf(tmp_path / "t.xml", to_matrices(bsdf, basis))


def test_tree_that_gives_more_than_it_gets_is_warned_of(path):
    path.write_text(FILE.replace("0.05", "0.5"))
    with pytest.warns(ClerestoryWarning, match="1.571 times"):
        read_bsdf(path)


def test_colour_trees_make_an_rgb_matrix():
    """CIE u', v' of one chromaticity: the ratio of X, Y, Z, and so of RGB, is its."""
    u, v = 0.22, 0.5
    bsdf = Bsdf(
        {
            ("visible", "transmission_front"): random_tree(5),
            ("cie-u", "transmission_front"): tree([u]),
            ("cie-v", "transmission_front"): tree([v]),
        }
    )
    grey = bsdf.function("transmission_front").flux_factors()
    xyz = np.array([9 * u / (4 * v), 1, (12 - 3 * u - 20 * v) / (4 * v)])
    truth = rgb_from_xyz(xyz[:, None, None] * np.ones((3, 1, 1)))
    rgb = bsdf.transmission_matrix().values
    np.testing.assert_allclose(rgb, truth * grey, rtol=1e-5, atol=1e-9)
    matrices = to_matrices(bsdf, klems("full"))
    np.testing.assert_allclose(matrices.transmission_matrix().values, rgb, rtol=1e-12)


def test_reciprocal_mean_is_reciprocal_and_keeps_the_mean():
    bsdf = Bsdf({("visible", name): random_tree(i) for i, name in enumerate(FUNCTIONS)})
    mean = reciprocal_mean(bsdf)
    rng = np.random.default_rng(1)
    i, o = rng.normal(size=(2, 200, 3))
    i /= np.linalg.norm(i, axis=1)[:, None]
    o /= np.linalg.norm(o, axis=1)[:, None]
    np.testing.assert_allclose(mean.evaluate(i, o), mean.evaluate(o, i), rtol=1e-6)
    both = (bsdf.evaluate(i, o) + bsdf.evaluate(o, i)) / 2
    np.testing.assert_allclose(mean.evaluate(i, o), both, rtol=1e-6)


@pytest.mark.parametrize("rank", [3, 4])
@pytest.mark.parametrize("percent", [0, 50, 95])
def test_reduction_keeps_the_flux_and_reports_its_error(rank, percent):
    whole = random_tree(3, rank)
    result = reduce_tree(whole, percent)
    assert result.cells_after <= result.cells_before == 4**rank
    full = klems("full")
    lam = full.projected_solid_angles()
    before, after = (lam @ t.average(full, full) @ lam for t in (whole, result.tree))
    if rank == 4:
        assert after == pytest.approx(before, rel=1e-6)
    assert (percent > 0) == (result.moved > 0)
    assert result.hemispherical_error <= 2 * np.pi * result.moved * 4**rank


@pytest.mark.parametrize("percent", [-1, 100, float("nan")])
def test_percentages_out_of_range_are_refused(percent):
    with pytest.raises(InputError, match="0 ≤ reduction < 100"):
        reduce_tree(random_tree(1), percent)


def test_a_tree_of_one_value_stays():
    tree = ScatteringTree(np.zeros(1, dtype=np.int32), 4, 4)
    assert reduce_tree(tree, 95).cells_after == 1


def test_no_data_are_lost_without_a_warning(path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert read_bsdf(path).product == Product()
