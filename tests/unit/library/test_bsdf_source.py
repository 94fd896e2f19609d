"""Built-in BSDFs: closed forms of their layers, and names of every kind."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clerestory.bsdf.quality_checks import check
from clerestory.bsdf.xml_reader import read_bsdf as read_xml
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import InputError
from clerestory.library.bsdf_source import library_bsdf, library_layers, read_bsdf
from clerestory.library.catalogue import RECIPES, TILTS
from clerestory.library.library_panes import library_pane

DOWN = np.array([[0.0, 0.0, 1.0]])
SLOW = {name for name, recipe in RECIPES.items() if recipe.tilts}


def at_normal(name, function="transmission_front", channel="visible"):
    """Flux that leaves for a beam within 5° of the normal."""
    matrix = library_bsdf(name).functions[channel, function]
    return float(matrix.exits.projected_solid_angles() @ matrix.values[:, 0])


def test_the_library_has_what_it_promises():
    families = [recipe.family for recipe in RECIPES.values()]
    assert families.count("glazing") == 30
    assert len(TILTS) == 7
    assert set(families) == {"glazing", "blind", "screen", "louvre", "film"}


@pytest.mark.parametrize("name", ["single-clear-6", "polyester-55", "diffuser-50"])
def test_single_sheets_have_the_properties_of_their_recipe(name):
    expected = {"single-clear-6": 0.881, "polyester-55": 0.551, "diffuser-50": 0.5}
    assert at_normal(name) == pytest.approx(expected[name], abs=0.002)


@pytest.mark.parametrize("channel", ["visible", "solar"])
def test_double_glazing_is_the_series_of_reflections(channel):
    """T = T₁T₂ / (1 − R₁' R₂), at normal incidence, in each band of a grey pane."""
    T, R = {"visible": (0.881, 0.080), "solar": (0.775, 0.071)}[channel]
    # The mean of products over the two bands inside the solar average differs by .01
    expected = T**2 / (1 - R**2)
    found = at_normal("double-clear-6", channel=channel)
    assert found == pytest.approx(expected, abs=0.002 if channel == "visible" else 0.02)


def test_reversed_panes_reflect_with_their_coating():
    plain, turned = (library_pane("selective-6"), library_pane("selective-6").flipped())
    assert plain.emissivities == turned.emissivities[::-1] == (0.84, 0.03)


@pytest.mark.parametrize("openness", [1, 3, 5, 10])
def test_screens_transmit_their_openness(openness):
    """Threads without transmittance: the share of holes is what passes."""
    assert at_normal(f"screen-{openness}-charcoal") == pytest.approx(openness / 100)


def test_untilted_slats_without_thickness_let_normal_light_pass():
    matrix = library_bsdf("venetian-80-white@0").functions[
        "visible", "transmission_front"
    ]
    straight = matrix.values[0, 0] * matrix.exits.projected_solid_angles()[0]
    assert straight == pytest.approx(1, abs=0.01)


def test_slats_at_45_degrees_cut_the_normal_beam():
    """A slat of width w every s covers w sin β of s: the gap is 1 − w sin β / s."""
    layer = library_layers("venetian-80-white@45")[0]
    covered = 80 * math.sin(math.pi / 4) / 72
    assert layer.openness(DOWN)[0] == pytest.approx(1 - covered, abs=0.005)


def test_closed_slats_are_opaque():
    """Slats of 80 mm every 72 mm overlap at 75°; some light passes by reflections."""
    assert library_layers("venetian-80-grey@75")[0].openness(DOWN)[0] == 0
    assert at_normal("venetian-80-grey@75") < 0.1


@pytest.mark.parametrize("name", [name for name in RECIPES if name not in SLOW])
def test_no_product_creates_light(name):
    bsdf = library_bsdf(name)
    for side in ("front", "back"):
        for channel in ("visible", "solar"):
            parts = [
                bsdf.functions[channel, f"{kind}_{side}"]
                for kind in ("transmission", "reflection")
            ]
            flux = sum(p.exits.projected_solid_angles() @ p.values for p in parts)
            assert flux.min() >= 0
            assert flux.max() <= 1 + 1e-9


def test_glazing_and_blind_are_sound_files(tmp_path):
    file = tmp_path / "blind.xml"
    bsdf = read_bsdf("library:double-lowe-6+venetian-25-white@30")
    write_bsdf(file, bsdf)
    again = read_xml(file)
    one, other = (
        each.functions["visible", "transmission_front"].values for each in (bsdf, again)
    )
    np.testing.assert_allclose(other, one, rtol=1e-4, atol=1e-6)
    assert not [finding for finding in check(again) if finding.severity == "error"]


def test_layers_are_joined_from_outdoors_to_indoors():
    names = [layer.name for layer in library_layers("single-grey-6+screen-5-white")]
    assert names == ["grey-6", "5% open sheet"]


def test_a_name_gives_the_same_numbers_again():
    library_bsdf.cache_clear()
    one = library_bsdf("double-lowe-6").functions["visible", "transmission_front"]
    library_bsdf.cache_clear()
    two = library_bsdf("double-lowe-6").functions["visible", "transmission_front"]
    assert np.array_equal(one.values, two.values)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("venetian-80-whit", "one such as venetian-80-white"),
        ("", "is named ''; another name expected"),
        ("single-clear-6@45", "has no slats to tilt"),
        ("venetian-80-white@91", "a whole number from -90 to 90 degrees expected"),
        ("venetian-80-white@4.5", "is named 'venetian-80-white@4.5'"),
        ("venetian-80-white@٤٥", "is named"),
        ("+".join(["single-clear-3"] * 5), "more than 4 products"),
        ("../double-clear-6", "is named"),
        ("x" * 10_000, "another name expected"),
    ],
)
def test_wrong_names_are_one_line_errors(name, message):
    with pytest.raises(InputError, match=r"expected|to tilt") as caught:
        read_bsdf(f"library:{name}")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300


@given(st.text(alphabet=st.characters(codec="utf-8"), max_size=40))
def test_any_text_is_a_name_or_an_error(name):
    problem = ""
    try:
        assert library_layers(name)
    except InputError as error:
        problem = str(error)
    assert not problem or problem.isprintable()
