"""Materials of Radiance's language are read with all they say."""

from pathlib import Path
from shutil import copy

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.materials import READERS as MATERIALS
from clerestory.scene.model import (
    BsdfSurface,
    Dielectric,
    Illum,
    Interface,
    Metal,
    Mirror,
    Mixture,
    Plastic,
    Spotlight,
    Trans,
    Void,
    same_material,
)

FIVE_PATCHES = Path(__file__).parents[2] / "data" / "five_patches.xml"
GREY = "void plastic grey 0 0 5 .5 .5 .5 0 0\n"


@pytest.fixture
def read(tmp_path):
    copy(FIVE_PATCHES, tmp_path / "blind.xml")

    def materials(text, **others):
        for name, content in others.items():
            (tmp_path / f"{name}.rad").write_text(content)
        (tmp_path / "main.rad").write_text(text)
        return read_rad(tmp_path / "main.rad").materials

    return materials


def test_trans_carries_its_seven_numbers(read):
    made = read("void trans x 0 0 7 .9 .8 .7 .05 .1 .6 .25")["x"]
    assert isinstance(made, Trans)
    assert made.reflectance.tolist() == [0.9, 0.8, 0.7]
    assert (made.specularity, made.roughness) == (0.05, 0.1)
    assert (made.transmission, made.transmitted_specular) == (0.6, 0.25)


def test_metal_is_no_plastic(read):
    made = read("void metal x 0 0 5 .9 .8 .7 .9 .1")["x"]
    assert isinstance(made, Metal)
    assert (made.specularity, made.roughness) == (0.9, 0.1)


@pytest.mark.parametrize(("kind", "cls"), [("plastic2", Plastic), ("metal2", Metal)])
def test_elliptical_highlights_have_two_roughnesses_and_an_up_vector(read, kind, cls):
    made = read(f"void {kind} x 4 0 0 2 . 0 6 .9 .8 .7 .04 .1 .2")["x"]
    assert isinstance(made, cls)
    assert made.roughness.tolist() == [0.1, 0.2]
    assert made.up.tolist() == [0, 0, 1]


def test_up_vectors_turn_with_their_transform_and_with_the_file(read):
    """-rx 90 takes z to -y, and -rz 90 takes -y to x."""
    part = "void trans2 x 6 0 0 1 . -rx 90 0 8 .9 .8 .7 .04 .1 .2 .5 .5"
    made = read("!xform -rz 90 part.rad", part=part)["x"]
    assert isinstance(made, Trans)
    assert made.up == pytest.approx([1, 0, 0], abs=1e-12)


def test_absorption_is_per_metre_whatever_the_scale_of_the_file(read):
    part = "void dielectric x 0 0 5 .5 .25 1 1.5 0"
    made = read("!xform -s 2 part.rad", part=part)["x"]
    assert isinstance(made, Dielectric)
    # Half is left after one unit of the file, which is 2 m
    assert made.transmissivity**2 == pytest.approx([0.5, 0.25, 1])


def test_the_index_of_a_dispersing_dielectric_is_that_at_500_nm(read):
    with pytest.warns(ClerestoryWarning, match="Hartmann's constant is 50"):
        made = read("void dielectric x 0 0 5 1 1 1 1.5 50")["x"]
    assert made.index == pytest.approx(1.6)


def test_an_interface_has_two_sides(read):
    made = read("void interface x 0 0 8 .1 .2 .3 1.5 .4 .5 .6 1.33")["x"]
    assert isinstance(made, Interface)
    assert made.inside_transmissivity.tolist() == [0.1, 0.2, 0.3]
    assert (made.inside_index, made.outside_index) == (1.5, 1.33)


def test_mirrors_and_illums_may_look_like_something_else(read):
    made = read(
        GREY + "void mirror bare 0 0 3 .9 .8 .7\nvoid mirror coat 1 grey 0 3 .9 .8 .7\n"
        "void illum hidden 0 0 3 1 2 3\nvoid illum seen 1 grey 0 3 1 2 3\n"
        "void illum void 1 void 0 3 1 2 3\n"
    )
    assert isinstance(made["bare"], Mirror)
    assert made["bare"].alternate is None
    assert isinstance(made["coat"].alternate, Plastic)
    assert isinstance(made["hidden"], Illum)
    assert isinstance(made["hidden"].alternate, Void)
    assert isinstance(made["seen"].alternate, Plastic)
    assert made["seen"].radiance.tolist() == [1, 2, 3]


def test_alternates_are_those_in_force_at_the_line(read):
    made = read(
        GREY + "void illum x 1 grey 0 3 1 1 1\nvoid plastic grey 0 0 5 .1 .1 .1 0 0\n"
    )
    assert made["x"].alternate.reflectance.tolist() == [0.5, 0.5, 0.5]


def test_spotlights_turn_and_grow_with_their_file(read):
    part = "void spotlight x 0 0 7 1 2 3 30 0 0 -2"
    made = read("!xform -s 3 -rx 90 part.rad", part=part)["x"]
    assert isinstance(made, Spotlight)
    assert made.angle_deg == 30
    assert made.direction == pytest.approx([0, 1, 0], abs=1e-12)
    assert made.length == pytest.approx(6)


def test_a_mixture_of_constant_share_is_read(read):
    made = read(GREY + "void mixfunc x 4 grey void 0.7 . 0 0")["x"]
    assert isinstance(made, Mixture)
    assert made.amount == 0.7
    assert isinstance(made.foreground, Plastic)
    assert isinstance(made.background, Void)


def test_a_bsdf_has_its_data_its_thickness_and_added_colours(read):
    made = read(
        "void BSDF x 8 .02 blind.xml 0 0 1 . -rz 90 0 9 .1 .2 .3 .4 .5 .6 .01 .02 .03"
    )["x"]
    assert isinstance(made, BsdfSurface)
    assert made.bsdf.channels
    assert (made.thickness, made.peak) == (0.02, False)
    assert (made.up @ made.transform).tolist() == [0, 0, 1]
    assert made.front.tolist() == [0.1, 0.2, 0.3]
    assert made.back.tolist() == [0.4, 0.5, 0.6]
    assert made.transmission.tolist() == [0.01, 0.02, 0.03]


def test_an_absdf_has_no_thickness_and_takes_fewer_colours(read):
    made = read("void aBSDF x 5 blind.xml 0 1 0 . 0 3 .1 .2 .3")["x"]
    assert (made.thickness, made.peak) == (0, True)
    assert made.front.tolist() == [0.1, 0.2, 0.3]
    assert not np.any([made.back, made.transmission])


def test_thickness_and_up_vector_follow_the_file_they_stand_in(read):
    part = "void BSDF x 6 .1 blind.xml 0 0 1 . 0 0"
    made = read("!xform -s 2 -rx 90 part.rad", part=part)["x"]
    assert made.thickness == pytest.approx(0.2)
    assert made.up @ made.transform == pytest.approx([0, -1, 0], abs=1e-12)
    assert np.linalg.det(made.transform) == pytest.approx(1)


def test_equal_bsdf_materials_are_one(read):
    line = "void BSDF x 6 0 blind.xml 0 0 1 . 0 0\n"
    assert list(read(line * 2)) == ["x"]
    assert list(read(line + line.replace("0 0 1", "0 1 0"))) == ["x", "x#2"]


def test_bsdf_files_are_found_where_radiance_looks(read, tmp_path, monkeypatch):
    library = tmp_path / "library"
    library.mkdir()
    copy(FIVE_PATCHES, library / "other.xml")
    monkeypatch.setenv("RAYPATH", f".:{library}")
    assert "x" in read("void BSDF x 6 0 other.xml 0 0 1 . 0 0\n")


def test_materials_are_compared_in_depth():
    grey = Plastic("grey", np.full(3, 0.5))
    dark = Plastic("dark", np.full(3, 0.1))
    assert same_material(Mixture("a", grey, dark, 0.5), Mixture("b", grey, dark, 0.5))
    assert not same_material(
        Mixture("a", grey, dark, 0.5), Mixture("a", dark, grey, 0.5)
    )


CASES = {
    "metal": ("void metal x 0 0 4 1 1 1 0", "4 numbers; 5 expected"),
    "trans": ("void trans x 0 0 7 1 1 1 0 0 1.5 0", "transmission is 1.5"),
    "trans share": (
        "void trans x 0 0 7 1 1 1 0 0 1 -1",
        "transmitted specularity is -1",
    ),
    "up": ("void plastic2 x 4 0 0 0 . 0 6 1 1 1 0 .1 .1", "direction is zero"),
    "up function": (
        "void BSDF x 6 0 blind.xml Px 0 1 . 0 0",
        "the up vector varies; a constant vector expected",
    ),
    "few strings": (
        "void plastic2 x 3 0 0 1 0 6 1 1 1 0 .1 .1",
        "3 string arguments",
    ),
    "sharp": ("void metal2 x 4 0 0 1 . 0 6 1 1 1 0 0 .1", "roughness is 0; more"),
    "transform": (
        "void metal2 x 5 0 0 1 . -q 0 6 1 1 1 0 .1 .1",
        '"-q" in the transform',
    ),
    "index": ("void dielectric x 0 0 5 1 1 1 0 0", "index of refraction is 0"),
    "interface": ("void interface x 0 0 5 1 1 1 1 1", "5 numbers; 8 expected"),
    "mirror": ("void mirror x 2 a b 0 3 1 1 1", "2 string arguments; 0 or 1"),
    "alternate": ("void illum x 1 a 0 3 1 1 1", 'undefined modifier "a"'),
    "cone": ("void spotlight x 0 0 7 1 1 1 0 0 0 1", "angle is 0°"),
    "aim": ("void spotlight x 0 0 7 1 1 1 9 0 0 0", "direction is zero"),
    "mixture": (
        "void mixfunc x 4 grey void sin(far) . 0 0",
        '"far" is not defined',
    ),
    "file": ("void BSDF x 6 0 no.xml 0 0 1 . 0 0", 'the file "no.xml" is missing'),
    "thickness": (
        "void BSDF x 6 t blind.xml 0 0 1 . 0 0",
        'thickness is "t"; a plain number expected',
    ),
    "colours": ("void aBSDF x 5 blind.xml 0 0 1 . 0 4 1 1 1 1", "4 numbers; 0 or 3"),
    "BSDF strings": ("void BSDF x 5 blind.xml 0 0 1 . 0 0", "5 string arguments"),
    "antimatter": ("void antimatter x 1 grey 0 0", "unsupported type"),
    "texture": ("void texfunc x 4 a b c . 0 0", '"a" is not defined'),
    "mixdata": ("void mixdata x 0 0 0", "0 string arguments"),
    "mixpict": ("void mixpict x 0 0 0", "unsupported type"),
}


@pytest.mark.parametrize("case", CASES, ids=str)
def test_what_cannot_be_is_refused_with_its_line(read, case):
    text, message = CASES[case]
    with pytest.raises(InputError, match=r"main\.rad:2: ") as caught:
        read(GREY + text)
    assert message in str(caught.value)


@settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    kind=st.sampled_from(sorted(MATERIALS)),
    strings=st.lists(
        st.sampled_from(
            ["0", "1", ".", "blind.xml", "grey", "-rx", "-i", "void", "1e9"]
        ),
        max_size=9,
    ),
    reals=st.lists(
        st.floats(-2, 2) | st.sampled_from([0.0, 1.0, 1e300, -1e16]), max_size=10
    ),
)
@pytest.mark.filterwarnings("ignore::clerestory.errors.ClerestoryWarning")
def test_any_arguments_are_read_or_refused(read, kind, strings, reals):
    words = [str(len(strings)), *strings, "0", str(len(reals)), *map(repr, reals)]
    try:
        read(f"{GREY}void {kind} x {' '.join(words)}")
    except InputError as error:
        assert error.line == 2 or str(error.file).endswith(".xml")  # noqa: PT017


def test_an_alias_replaces_what_modifies_its_original(read):
    """As rtrace shows: void takes the pattern away, inherit keeps it."""
    made = read(
        "void brightfunc half 2 0.5 . 0 0\nhalf glow lamp 0 0 4 1 1 1 0\n"
        "void brightfunc third 2 1/3 . 0 0\nvoid alias bare lamp\n"
        "inherit alias same lamp\nthird alias other lamp\n"
        "third alias both half\nboth glow dim 0 0 4 1 1 1 0\n"
    )
    up = np.array([[0.0, 0.0, 1.0]])
    assert made["bare"].pattern is None
    assert "same" not in made
    assert made["other"].pattern.value(up).ravel() == pytest.approx([1 / 3] * 3)
    assert made["dim"].pattern.value(up).ravel() == pytest.approx([1 / 6] * 3)


def test_an_alias_puts_a_pattern_on_a_surface(read):
    made = read(GREY + "void brightfunc half 2 0.5 . 0 0\nhalf alias x grey")
    grey, half = made["grey"].reflectance, made["x"].reflectance
    assert half == pytest.approx(grey / 2)


def test_the_up_vector_of_a_bsdf_must_lie_along_its_polygon(read):
    """Radiance: "Illegal orientation vector"."""
    text = "void BSDF x 6 0 blind.xml 0 0 1 . 0 0\nx polygon pane 0 0 9 "
    assert read(text + "0 0 0 1 0 0 1 0 1")
    with pytest.raises(InputError, match=r'rad:2: "pane": the up vector of'):
        read(text + "0 0 0 1 0 0 1 1 0")
    with pytest.raises(InputError, match=r'rad:3: "disc": the up vector of'):
        read(
            "void BSDF x 6 0 blind.xml 0 0 1 . 0 0\nvoid mixfunc m 4 x void .5 . 0 0\n"
            "m ring disc 0 0 8 0 0 0 0 0 2 0 1"
        )
