"""MGF: contexts, arrays, sides, and texts that are not MGF."""

import warnings
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.files import read_text
from clerestory.formats import mgf
from clerestory.formats.mgf import parse_mgf
from clerestory.scene.model import Dielectric, Glass, Plastic

SQUARE = """v a =
p 0 0 0
v b =
p 1 0 0
v c =
p 1 1 0
v d =
p 0 1 0
"""


def normal(polygon):
    a, b, c = polygon.vertices[:3]
    across = np.cross(b - a, c - b)
    return across / np.linalg.norm(across)


def test_a_template_gives_values_that_are_changed_in_the_new_context_only():
    text = (
        SQUARE
        + "m one =\nrd .5\nm two = one\nrs .02 .1\nm one\nf a b c\nm two\nf a b c"
    )
    scene = parse_mgf(text)
    one, two = (scene.materials[s.material] for s in scene.surfaces)
    assert (one.specularity, two.specularity, two.roughness) == (0, 0.02, 0.1)
    np.testing.assert_allclose(two.reflectance, 0.5 / 0.98)


def test_the_unnamed_context_starts_anew():
    scene = parse_mgf(SQUARE + "m\nrd .5\nm\nf a b c")
    assert np.all(scene.materials["mat"].reflectance == 0)


def test_a_material_that_changes_between_surfaces_is_two():
    scene = parse_mgf(SQUARE + "m wall =\nrd .5\nf a b c\nrd .2\nf a b c")
    assert list(scene.materials) == ["wall", "wall#2"]


def test_arrays_in_two_dimensions_and_transforms_within():
    """Inner transforms act first; counts run over all instances."""
    text = "xf -a 2 -t 10 0 0 -a 3 -t 0 5 0\nxf -rz 90\nf a b c d\nxf\nxf\nf a b c d"
    scene = parse_mgf(SQUARE + text)
    corners = [s.vertices[1].round(9).tolist() for s in scene.surfaces]
    expected = [[10 * i, 5 * j + 1, 0] for i in range(2) for j in range(3)]
    assert corners == [*expected, [1, 0, 0]]
    assert [s.name for s in scene.surfaces[:2]] == ["a0.0.f1", "a0.1.f2"]


def test_a_mirror_keeps_the_front_where_it_was():
    scene = parse_mgf(SQUARE + "f a b c d\nxf -mx\nf a b c d\nxf -mz\nf a b c d")
    fronts = [normal(s)[2] for s in scene.surfaces]
    assert fronts == [1, 1, -1]


def test_prism_is_closed_and_faces_outwards():
    """The divergence theorem: its volume, from areas and normals of its faces."""
    for length in (0.5, -0.5):
        scene = parse_mgf(SQUARE + f"prism a b c d {length}")
        volume = 0.0
        for s in scene.surfaces:
            v = s.vertices
            for k in range(1, len(v) - 1):
                volume += np.dot(v[0], np.cross(v[k], v[k + 1])) / 6
        assert volume == pytest.approx(length)
        assert len(scene.surfaces) == 6


def test_torus_has_the_area_of_the_surface():
    """Pappus: 4π²·R·r; flat parts come out a little short."""
    scene = parse_mgf("v m =\np 1 2 3\nn 0 1 0\ntorus m 2 3")
    area = 0.0
    for cone in scene.surfaces:
        slant = np.hypot(
            np.linalg.norm(cone.top - cone.base), cone.top_radius - cone.base_radius
        )
        area += np.pi * (cone.base_radius + cone.top_radius) * slant
    assert area == pytest.approx(4 * np.pi**2 * 2.5 * 0.5, rel=0.01)
    assert [cone.inward for cone in scene.surfaces] == [False] * 10 + [True] * 10


@pytest.mark.parametrize(
    ("sides", "kind"), [("", Glass), ("sides 2", Glass), ("sides 1", Dielectric)]
)
def test_clear_material_is_a_pane_with_two_sides_and_a_solid_with_one(sides, kind):
    text = f"m clear =\n{sides}\nir 1.5 0\nrs .08 0\nts .8 0\nv a =\nsph a 1"
    assert isinstance(parse_mgf(text).materials["clear"], kind)


@pytest.mark.parametrize("inner", [0.35, 0.65, 0.9, 1.0])
def test_a_pane_passes_along_its_normal_what_the_file_says(inner):
    """Radiance's rad2mgf: ts = t (1 - F)² / (1 - F² t²), with F of one face."""
    face = (0.52 / 2.52) ** 2
    passed = inner * (1 - face) ** 2 / (1 - (face * inner) ** 2)
    text = f"m clear =\nir 1.52 0\nrs .068 0\nts {passed:.9g} 0\nv a =\nsph a 1"
    found = parse_mgf(text).materials["clear"].transmissivity
    assert found == pytest.approx(inner, rel=2e-3)
    assert found.mean() == pytest.approx(inner, rel=2e-4)


def test_normals_turn_a_face_that_runs_the_wrong_way():
    text = SQUARE.replace("p 0 0 0", "p 0 0 0\nn 0 0 -1").replace(
        "0 0\nv c", "0 0\nn 0 0 -1\nv c"
    )
    text = text.replace("p 1 1 0", "p 1 1 0\nn 0 0 -1") + "f a b c"
    [face] = parse_mgf(text).surfaces
    assert normal(face)[2] == -1


def test_a_long_line_may_be_continued(tmp_path):
    file = tmp_path / "long.mgf"
    file.write_text(SQUARE + "f a \\\r\n b \\\n c\n")
    [face] = parse_mgf(read_text(file), file=file).surfaces
    assert face.source.line == 9
    assert isinstance(parse_mgf(read_text(file), file=file).materials["mat"], Plastic)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("f a b c", 'undefined name "a"'),
        ("v a =\np 1 2", 'p is followed by "1 2"; 3 number'),
        ("p nan 0 0", "3 number"),
        ("p 1e300 0 0", "3 number"),
        ("rd 1.2", "0 to 1 expected"),
        ("rd -0.1", "0 to 1 expected"),
        ("rs .1 -1", "roughness of rs is -1"),
        ("sides 3", "one of 1, 2 expected"),
        ("ir 0 0", "index of refraction is 0; a positive"),
        ("c x = y", 'undefined name "y"'),
        ("c x y", "`name = template` expected"),
        ("cxy .8 .8", "a sum of at most 1"),
        ("cxy .3 0", "y above 0"),
        ("cct 500", "1000 K"),
        ("cspec 400 300 1 1", "increasing wavelengths"),
        ("cspec 400 500 0 0", "without visible light"),
        ("cmix 1 a", "weights and colours"),
        ("v a =\nring a 0 1", "a vertex with a normal"),
        ("v a =\nn 0 0 1\nring a 1 1", "increasing radii"),
        ("v a =\nn 0 0 1\ntorus a 1 1", "increasing radii"),
        ("v a =\ntorus a 0 1", "torus centre has no normal"),
        ("v a =\ncone a 1 a 1", "two different points"),
        ("v a =\ncone a 1 a -1", "equal signs"),
        ("v a =\nsph a 0", "radius 0"),
        ("v a =\nprism a a a 1", "length of a prism is 0"),
        ("fh a b c - d e", "fewer than 3 vertices"),
        ("xf", "none is open"),
        ("xf -q 3", "-t, -rx"),
        ("xf -a x", "a count above 0 expected"),
        ("o", "objects open"),
        ("i room.mgf", "includes another file"),
        ("m a =\nrd .8\ntd .4\nv a =\nsph a 1", "reflects and transmits 1.200"),
        ("xf -a 99999 -a 99999 -t 0 0 1\n#\nv a =\nxf", "1e\\+10 statements"),
        ("xf -t 0 0 1\n" * 65, "more than 64 nested transforms"),
    ],
)
def test_malformed_statements_are_refused_with_their_line(text, message):
    with pytest.raises(InputError, match=message) as caught:
        parse_mgf(text, file="x.mgf", line=10)
    assert 10 <= caught.value.line < 10 + text.count("\n") + 1


def test_endless_arrays_are_refused(monkeypatch):
    monkeypatch.setattr(mgf, "_MOST_STATEMENTS", 100)
    with pytest.raises(InputError, match="at most 100 expected"):
        parse_mgf("xf -a 1000 -t 0 0 1\nv a =\nxf")


def test_unknown_statements_are_left_out_with_a_warning():
    with pytest.warns(ClerestoryWarning, match="'blob' is omitted"):
        scene = parse_mgf(SQUARE + "blob 1 2\nf a b c")
    assert len(scene.surfaces) == 1


VOCABULARY = """v a = b p 0 1 -1 n c x cxy .3 m rd rs td ts ed ir sides f fh - sph cyl
cone ring torus prism xf -a 2 -t -rz -s o 1e99 nan \\ # cmix cspec cct 400"""
WORDS = st.sampled_from(VOCABULARY.split())


@settings(deadline=None, max_examples=150)
@given(st.lists(st.lists(WORDS, max_size=7), max_size=30))
def test_any_text_is_read_or_refused(lines):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ClerestoryWarning)
        with suppress(InputError):
            parse_mgf("\n".join(map(" ".join, lines)))
