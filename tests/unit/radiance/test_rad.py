"""The scene language is read as Radiance reads it."""

import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.model import (
    Cone,
    Glass,
    Glow,
    Light,
    Plastic,
    Polygon,
    Ring,
    Sphere,
)

GREY = "void plastic grey 0 0 5 .5 .4 .3 .02 .1\n"
FLOOR = "grey polygon floor 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n"


@pytest.fixture
def read(tmp_path):
    def read_text(text, **others):
        for name, content in others.items():
            (tmp_path / f"{name}.rad").write_text(content)
        (tmp_path / "main.rad").write_text(text)
        return read_rad(tmp_path / "main.rad")

    return read_text


def test_materials_carry_their_numbers(read):
    made = read(
        GREY + "void glass pane 0 0 3 .9 .8 .7\nvoid glass dense 0 0 4 .9 .8 .7 1.6\n"
        "void glow sky 0 0 4 1 2 3 -1\nvoid light lamp 0 0 3 4 5 6\n"
    ).materials
    assert isinstance(made["grey"], Plastic)
    assert made["grey"].reflectance.tolist() == [0.5, 0.4, 0.3]
    assert (made["grey"].specularity, made["grey"].roughness) == (0.02, 0.1)
    assert isinstance(made["pane"], Glass)
    assert (made["pane"].index, made["dense"].index) == (1.52, 1.6)
    assert isinstance(made["sky"], Glow)
    assert made["sky"].radius == -1
    assert isinstance(made["lamp"], Light)
    assert made["lamp"].radiance.tolist() == [4, 5, 6]
    assert made["lamp"].source.line == 5


def test_surfaces_carry_their_numbers(read):
    scene = read(
        GREY + FLOOR + "grey sphere a 0 0 4 1 2 3 4\ngrey bubble b 0 0 4 1 2 3 4\n"
        "grey cone c 0 0 8 0 0 0 0 0 1 2 1\ngrey cup d 0 0 8 0 0 0 0 0 1 2 0\n"
        "grey cylinder e 0 0 7 0 0 0 0 0 1 2\ngrey tube f 0 0 7 0 0 0 0 0 1 2\n"
        "grey ring g 0 0 8 0 0 0 0 0 2 3 1\n"
    )
    floor, ball, bubble, cone, cup, cylinder, tube, ring = scene.surfaces
    assert isinstance(floor, Polygon)
    assert floor.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert isinstance(ball, Sphere)
    assert (ball.inward, bubble.inward) == (False, True)
    assert isinstance(cone, Cone)
    assert [s.inward for s in (cone, cup, cylinder, tube)] == [False, True, False, True]
    assert (cone.base_radius, cone.top_radius, cylinder.top_radius) == (2, 1, 2)
    assert isinstance(ring, Ring)
    assert (ring.inner_radius, ring.outer_radius) == (1, 3)
    assert ring.normal.tolist() == [0, 0, 1]
    assert [s.source.line for s in scene.surfaces] == list(range(2, 10))


def test_layout_comments_and_quotes_do_not_matter(read):
    scene = read(
        "# a comment\n\tvoid plastic 'light grey'\n0\n0\n5 .5\n.5\t.5 0 0#\n"[:-2]
        + "\n#another\n\r\n\"light grey\" polygon 'the floor' 0 0 9\n0 0 0\r\n1 0 0\r\n"
        "1e0 +1. .0\n  # the end"
    )
    [floor] = scene.surfaces
    assert (floor.material, floor.name) == ("light grey", "the floor")
    assert floor.vertices[2].tolist() == [1, 1, 0]


def test_a_modifier_may_look_like_a_number(read):
    scene = read(
        "void plastic 1 0 0 5 1 1 1 0 0 " + 2 * "1 polygon 2 0 0 9 0 0 0 1 0 0 0 1 0 "
    )
    assert [s.material for s in scene.surfaces] == ["1", "1"]


def test_distant_sources_are_kept_apart(read):
    scene = read("void glow sky 0 0 4 1 1 1 0 sky source dome 0 0 4 0 0 2 180")
    [dome] = scene.distant
    assert scene.surfaces == ()
    assert (dome.direction.tolist(), dome.angle_deg) == ([0, 0, 1], 180)


def test_void_surfaces_are_left_out(read):
    assert read("void polygon gap 0 0 9 0 0 0 1 0 0 0 1 0").surfaces == ()


def test_a_name_means_what_it_meant_when_the_surface_was_read(read):
    dark = "void plastic grey 0 0 5 .1 .1 .1 0 0\n"
    scene = read(GREY + FLOOR + dark + FLOOR + GREY + FLOOR)
    shades = [scene.materials[s.material].reflectance[0] for s in scene.surfaces]
    assert shades == [0.5, 0.1, 0.5]
    assert len(scene.materials) == 2
    assert all(key == material.name for key, material in scene.materials.items())


def test_files_follow_each_other(tmp_path):
    (tmp_path / "materials.rad").write_text(GREY)
    (tmp_path / "room.rad").write_text(FLOOR)
    scene = read_rad(tmp_path / "materials.rad", tmp_path / "room.rad")
    assert scene.surfaces[0].material == "grey"


def test_joined_scenes_keep_their_own_materials(read):
    one = read(GREY + FLOOR)
    two = read("void plastic grey 0 0 5 .1 .1 .1 0 0\n" + FLOOR)
    three = one + two + one
    shades = [three.materials[s.material].reflectance[0] for s in three.surfaces]
    assert shades == [0.5, 0.1, 0.5]
    assert len(three.materials) == 2


@pytest.mark.parametrize("modifier", ["void", "inherit"])
def test_an_alias_stands_for_its_original(read, modifier):
    scene = read(
        GREY + f"{modifier} alias ground grey\n" + FLOOR.replace("grey", "ground")
    )
    [floor] = scene.surfaces
    assert scene.materials[floor.material].reflectance.tolist() == [0.5, 0.4, 0.3]


def test_an_alias_keeps_the_definition_it_was_made_from(read):
    dark = "void plastic grey 0 0 5 .1 .1 .1 0 0\n"
    scene = read(
        GREY + "inherit alias old grey\n" + dark + FLOOR.replace("grey", "old")
    )
    assert scene.materials[scene.surfaces[0].material].reflectance[0] == 0.5


def test_a_repeated_last_vertex_is_dropped(read):
    [floor] = read(GREY + "grey polygon f 0 0 12 0 0 0 1 0 0 1 1 0 0 0 0").surfaces
    assert len(floor.vertices) == 3


def test_a_mirrored_polygon_still_faces_its_mirrored_side(read):
    """The floor's front is up; mirrored at z = 0 it is down."""
    scene = read(GREY + "!xform -mz part.rad\n!xform -I part.rad\n", part=FLOOR)
    for polygon in scene.surfaces:
        a, b, c = polygon.vertices[:3]
        assert np.cross(b - a, c - a)[2] < 0


def test_void_by_xform_leaves_a_file_out(read):
    assert read(GREY + "!xform -m void part.rad", part=FLOOR).surfaces == ()


def test_included_files_are_found_beside_the_top_file_first(tmp_path, monkeypatch):
    sub = tmp_path / "sub"
    sub.mkdir()
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    (tmp_path / "main.rad").write_text(GREY + "!xform sub/part.rad")
    (sub / "part.rad").write_text("!xform a.rad\n!xform b.rad\n!xform c.rad")
    for folder, names in ((tmp_path, "a"), (sub, "ab"), (elsewhere, "abc")):
        for name in names:
            text = FLOOR.replace("floor", f"{folder.name}_{name}")
            (folder / f"{name}.rad").write_text(text)
    names = [s.name for s in read_rad(tmp_path / "main.rad").surfaces]
    assert names == [f"{tmp_path.name}_a", "sub_b", "elsewhere_c"]


def test_glow_reaches_as_far_as_it_is_scaled(read):
    glow = "void glow g 0 0 4 1 1 1 2"
    assert read("!xform -s 3 part.rad", part=glow).materials["g"].radius == 6


def test_an_array_reads_its_file_once(read, monkeypatch):
    scene = read(GREY + "!xform -a 20 -t 1 0 0 -a 30 -t 0 1 0 part.rad", part=FLOOR)
    corners = {tuple(s.vertices[0]) for s in scene.surfaces}
    assert corners == {(x, y, 0) for x in range(20) for y in range(30)}
    assert scene.surfaces[-1].name == "a19.29.floor"


@pytest.mark.parametrize(
    ("item", "message", "kept"),
    [
        ("grey polygon p 0 0 12 0 0 0 1 0 0 1 1 .1 0 1 0", "0.0249 m off its plane", 1),
        ("grey polygon p 0 0 9 0 0 0 1 0 0 2 0 0", "no area and is omitted", 0),
        ("grey polygon p 0 0 12 0 0 0 1 0 0 0 0 0 1 0 0", "no area", 0),
        ("grey sphere p 0 0 4 0 0 0 -2", "radius is -2; the surface is inverted", 1),
        ("grey sphere p 0 0 4 0 0 0 0", "radius is zero; the surface is omitted", 0),
        (
            "grey tube p 0 0 7 0 0 0 0 0 1 -2",
            "radius is -2; the surface is inverted",
            1,
        ),
        (
            "grey cone p 0 0 8 0 0 0 0 0 0 1 2",
            "two ends coincide; the surface is omitted",
            0,
        ),
        (
            "void plastic p 0 0 5 1.2 1 1 0 0",
            "reflectance is 1.2, which violates energy",
            0,
        ),
        ("void plastic p 0 0 5 1 1 1 0 0.8", "roughness is 0.8", 0),
        ("void glass p 0 0 3 1.1 1 1", "transmissivity is 1.1", 0),
    ],
)
def test_doubtful_items_are_named_with_the_size_of_the_doubt(read, item, message, kept):
    with pytest.warns(ClerestoryWarning, match=message) as caught:
        scene = read(GREY + item)
    assert len(scene.surfaces) == kept
    [warning] = caught
    assert "main.rad:2: " in str(warning.message)
    assert '"p"' in str(warning.message)


def test_turned_fronts_of_negative_radii_follow_radiance(read):
    with pytest.warns(ClerestoryWarning):
        ball, hollow = read(
            GREY + "grey sphere a 0 0 4 0 0 0 -2 grey bubble b 0 0 4 0 0 0 -2"
        ).surfaces
    assert (ball.inward, ball.radius, hollow.inward) == (True, 2, False)


def test_many_doubtful_polygons_are_summed_up(read):
    bent = "grey polygon p{} 0 0 12 0 0 0 1 0 0 1 1 .1 0 1 0\n"
    with pytest.warns(ClerestoryWarning) as caught:
        read(GREY + "".join(bent.format(i) for i in range(30)))
    assert len(caught) == 6
    assert "25 more polygons" in str(caught[-1].message)


WORDS = """void grey polygon plastic glass sphere cone ring source alias inherit 0 3
    9 12 -1 1e400 nan 0.5 'a " # ! !xform -a -t -f -n main.rad part.rad | < !cat \\
    #@rfluxmtx é \x00 ( & ; -i -s"""


def refusal(file):
    """The error that a file is refused with, or None; anything else is a fault."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ClerestoryWarning)
        try:
            read_rad(file)
        except InputError as error:
            return error
    return None


@settings(
    max_examples=200,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    text=st.one_of(
        st.text(max_size=80),
        st.lists(st.sampled_from([*WORDS.split(), "\n"]), max_size=40).map(" ".join),
    )
)
def test_any_text_is_read_or_refused_in_one_line(tmp_path, text):
    (tmp_path / "main.rad").write_text(GREY + text, encoding="utf-8")
    (tmp_path / "part.rad").write_text(FLOOR)
    error = refusal(tmp_path / "main.rad")
    assert error is None or str(error).startswith(str(tmp_path))


@settings(max_examples=150, deadline=None)
@given(
    cut=st.integers(0, 700), junk=st.sampled_from(["", "x", " 1 2", '"', "\x00", "-"])
)
def test_files_cut_anywhere_are_read_or_refused(tmp_path_factory, cut, junk):
    text = GREY + FLOOR * 3 + "void glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 1 180\n"
    file = tmp_path_factory.mktemp("cut") / "main.rad"
    file.write_text(text[:cut] + junk + text[cut + 3 :])
    error = refusal(file)
    assert error is None or error.line is not None
