"""Files of panes: both JSON versions, the Optics format, faults, and garbage."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.glazing.layer_files import read_catalogue, read_layer, read_pane
from clerestory.glazing.lbnl_optics import read_optics_file
from clerestory.glazing.screen import PerforatedScreen, WovenShade
from clerestory.glazing.venetian import VenetianBlind

OPTICS = """{ Units, Wavelength Units } SI Nanometers
{ Thickness } 5.9
{ Conductivity } 1
{ IR Transmittance } TIR=0
{ Emissivity, front back } Emis= 0.84 0.03
{ Product Name: Test coated glass }
{ NFRC ID: 77 }
{ Type: Coated }
{ Coated Side: Back }
300.0 0.10 0.20 0.30
2500.0 0.50 0.30 0.40
"""

VERSION_2 = {
    "name": "Two",
    "type": "GLAZING",
    "subtype": "LAMINATE",
    "coated_side": "NA",
    "physical_properties": {
        "thickness": 3.0,
        "predefined_emissivity_front": 0.7,
        "optical_properties": {
            "optical_data": {
                "angle_blocks": [
                    {
                        "wavelength_data": [
                            {
                                "w": "0.3",
                                "specular": {
                                    "tf": "0.5",
                                    "tb": 0.4,
                                    "rf": 0.1,
                                    "rb": 0.2,
                                },
                                "diffuse": {"tf": 0.1, "tb": 0.1, "rf": 0.1, "rb": 0.1},
                            },
                            {
                                "w": 2.5,
                                "specular": {
                                    "tf": 0.3,
                                    "tb": 0.3,
                                    "rf": 0.1,
                                    "rb": 0.2,
                                },
                            },
                        ]
                    }
                ]
            }
        },
    },
}


def shade(geometry, product):
    """A product of the IGSDB that is made of a material."""
    child = {"child_product": product, "extra_data": {"geometry": geometry}}
    return {"name": "shade", "type": "shading", "composition": [child]}


def test_version_1_is_read(product, write_json):
    pane = read_pane(write_json(product))
    assert pane.name == "Test glass"
    assert pane.wavelength_nm.tolist() == [300, 2500]
    assert pane.direct.transmission_back.tolist() == [0.8, 0.6]
    assert pane.direct.reflection_back.tolist() == [0.15, 0.25]
    assert pane.thickness == pytest.approx(0.004)
    assert (pane.emissivity_front, pane.emissivity_back) == (0.84, 0.2)
    assert not pane.coated
    assert pane.nfrc_id == 7


def test_version_2_is_read(write_json):
    pane = read_pane(write_json(VERSION_2))
    assert pane.direct.transmission_back.tolist() == [0.4, 0.3]
    assert pane.diffuse.transmission_front.tolist() == [0.1, 0]
    assert pane.emissivity_front == 0.7
    assert pane.coated  # laminates follow the regression, as in WINDOW
    assert pane.haze(np.array([300.0])).transmission_front[0] == pytest.approx(1 / 6)


def test_an_optics_file_is_read(tmp_path):
    path = tmp_path / "glass.dat"
    path.write_text(OPTICS)
    pane = read_optics_file(path)
    assert pane.name == "Test coated glass"
    assert pane.wavelength_nm.tolist() == [300, 2500]
    assert pane.direct.reflection_front.tolist() == [0.2, 0.3]
    assert pane.thickness == pytest.approx(0.0059)
    assert (pane.emissivity_front, pane.emissivity_back) == (0.84, 0.03)
    assert pane.coated
    assert pane.coated_side == "back"


def test_nine_columns_have_a_diffuse_part(tmp_path):
    path = tmp_path / "frit.txt"
    path.write_text(
        "0.3 .5 .1 .4 .2 .05 .01 .06 .02\n2.5 .5 .1 .4 .2 .05 .01 .06 .02\n"
    )
    pane = read_optics_file(path)
    assert pane.direct.transmission_back[0] == 0.4
    assert pane.diffuse.reflection_back[0] == 0.02


def test_a_flipped_pane_changes_sides(product, write_json):
    pane = read_pane(write_json(product)).flipped()
    assert pane.direct.reflection_front.tolist() == [0.15, 0.25]
    assert pane.emissivity_front == 0.2


@pytest.mark.parametrize(
    ("geometry", "kind"),
    [
        (
            {
                "slat_width": 25,
                "slat_spacing": 20,
                "slat_tilt": 45,
                "slat_curvature": 0,
            },
            VenetianBlind,
        ),
        ({"thread_diameter": 0.3, "thread_spacing": 1}, WovenShade),
        (
            {
                "perforation_type": "Circular",
                "spacing_x": 2,
                "spacing_y": 2,
                "dimension_x": 0.5,
            },
            PerforatedScreen,
        ),
    ],
)
def test_shades_of_the_database_become_layers(product, write_json, geometry, kind):
    assert isinstance(read_layer(write_json(shade(geometry, product))), kind)


FAULTS = {
    "not JSON": "{",
    "a table expected": "[1, 2]",
    "no spectral data": '{"name": "x"}',
    "'' has no spectral data": '{"spectral_data": []}',
    "T is missing": '{"spectral_data": [{"wavelength": 0.5}]}',
}


@pytest.mark.parametrize("words", FAULTS)
def test_a_bad_product_is_reported_in_one_line(tmp_path, words):
    path = tmp_path / "bad.json"
    path.write_text(FAULTS[words])
    with pytest.raises(InputError, match=words) as caught:
        read_pane(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_a_row_of_text_is_reported_with_its_line(tmp_path):
    path = tmp_path / "bad.dat"
    path.write_text(OPTICS + "2600 0.5 x 0.4\n")
    with pytest.raises(InputError, match=r"bad\.dat:12: .*4 numbers expected"):
        read_optics_file(path)


def test_an_infinite_number_is_refused(tmp_path):
    path = tmp_path / "bad.dat"
    path.write_text(OPTICS.replace("77", "1e999"))
    with pytest.raises(InputError, match="nfrc id is inf; a finite number expected"):
        read_optics_file(path)


def test_a_negative_share_is_refused(product, write_json):
    product["spectral_data"]["spectral_data"][0]["T"] = -0.1
    with pytest.raises(InputError, match=r"glass\.json: .*0 or more expected"):
        read_pane(write_json(product))


def test_light_from_nothing_is_warned_of(product, write_json):
    product["spectral_data"]["spectral_data"][0]["Rf"] = 0.5
    with pytest.warns(
        ClerestoryWarning, match=r"1\.300 times the incident flux at 300 nm"
    ):
        read_pane(write_json(product))


def test_a_folder_is_a_catalogue(product, write_json, tmp_path):
    write_json(product)
    (tmp_path / "broken.json").write_text("{")
    entries = read_catalogue(tmp_path)
    assert [entry.name for entry in entries] == ["broken", "Test glass"]
    assert "not JSON" in entries[0].problem


@settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(st.one_of(st.text(), st.binary()))
@pytest.mark.filterwarnings("ignore::clerestory.errors.ClerestoryWarning")
def test_only_random_bytes_are_refused(tmp_path, content):
    for name in ("any.json", "any.dat"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        with pytest.raises(InputError):
            read_layer(path)


_JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(
                [
                    "composition",
                    "spectral_data",
                    "measured_data",
                    "physical_properties",
                    "T",
                ]
            ),
            inner,
            max_size=4,
        )
    ),
    max_leaves=12,
)


@settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(_JSON)
def test_any_other_json_is_refused(write_json, content):
    with pytest.raises(InputError):
        read_layer(write_json(content))
