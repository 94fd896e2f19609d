"""Reading BSDF files: what is understood, what is refused, and with which words."""

import itertools
import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.hemisphere.klems import klems

TABLE = np.arange(25).reshape(5, 5) / 100
DATA = ",\n".join(", ".join(map(str, row)) for row in TABLE)


def test_columns_hold_incident_directions(bsdf_xml, write):
    bsdf = read_bsdf(write(bsdf_xml({"data": DATA})))
    np.testing.assert_array_equal(bsdf.function("transmission_front").values, TABLE)


def test_rows_hold_incident_directions_where_the_file_says_so(bsdf_xml, write):
    bsdf = read_bsdf(write(bsdf_xml({"data": DATA}, structure="Rows")))
    np.testing.assert_array_equal(bsdf.function("transmission_front").values, TABLE.T)


@pytest.mark.parametrize("separator", [",", ", ", "\t", "\n", " ,\t", ",\r\n"])
def test_numbers_may_be_separated_in_many_ways(bsdf_xml, write, separator):
    data = separator.join(map(str, TABLE.ravel())) + separator
    bsdf = read_bsdf(write(bsdf_xml({"data": data})))
    np.testing.assert_array_equal(bsdf.function("transmission_front").values, TABLE)


def test_product_is_read_in_metres(bsdf_xml, write):
    product = read_bsdf(write(bsdf_xml({"data": DATA}))).product
    assert (product.name, product.manufacturer) == ("Test layer", "Nobody")
    assert product.thickness == pytest.approx(0.025)
    assert product.width is None


def test_channels_and_sides_are_kept_apart(bsdf_xml, write):
    zeros = " ".join(["0"] * 25)
    text = bsdf_xml(
        {"data": zeros, "wavelength": "Solar"},
        {"data": DATA, "wavelength": "Visible"},
        {"data": zeros, "direction": "Reflection Back"},
    )
    bsdf = read_bsdf(write(text))
    assert bsdf.channels == ("solar", "visible")
    assert bsdf.direct_hemispherical().max() > 0
    assert bsdf.direct_hemispherical(channel="solar").max() == 0
    assert not bsdf.has("reflection_front")


def test_rings_come_from_the_file_whatever_its_name(bsdf_xml, basis, write):
    """Two rings named "LBNL/Klems Full" are two rings."""
    text = bsdf_xml(
        {"data": DATA, "row": "LBNL/Klems Full"}, bases=basis("LBNL/Klems Full")
    )
    part = read_bsdf(write(text)).function("transmission_front")
    assert part.exits.count.tolist() == [1, 4]
    np.testing.assert_allclose(np.degrees(part.exits.theta), [0, 30, 90])


@pytest.mark.parametrize(("patches", "last_ring"), [(77, 8), (73, 4)])
def test_klems_half_is_recognised_by_the_number_of_values(
    bsdf_xml, write, patches, last_ring
):
    """WINDOW's half basis has 77 patches, that of Radiance before 2024 has 73."""
    data = " ".join(["0.1"] * patches**2)
    text = bsdf_xml({"data": data, "row": "LBNL/Klems Half"}, bases="")
    bsdf = read_bsdf(write(text))
    assert bsdf.function("transmission_front").exits.count[-1] == last_ring
    assert "not" in bsdf.notes[0]


def test_data_that_contradict_their_basis_are_read_by_their_count(
    bsdf_xml, basis, write
):
    rings = ((0, 6.5, 1), (6.5, 19.5, 8), (19.5, 32.5, 12), (32.5, 46.5, 16))
    rings += ((46.5, 61.5, 20), (61.5, 76.5, 12), (76.5, 90, 4))
    data = " ".join(["0.1"] * 77**2)
    text = bsdf_xml(
        {"data": data, "row": "LBNL/Klems Half"}, bases=basis("LBNL/Klems Half", rings)
    )
    bsdf = read_bsdf(write(text))
    assert bsdf.function("transmission_front").exits.matches(klems("half"))
    assert "do not fit the 73 patches" in bsdf.notes[0]


def test_text_before_the_xml_is_noted(bsdf_xml, write):
    text = bsdf_xml({"data": DATA}, head="Recover using: genBSDF -recover /tmp/x\n\n")
    bsdf = read_bsdf(write(text))
    assert bsdf.notes == (
        "text before the XML is skipped: 'Recover using: genBSDF -recover /tmp/x'",
    )


def test_a_byte_order_mark_needs_no_note(bsdf_xml, write):
    data = b"\xef\xbb\xbf" + bsdf_xml({"data": DATA}).encode()
    assert read_bsdf(write(data)).notes == ()


def test_repeated_and_unknown_blocks_are_noted(bsdf_xml, write):
    zeros = " ".join(["0"] * 25)
    text = bsdf_xml(
        {"data": zeros}, {"data": DATA}, {"data": zeros, "direction": "Sideways"}
    )
    bsdf = read_bsdf(write(text))
    np.testing.assert_array_equal(bsdf.function("transmission_front").values, TABLE)
    assert any("twice" in note for note in bsdf.notes)
    assert any("unknown direction 'Sideways' is ignored" in note for note in bsdf.notes)


def test_slight_negative_noise_is_read_as_zero(bsdf_xml, write):
    data = DATA.replace("0.0,", "-0.0001,", 1)
    bsdf = read_bsdf(write(bsdf_xml({"data": data})))
    assert bsdf.function("transmission_front").values[0, 0] == 0
    assert "read as zero" in bsdf.notes[0]


def test_too_much_light_is_warned_of(bsdf_xml, write):
    path = write(bsdf_xml({"data": " ".join(["0.35"] * 25)}))
    with pytest.warns(
        ClerestoryWarning, match=r"scatters 1\.100 times the incident flux"
    ):
        read_bsdf(path)


def test_namespaces_do_not_matter(bsdf_xml, write):
    text = bsdf_xml({"data": DATA})
    for other in ('xmlns="http://www.ise.fraunhofer.de"', ""):
        changed = text.replace('xmlns="http://windows.lbl.gov"', other)
        assert read_bsdf(write(changed)).channels == ("visible",)


# Each fault: what is replaced in a sound file, by what, the message, the line it names
FAULTS = {
    "an unfinished file": ("</Optical>", "", "not well-formed XML", 26),
    "a word among numbers": ("0.13", "O.13", "'O.13' in ScatteringData", None),
    "not a number": ("0.13", "nan", "value 14 of ScatteringData is nan", None),
    "infinity": ("0.13", "1e999", "value 14 of ScatteringData is inf", None),
    "a value too few": ("0.13,", "", "24 values; 5 x 5 = 25 expected", None),
    "a value too many": ("0.13,", "0.13, 1,", "26 values; 5 x 5 = 25 expected", None),
    "negative light": ("0.13", "-0.13", "negative values contain", None),
    "an empty block": (DATA, "", "0 values; 5 x 5 = 25 expected", None),
    "no data element": ("ScatteringData>", "Other>", "no ScatteringData", None),
    "no layer": ("Layer>", "Other>", "no Optical/Layer in WindowElement", 2),
    "no definition": ("DataDefinition>", "Other>", "no DataDefinition in Layer", 4),
    "no structure": (
        "IncidentDataStructure>",
        "Other>",
        "no IncidentDataStructure in DataDefinition",
        7,
    ),
    "unknown structure": (">Columns<", ">Diagonal<", "'Diagonal'; Columns, Rows, T", 7),
    "a tensor tree": (
        ">Columns<",
        ">TensorTree4<",
        "angle basis of a tensor tree is ''",
        None,
    ),
    "no blocks": ("WavelengthDataBlock>", "Other>", "no scattering data", 4),
    "an unknown basis": (
        "<RowAngleBasis>Custom",
        "<RowAngleBasis>Cubes",
        "angle basis 'Cubes' is not defined",
        None,
    ),
    "no basis": ("RowAngleBasis>", "Other>", "angle basis '' is not defined", None),
    "a gap between rings": (
        "<UpperTheta>30",
        "<UpperTheta>29",
        "29° and 30° in 'Custom' differ",
        None,
    ),
    "rings that end early": (
        "<UpperTheta>90",
        "<UpperTheta>80",
        "contiguous rings",
        None,
    ),
    "an angle in words": ("<UpperTheta>30", "<UpperTheta>up", "angle is 'up'", None),
    "an angle beyond 90": ("<UpperTheta>90", "<UpperTheta>91", "angle is '91'", None),
    "no limits": ("ThetaBounds>", "Other>", "no ThetaBounds/LowerTheta", None),
    "no patches": ("<nPhis>4", "<nPhis>0", "nPhis is '0'; a whole number", None),
    "half a patch": ("<nPhis>4", "<nPhis>4.5", "nPhis is '4.5'", None),
    "millions of patches": ("<nPhis>4", "<nPhis>99999999", "nPhis is '99999999'", None),
    "a root of another kind": ("WindowElement", "html", "WindowElement", None),
    "a DOCTYPE": (
        "<WindowElement ",
        "<!DOCTYPE WindowElement>\n<WindowElement ",
        "DOCTYPE declaration",
        None,
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faulty_file_is_refused_with_its_line(bsdf_xml, write, fault):
    old, new, message, line = FAULTS[fault]
    text = bsdf_xml({"data": DATA})
    assert old in text
    path = write(text.replace(old, new))
    with pytest.raises(InputError) as caught:
        read_bsdf(path)
    assert message in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    if line is not None:
        assert caught.value.line == line


def test_nested_entities_are_refused_before_expansion(bsdf_xml, write):
    names = "abcdefghij"
    bomb = '<!ENTITY a "lol">' + "".join(
        f'<!ENTITY {new} "{f"&{old};" * 10}">' for old, new in itertools.pairwise(names)
    )
    text = bsdf_xml({"data": "&j;"}).replace(
        "<WindowElement ", f"<!DOCTYPE WindowElement [{bomb}]>\n<WindowElement ", 1
    )
    with pytest.raises(InputError):
        read_bsdf(write(text))


def test_files_outside_are_not_read(bsdf_xml, write, tmp_path):
    secret = tmp_path / "secret.txt"
    secret.write_text(DATA)
    text = bsdf_xml({"data": "&x;"}).replace(
        "<WindowElement ",
        f'<!DOCTYPE WindowElement [<!ENTITY x SYSTEM "{secret.as_uri()}">]>\n'
        "<WindowElement ",
        1,
    )
    with pytest.raises(InputError):
        read_bsdf(write(text))


@pytest.mark.parametrize(
    "content", [b"", b"\0" * 100, b"BSDF", b"<?xml", b"<WindowElement"]
)
def test_other_files_are_refused(write, content):
    with pytest.raises(InputError):
        read_bsdf(write(content))


def test_missing_file_and_folder_are_refused(tmp_path):
    for path in (tmp_path / "none.xml", tmp_path):
        with pytest.raises(InputError, match="cannot be read"):
            read_bsdf(path)


def test_line_counts_the_text_before_the_xml(bsdf_xml, write):
    text = bsdf_xml({"data": DATA}, structure="Other", head="one\ntwo\n")
    with pytest.raises(InputError) as caught:
        read_bsdf(write(text))
    assert caught.value.line == 9


def test_ring_limits_may_be_rounded(bsdf_xml, basis, write):
    rings = ((0.0, 30.001, 1), (30, 89.999, 4))
    part = read_bsdf(
        write(bsdf_xml({"data": DATA}, bases=basis(rings=rings)))
    ).function("transmission_front")
    assert part.exits.projected_solid_angles().sum() == pytest.approx(np.pi)


def read_or_refuse(path):
    try:
        return read_bsdf(path)
    except InputError:
        return None


@settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_damaged_bytes_are_read_or_refused(bsdf_xml, tmp_path, data):
    """Whatever happens to a file, the only error is ours, and values are sound."""
    content = bytearray(bsdf_xml({"data": DATA}).encode())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content) - 1))
        length = data.draw(st.integers(0, 12))
        patch = data.draw(
            st.binary(max_size=6)
            | st.sampled_from(
                [b"-", b"nan", b"<", b">", b"&", b"1e308", b"]]>", b"<!--"]
            )
        )
        content[at : at + length] = patch
    path = tmp_path / "damaged.xml"
    path.write_bytes(bytes(content))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ClerestoryWarning)
        bsdf = read_or_refuse(path)
    for part in bsdf.functions.values() if bsdf else ():
        assert np.all(np.isfinite(part.values))
        assert np.all(part.values >= 0)
