"""Descriptions of glazing systems, gaps, and heat."""

import pytest

from clerestory.errors import ClerestoryError, InputError
from clerestory.glazing import wincalc
from clerestory.glazing.glazing_system import Gap, GlazingSystem
from clerestory.glazing.layer import Glass
from clerestory.glazing.thermal import thermal_figures
from clerestory.glazing.venetian import VenetianBlind
from clerestory.library.system_file import read_system

PLAN = """
name = "Test"
[[layer]]
file = "glass.json"
[[gap]]
thickness_mm = 16
gases = { argon = 0.9, air = 0.1 }
[[layer]]
venetian = { material = "glass.json", width_mm = 25, spacing_mm = 20, tilt_deg = 45 }
flipped = true
"""


@pytest.fixture
def plan(tmp_path, product, write_json):
    """Write a description beside a product, with changes to its text."""
    write_json(product)

    def write(text=PLAN):
        path = tmp_path / "system.toml"
        path.write_text(text)
        return path

    return write


def test_a_description_is_read(plan):
    system = read_system(plan())
    assert system.name == "Test"
    assert isinstance(system.layers[0], Glass)
    blind = system.layers[1]
    assert isinstance(blind, VenetianBlind)
    assert blind.slats.tilt < 0  # flipped
    assert system.gaps == (Gap(0.016, {"argon": 0.9, "air": 0.1}),)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("name =", "nam =", 'unknown key "nam"; one of name'),
        ("tilt_deg", "tilt", r'unknown key "layer\[2\]\.venetian\.tilt"'),
        ('file = "glass.json"', 'file = "none.json"', r"none\.json: cannot be read"),
        (
            'file = "glass.json"',
            "flipped = true",
            "layer 1: nothing defined; one of file",
        ),
        ("argon = 0.9", "argon = 0.5", "sum to 0.6; 1 expected"),
        ("argon", "helium", "the gas is 'helium'; one of air"),
        ("width_mm = 25", "width_mm = -1", "is -1; a number above 0 expected"),
        ("[[gap]]", "[[gap]]\nthickness_mm = 3\n[[gap]]", "2 gaps between 2 layers"),
        ("name", "= name", "not TOML"),
    ],
)
def test_a_faulty_description_is_reported_in_one_line(plan, old, new, words):
    with pytest.raises(InputError, match=words) as caught:
        read_system(plan(PLAN.replace(old, new, 1)))
    assert "\n" not in str(caught.value)


def test_gaps_must_fit_the_layers(clear):
    with pytest.raises(InputError, match="1 expected"):
        GlazingSystem("x", (Glass(clear), Glass(clear)), ())


def test_heat_without_its_engine_says_what_to_install(clear, monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(wincalc.importlib, "import_module", missing)
    with pytest.raises(ClerestoryError, match=r"clerestory\[thermal\]"):
        thermal_figures([Glass(clear)])


def test_heat_wants_a_gap_between_layers(clear):
    with pytest.raises(InputError, match="1 expected"):
        thermal_figures([Glass(clear)] * 2)
