"""Patterns in scene files: what they modify, what they know, what is refused."""

import numpy as np
import pytest

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.phases.fingerprint import fingerprint
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.model import Glow, Mixture, Patterned, Plastic, Textured
from clerestory.scene.pattern import Pattern

UP = np.array([[0.0, 0.0, 1.0]])
SLANT = np.array([[0.6, 0.0, 0.8]])


@pytest.fixture
def read(tmp_path):
    def read_text(text, **files):
        for name, content in files.items():
            (tmp_path / name.replace("_", ".")).write_text(content)
        (tmp_path / "main.rad").write_text(text)
        return read_rad(tmp_path / "main.rad").materials

    return read_text


@pytest.mark.parametrize(
    "emitter",
    [
        "light x 0 0 3 1 1 1",
        "glow x 0 0 4 1 1 1 0",
        "illum x 0 0 3 1 1 1",
        "spotlight x 0 0 7 1 1 1 30 0 0 -1",
    ],
)
def test_every_emitter_takes_a_pattern(read, emitter):
    pattern = read(f"void brightfunc p 2 Rdot . 0 0\np {emitter}")["x"].pattern
    assert isinstance(pattern, Pattern)
    assert pattern.needs_normal
    assert not pattern.needs_point
    np.testing.assert_allclose(pattern.value(SLANT, UP, UP), 0.8)


def test_a_function_sees_light_come_towards_the_viewer(read):
    """D points from the viewer: against light that leaves, along that from a sky."""
    pattern = read("void brightfunc p 2 2+Dz . 0 0\np light x 0 0 3 1 1 1")["x"].pattern
    assert pattern.value(UP, UP, UP)[0, 0] == 1
    assert pattern.value(UP)[0, 0] == 3


def test_a_turned_file_turns_its_patterns(read):
    """A function of its own x looks along y after a turn by 90°."""
    inner = "void brightfunc p 2 2+Dx . 0 0\np light x 0 0 3 1 1 1"
    turned = read("!xform -rz 90 in.rad", in_rad=inner)["x"].pattern
    north = np.array([[0.0, 1.0, 0.0]])
    assert turned.value(north)[0, 0] == pytest.approx(3)
    twice = inner.replace("2 2+Dx .", "4 2+Dx . -rz 90")
    assert read("!xform -rz 90 in.rad", in_rad=twice)["x"].pattern.value(
        -np.array([[1.0, 0.0, 0.0]])
    )[0, 0] == pytest.approx(3)


def test_scale_and_shift_reach_the_point(read):
    """P in the function's coordinates: back from where xform put it."""
    text = "void brightfunc p 7 Px . -s 2 -t 10 0 0 0 0\np light x 0 0 3 1 1 1"
    text = text.replace("p 7", "p 8")
    pattern = read(text)["x"].pattern
    assert pattern.needs_point
    at = np.array([[16.0, 0.0, 0.0]])
    assert pattern.value(UP, UP, at)[0, 0] == pytest.approx(3)


def test_patterns_modify_patterns(read):
    text = "void brightfunc a 2 3 . 0 0\na brightfunc b 2 Rdot . 0 0\n"
    for modifier, expected in (("inherit", 2.4), ("void", 0.8)):
        lamp = f"{modifier} alias c b\nc light x 0 0 3 1 1 1"
        pattern = read(text + lamp)["x"].pattern
        assert pattern.value(SLANT, UP, UP)[0, 0] == pytest.approx(expected)


def test_constants_tint_what_reflects(read):
    """A pattern that is the same everywhere is a factor of the colour."""
    text = "void colorfunc tint 4 A1 A1/2 .1 . 0 1 .5\n"
    made = read(text + "tint plastic x 0 0 5 .8 .8 .8 0 0")["x"]
    np.testing.assert_allclose(made.reflectance, [0.4, 0.2, 0.08])


def test_tables_are_found_beside_the_scene(read):
    text = "void brightdata p 4 noop t.dat . Rdot 0 0\np light x 0 0 3 1 1 1"
    pattern = read(text, t_dat="1\n0 1 2\n0 10\n")["x"].pattern
    assert pattern.value(SLANT, UP, UP)[0, 0] == pytest.approx(8)


def test_a_file_beside_the_scene_outweighs_ours(read):
    text = "void brightfunc p 2 skybr skybright.cal 0 3 3 1 1\np glow x 0 0 4 1 1 1 0"
    assert read(text)["x"].pattern.value(UP)[0, 0] == pytest.approx(1)
    own = read(text, skybright_cal="skybr = 7;")["x"].pattern
    assert own.value(UP)[0, 0] == 7


def test_directions_without_a_value_are_reported(read):
    """Radiance leaves the pattern out there, so the factor is 1."""
    text = "void brightfunc p 2 5/Dx . 0 0\np light x 0 0 3 1 1 1"
    pattern = read(text)["x"].pattern
    with pytest.warns(ClerestoryWarning, match=r"main.rad:1: .*no value for 1 of 2"):
        value = pattern.value(np.concatenate([UP, SLANT]))
    np.testing.assert_allclose(value[:, 0], [1, 5 / 0.6])


def test_patterns_are_known_again(tmp_path):
    """What a traced matrix depends on: the same file twice, and another function."""
    text = "# {0}\n!gensky 6 21 12 +s\nskyfunc glow g 0 0 4 1 1 1 0\n"
    text += "void brightfunc p 2 {1} . 0 0\np light x 0 0 3 1 1 1\n"
    prints = []
    for note, function in (("one", "Rdot"), ("two\n", "Rdot"), ("one", "2*Rdot")):
        (tmp_path / "sky.rad").write_text(text.format(note, function))
        prints.append(fingerprint(read_rad(tmp_path / "sky.rad")))
    assert prints[0] == prints[1] != prints[2]


def test_no_pattern_takes_light_away_from_darkness(read):
    pattern = read("void brightfunc p 2 -1 . 0 0\np light x 0 0 3 1 1 1")["x"].pattern
    assert pattern.value(UP).tolist() == [[0, 0, 0]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "void brightfunc p 1 Dx 0 0",
            'main.rad:1: brightfunc "p": 1 string arguments',
        ),
        ("void brightfunc p 2 Dx+ . 0 0", 'main.rad:1: brightfunc "p": in "Dx+"'),
        ("void brightfunc p 2 far . 0 0", '"far" is not defined'),
        ("void brightfunc p 2 T . 0 0", '"T" is not defined, or not available'),
        ("void brightfunc p 2 fnoise3(Px,Py,Pz) . 0 0", '"fnoise3" is not defined'),
        ("void brightfunc p 2 A1 . 0 0", "argument 1 is used, but the primitive has 0"),
        ("void brightfunc p 2 f gone.cal 0 0", 'the file "gone.cal" is missing'),
        ("void brightfunc p 2 f bad.cal 0 0", "bad.cal:2: "),
        ("void brightfunc p 2 f(1) loop.cal 0 0", "a recursion that terminates"),
        ("void brightfunc p 4 Dx . -rq 3 0 0", '"-rq" in the transform'),
        (
            "void brightfunc p 2 skybr skybright.cal 0 1 1",
            "real argument 2 is used",
        ),
        ("void brightdata p 4 noop gone.dat . Dx 0 0", 'file "gone.dat" is missing'),
        ("void brightdata p 3 noop t.dat . 0 0", "0 coordinate(s) given"),
        ("void brightdata p 4 huh t.dat . Dx 0 0", '"huh" is not defined'),
        (
            "void brightfunc p 2 2 . 0 0\np dielectric x 0 0 5 .5 .5 .5 1.5 0",
            'main.rad:2: dielectric "x": Dielectric cannot have a pattern',
        ),
        ("void brightfunc p 2 2 . 0 0\np sphere s 0 0 4 0 0 0 1", '"p" is a pattern'),
        ("void texfunc p 4 a b c . 0 0", '"a" is not defined'),
        ("void texfunc p 3 1 1 1 0 0", "3 string arguments; 4"),
        ("void colorpict p 7 r g b x.hdr . 0 0 0 0", "unsupported type"),
    ],
)
def test_what_cannot_be_is_refused_with_its_line(read, text, message):
    files = {
        "bad_cal": "ok = 1;\nf = 1 +;",
        "loop_cal": "f(x) = f(x);",
        "t_dat": "1\n0 1 2\n0 10\n",
    }
    with pytest.raises(InputError) as caught:
        read(text, **files)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


PAIR = (
    "void plastic a 0 0 5 .8 .8 .8 0 0\nvoid plastic b 0 0 5 .1 .1 .1 0 0\n"
    "void mixfunc both 4 a b .25 . 0 0\n"
)


def test_what_reflects_takes_patterns_that_vary(read):
    text = "void brightfunc p 2 frac(Px) . 0 0\np {0}"
    for words in ("plastic x 0 0 5 1 1 1 0 0", "glass x 0 0 3 1 1 1"):
        made = read(text.format(words))["x"]
        assert isinstance(made, Patterned)
        assert made.base.name == "x"


def test_a_pattern_over_a_mixture_is_over_both(read):
    made = read(PAIR + "both brightfunc x 2 .5 . 0 0")["x"]
    assert isinstance(made, Mixture)
    assert made.foreground.reflectance == pytest.approx(0.4)
    assert made.background.reflectance == pytest.approx(0.05)


def test_patterns_stand_above_or_below_the_material(read):
    """Radiance applies what stands between the surface and its material as well."""
    above = "void brightfunc p 2 Px . 0 0\np plastic m 0 0 5 .5 .5 .5 0 0\n"
    below = "void plastic q 0 0 5 .5 .5 .5 0 0\nq brightfunc m 2 Px . 0 0\n"
    for text in (above, below):
        made = read(text)["m"]
        at = np.array([[0.3, 0.0, 0.0]])
        assert made.pattern.value(UP, UP, at)[0, 0] == pytest.approx(0.3)
        assert made.base.reflectance == pytest.approx(0.5)


def test_textures_bend_what_reflects_and_leave_lamps(read):
    text = "void texfunc t 4 0.1 0 0 . 0 0\n"
    made = read(text + "t metal x 0 0 5 .5 .5 .5 .9 .1\nt glow y 0 0 4 1 1 1 0")
    assert isinstance(made["x"], Textured)
    assert isinstance(made["y"], Glow)
    assert made["y"].pattern is None


def test_an_alias_of_void_takes_the_pattern_off(read):
    text = "void brightfunc p 2 Px . 0 0\np plastic x 0 0 5 .5 .5 .5 0 0\n"
    made = read(text + "void alias bare x\ninherit alias same x\np alias again x")
    assert isinstance(made["bare"], Plastic)
    assert isinstance(made["again"], Patterned)
    assert "same" not in made


def test_shares_of_mixtures_may_vary(read):
    made = read(PAIR.replace(".25 .", "Px+A1 .").replace(". 0 0\n", ". 0 1 .25\n"))
    assert isinstance(made["both"].amount, Pattern)
    words = "mixdata both 6 a b noop t.dat . Px"
    text = PAIR.replace("mixfunc both 4 a b .25 .", words)
    data = read(text, t_dat="1 0 1 2 0 1")
    assert data["both"].amount.value(UP, UP, SLANT)[0, 0] == pytest.approx(0.6)


def test_smoothing_files_of_radiance_are_known(read):
    """rev.cal: about the axis, A3 r + A4 outwards and A1 z + A2 along it."""
    text = "void plastic a 0 0 5 .8 .8 .8 0 0\n"
    text += "a texfunc x 4 rev_dx rev_dy rev_dz rev.cal 0 4 1 2 3 4"
    bump = read(text)["x"].texture
    value = bump.program.values(
        bump.expressions,
        {"Px": np.array([3.0]), "Py": np.array([4.0]), "Pz": np.array([5.0]),
         "S": np.ones(1)},
        bump.arguments,
    ).value  # fmt: skip
    np.testing.assert_allclose(value, [[19 * 0.6, 19 * 0.8, 7]])


def test_up_vectors_are_expressions(read):
    """Of constants in the function's frame, or of what a ray knows."""
    text = "void metal2 x 6 0 2*3-5 0 . -rz 90 0 6 .5 .5 .5 .9 .1 .2"
    up = read(text)["x"].up
    np.testing.assert_allclose(up, [-1, 0, 0], atol=1e-12)
    around = "void plastic2 x 4 -Py Px 0 . 0 6 .5 .5 .5 .1 .1 .2"
    assert isinstance(read(around)["x"].up, Pattern)
