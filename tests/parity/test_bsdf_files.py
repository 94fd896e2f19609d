"""Every BSDF file of the reference data: loads or not, and equals Radiance's values."""

import numpy as np
import pytest
from bsdf_ripple import angles_deg, directions, is_dropped, library, load, values

from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import combine
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import InputError

TRANSMITTED = library.SAMPLE_T | library.SAMPLE_SP | library.SAMPLE_DF
REFLECTED = library.SAMPLE_R | library.SAMPLE_SP | library.SAMPLE_DF

MATRICES = [
    "afc_fabrics/E Screen 3% Charcoal-Charcoal.xml",
    "afc_fabrics/E Screen 5% White-White.xml",
    "afc_fabrics/SilverScreen 2% - White.xml",
    "frads/2011-SA1.xml",
    "frads/blinds30.xml",
    "honeybee/clear.xml",
    "honeybee/diffuse50.xml",
    "honeybee/klemsfull.xml",
    "ignis/simple_klems_spot_front_refl.xml",
    "ignis/simple_klems_spot_refl.xml",
    "ignis/simple_klems_spot_trans.xml",
    "ignis/simple_klems_through_front_trans.xml",
    "ignis/simple_klems_through_refl.xml",
    "ignis/simple_klems_through_refl_trans.xml",
    "ignis/simple_klems_through_trans.xml",
    "pyradiance_tutorial/DiffuseGlass.xml",
    "pyradiance_tutorial/clear.xml",
    "pyradiance_tutorial/metalGrate.xml",
    "pyradiance_tutorial/ven0.xml",
    "pyradiance_tutorial/ven45.xml",
    "radiance_test/sawtooth.xml",
    "wincalc/SquareSlat_genBSDF.xml",
    "wincalc/cgdb_14060 Urban Loft River Stone.xml",
    "wincalc/shade_full.xml",
]
TREES = [
    "honeybee/clear_t4_4.xml",
    "honeybee/tensortree.xml",
    "ignis/simple_tensor_d2_line_refl.xml",
    "ignis/simple_tensor_d2_refl.xml",
    "ignis/simple_tensor_d2_t3_refl.xml",
    "ignis/simple_tensor_d2_t3_trans.xml",
    "ignis/simple_tensor_d2_trans.xml",
    "ignis/simple_tensor_d3_refl.xml",
    "ignis/simple_tensor_d3_t3_refl.xml",
    "ignis/simple_tensor_front_refl.xml",
    "ignis/simple_tensor_refl.xml",
    "ignis/simple_tensor_spot_refl.xml",
    "ignis/simple_tensor_spot_t3_trans.xml",
    "ignis/simple_tensor_spot_trans.xml",
    "ignis/simple_tensor_trans.xml",
    "pyradiance_tutorial/blindsT3.xml",
    "radiance_test/testBSDF.xml",
]
SHORTENED = "4 values; 145 x 145 = 21025 expected"
TEMPLATE = "no IncidentDataStructure in DataDefinition"
REFUSED = {
    "bsdfxmlparser/2011-SA1-Small-CommaSeparated-SingleColumnScattering.XML": SHORTENED,
    "bsdfxmlparser/2011-SA1-Small-CommaSeparated.XML": SHORTENED,
    "bsdfxmlparser/2011-SA1-Small-TabSeparated.XML": SHORTENED,
    "bsdfxmlparser/THMZ-Geometry-DifferentCapsAttributes.XML": SHORTENED,
    "bsdfxmlparser/THMZ-Geometry.XML": SHORTENED,
    "radiance_test/WINDOW6BSDFt.xml": TEMPLATE,
    "radiance_test/minimalBSDFt.xml": TEMPLATE,
}

pytestmark = pytest.mark.filterwarnings("ignore::clerestory.errors.ClerestoryWarning")


def assert_values_agree(path, folder, *, pairs):
    bsdf = read_bsdf(path)
    incident, leaving = directions(pairs, 1), directions(pairs, 2)
    truth, known = values(path, bsdf, incident, leaving, folder=folder)
    ours = bsdf.evaluate(incident, leaving)
    assert known.mean() > 0.4
    np.testing.assert_allclose(ours[known], truth[known], rtol=1e-6, atol=1e-7)


def test_every_file_is_in_one_of_the_lists(shared_data):
    folder = shared_data / "bsdf"
    found = {
        str(file.relative_to(folder))
        for file in folder.rglob("*")
        if file.suffix.lower() == ".xml"
    }
    assert found == {*MATRICES, *TREES, *REFUSED}


@pytest.mark.parametrize("name", REFUSED)
def test_file_is_refused_for_what_it_lacks(shared_data, name):
    with pytest.raises(InputError, match=REFUSED[name]) as caught:
        read_bsdf(shared_data / "bsdf" / name)
    assert caught.value.line


@pytest.mark.parametrize("name", MATRICES + TREES)
def test_file_survives_a_round_trip(shared_data, tmp_path, name):
    """Every value and every field, to the last bit."""
    bsdf = read_bsdf(shared_data / "bsdf" / name)
    write_bsdf(tmp_path / "copy.xml", bsdf)
    copy = read_bsdf(tmp_path / "copy.xml")
    assert copy.product == bsdf.product
    assert list(copy.functions) == list(bsdf.functions)
    for key, part in bsdf.functions.items():
        other = copy.functions[key]
        if isinstance(part, ScatteringTree):
            assert combine(lambda a, b: np.abs(a - b), part, other).extrema() == (0, 0)
        else:
            np.testing.assert_array_equal(part.values, other.values)


@pytest.mark.parametrize("name", MATRICES[3::3] + TREES)
def test_values_of_random_pairs(shared_data, tmp_path, name):
    assert_values_agree(shared_data / "bsdf" / name, tmp_path, pairs=3000)


@pytest.mark.slow
@pytest.mark.parametrize("name", MATRICES + TREES)
def test_values_of_many_random_pairs(shared_data, tmp_path, name):
    assert_values_agree(shared_data / "bsdf" / name, tmp_path, pairs=100_000)


@pytest.mark.parametrize("name", TREES)
def test_direct_hemispherical_values(shared_data, name):
    path = shared_data / "bsdf" / name
    bsdf, data = read_bsdf(path), load(path)
    incident = directions(200, 3)
    for channel, function in bsdf.functions:
        source = incident[(incident[:, 2] > 0) == function.endswith("back")]
        flags = TRANSMITTED if function.startswith("trans") else REFLECTED
        ours = bsdf.hemispherical(source, function=function, channel=channel)
        theirs = [library.direct_hemi(data, *i, flags) for i in angles_deg(source)]
        np.testing.assert_allclose(ours, theirs, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("name", MATRICES)
def test_direct_hemispherical_values_of_patches(shared_data, name):
    """At their centres, for the ripple averages out over a column."""
    path = shared_data / "bsdf" / name
    bsdf, data = read_bsdf(path), load(path)
    for channel, function in bsdf.functions:
        if channel != "visible" or is_dropped(bsdf.function(function)):
            continue
        flags = TRANSMITTED if function.startswith("trans") else REFLECTED
        mirror = [-1, -1, 1 if function.endswith("back") else -1]
        part = bsdf.function(function)
        source = (part.incidents.centres() * mirror)[::7]
        ours = part.direct_hemispherical()[::7]
        theirs = [library.direct_hemi(data, *i, flags) for i in angles_deg(source)]
        np.testing.assert_allclose(ours, theirs, rtol=1e-3, atol=1e-9)


@pytest.mark.parametrize("name", TREES[:2])
def test_direct_hemispherical_values_by_reciprocity(shared_data, name):
    """Radiance does this for rank 4 only; for rank 3 it has nothing to say."""
    path = shared_data / "bsdf" / name
    bsdf, data = read_bsdf(path), load(path)
    assert ("visible", "transmission_front") not in bsdf.functions
    source = directions(400, 4)
    source = source[source[:, 2] < 0]
    ours = bsdf.hemispherical(source, function="transmission_front")
    theirs = [library.direct_hemi(data, *i, TRANSMITTED) for i in angles_deg(source)]
    np.testing.assert_allclose(ours, theirs, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("name", [*TREES[:2], "pyradiance_tutorial/blindsT3.xml"])
def test_resolution_of_pairs(shared_data, name):
    """`bsdf.size2`: projected solid angle of the cell that holds a pair."""
    path = shared_data / "bsdf" / name
    bsdf, data = read_bsdf(path), load(path)
    assert isinstance(bsdf.scattering("transmission_back"), ScatteringTree)
    incident, leaving = directions(1000, 5), directions(1000, 6)
    through = (incident[:, 2] > 0) != (leaving[:, 2] > 0)
    incident, leaving = incident[through], leaving[through]
    pairs = zip(angles_deg(incident), angles_deg(leaving), strict=True)
    theirs = [np.max(library.size2(data, *i, *o, library.QUERY_MAX)) for i, o in pairs]
    np.testing.assert_allclose(bsdf.resolution(incident, leaving), theirs, rtol=1e-6)
