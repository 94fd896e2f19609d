"""Patterns in scene files: what they modify, what they know, what is refused."""

import numpy as np
import pytest

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.phases.fingerprint import fingerprint
from clerestory.scene.pattern import Pattern
from clerestory.scene.rad import read_rad

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


def test_directions_without_a_value_are_told(read):
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
        ("void brightfunc p 2 T . 0 0", '"T" is not defined, or not known'),
        ("void brightfunc p 2 noise3(Px,Py,Pz) . 0 0", '"noise3" is not defined'),
        ("void brightfunc p 2 A1 . 0 0", "real argument 1 is asked for; 0 given"),
        ("void brightfunc p 2 f gone.cal 0 0", 'the file "gone.cal" is missing'),
        ("void brightfunc p 2 f bad.cal 0 0", "bad.cal:2: "),
        ("void brightfunc p 2 f(1) loop.cal 0 0", "does it end"),
        ("void brightfunc p 4 Dx . -rq 3 0 0", '"-rq" among its transform'),
        ("void brightfunc p 2 skybr skybright.cal 0 1 1", "takes 3 real arguments"),
        ("void brightdata p 4 noop gone.dat . Dx 0 0", 'file "gone.dat" is missing'),
        ("void brightdata p 3 noop t.dat . 0 0", "3 string arguments; 4"),
        ("void brightdata p 4 huh t.dat . Dx 0 0", '"huh" is not defined'),
        (
            "void brightfunc p 2 Dx . 0 0\np plastic x 0 0 5 .5 .5 .5 0 0",
            "which varies",
        ),
        (
            "void brightfunc p 2 2 . 0 0\np glass x 0 0 3 .5 .5 .5",
            'main.rad:2: glass "x"',
        ),
        ("void brightfunc p 2 2 . 0 0\np sphere s 0 0 4 0 0 0 1", '"p" is a pattern'),
        (
            "void light l 0 0 3 1 1 1\nl brightfunc p 2 2 . 0 0",
            "modified by the material",
        ),
        ("void texfunc p 4 a b c . 0 0", 'main.rad:1: texfunc "p": this type'),
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
