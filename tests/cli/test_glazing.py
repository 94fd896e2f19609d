"""`clerestory glazing`: stacks from files and descriptions, and what products hold."""

import pytest

from clerestory.bsdf.xml_reader import read_bsdf

GLASS = """{ Units, Wavelength Units } SI Microns
{ Thickness } 4
{ Product Name: Plain glass }
{ NFRC ID: 12 }
0.3 0.8 0.07 0.07
2.5 0.8 0.07 0.07
"""


@pytest.fixture
def glass(room):
    """A product beside the room."""
    (room / "glass.dat").write_text(GLASS)
    return "glass.dat"


def test_a_stack_is_written_and_told(call, room, glass):
    outcome = call(
        "glazing", "stack", glass, glass, "--basis", "quarter", "-o", "s.xml"
    )
    assert outcome.status == 0
    assert "transmission front" in outcome.out
    assert "absorbed by 2" in outcome.out
    bsdf = read_bsdf(room / "s.xml")
    assert bsdf.channels == ("visible", "solar")
    assert len(bsdf.direct_hemispherical()) == 41


def test_a_description_is_stacked(call, room, glass):
    (room / "system.toml").write_text(
        '[[layer]]\nfile = "glass.dat"\n[[layer]]\ndiffuser = "glass.dat"\n'
    )
    outcome = call("glazing", "stack", "system.toml", "--basis", "quarter", "--bands")
    assert outcome.status == 0


@pytest.mark.parametrize("file", ["s.idf", "s.epJSON"])
def test_a_complex_fenestration_state_is_written(call, room, glass, file):
    words = ("--basis", "quarter", "--energyplus", file, "-q")
    assert call("glazing", "stack", glass, glass, *words).status == 0
    text = (room / file).read_text()
    assert text.count("Construction:ComplexFenestrationState") == 1
    assert "Plain=20glass=20=7C=20Plain=20glass_Layer_2" in text


def test_more_layers_than_energyplus_reads(call, room, glass):
    outcome = call("glazing", "stack", *[glass] * 6, "--energyplus", "s.idf")
    assert outcome.status != 0
    assert "EnergyPlus reads at most 5" in outcome.err
    assert not (room / "s.idf").exists()


def test_a_tree_is_walked(call, room, glass):
    words = ("--tree", "1", "--walkers", "16", "--basis", "quarter", "-q")
    outcome = call("glazing", "stack", glass, *words, "-o", "t.xml")
    assert (outcome.status, outcome.out) == (0, "")
    assert read_bsdf(room / "t.xml").has("reflection_back", channel="solar")


def test_heat_is_reported(call, glass):
    pytest.importorskip("pywincalc")
    outcome = call("glazing", "stack", glass, "--basis", "quarter", "--thermal")
    assert "SHGC" in outcome.out
    assert "W/(m2 K)" in outcome.out


def test_built_in_products_are_described(call):
    outcome = call("glazing", "info", "library:double-lowe-6")
    assert outcome.status == 0
    assert outcome.out.count("clear-6: Glass") == 1
    assert "absorbed by 2" in outcome.out


def test_products_and_folders_are_described(call, room, glass):
    assert "Plain glass: Glass" in call("glazing", "info", glass).out
    (room / "shop").mkdir()
    (room / "shop" / "glass.dat").write_text(GLASS)
    outcome = call("glazing", "info", "shop")
    assert outcome.out.split()[:3] == ["12", "Plain", "glass"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["none.dat"], "none.dat: cannot be read"),
        (
            ["glass.dat", "--gas", "argon=x"],
            "name and fraction such as argon=0.9",
        ),
        (["glass.dat", "x.toml"], "one file expected"),
    ],
)
def test_bad_input_is_one_line(call, glass, words, message):
    outcome = call("glazing", "stack", *words)
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
