"""OBJ files are read whole, and fast."""

import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.formats.obj import read_obj
from clerestory.formats.obj_text import parse_obj
from clerestory.scene.model import Plastic
from clerestory.scene.tessellate import meshes

GREY = Plastic("grey", np.array([0.5, 0.5, 0.5]))
WOOD = Plastic("wood", np.array([0.4, 0.3, 0.2]))
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


@pytest.fixture
def read(tmp_path):
    def read_text(text, library="", **options):
        (tmp_path / "a.obj").write_bytes(text.encode())
        (tmp_path / "a.mtl").write_text(library)
        return read_obj(tmp_path / "a.obj", **{"materials": {"*": GREY}} | options)

    return read_text


def area(scene):
    """Signed area as seen from above."""
    total = 0.0
    for mesh in meshes(scene):
        a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
        total += np.cross(b - a, c - a)[:, 2].sum() / 2
    return total


@pytest.mark.parametrize(
    "faces",
    [
        "f 1 2 3 4",
        "f 1 2 3\nf 1 3 4",
        "f -4 -3 -2 -1",
        "f 1/1 2/2 3/3 4/1",
        "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/1",
        "vn 0 0 1\nf 1//1 2//1 3//1 4//1",
        "  f 1 2 3 4  ",
        "f 1 2 \\\n 3 4",
        "s 1\r\nf 1 2 3 4\r",
        "l 1 2\np 1\n# f 1 2 3\nf 1\t2 3 4",
    ],
)
def test_all_ways_to_write_a_face(read, faces):
    assert area(read(SQUARE + faces)) == pytest.approx(1)


def test_vertices_may_have_weights_and_colours(read):
    """Only the first three numbers are places; lines may differ."""
    text = "v 0 0 0 1\nv 2 0 0 .1 .2 .3\nv 2 2 0\nf 1 2 3"
    assert area(read(text)) == pytest.approx(2)


def test_concave_faces_are_filled_and_no_more(read):
    arrow = "v 0 0 0\nv 2 -1 0\nv 1 0 0\nv 2 1 0\nf 1 2 3 4\n"
    assert area(read(arrow)) == pytest.approx(1)
    cross = "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6"
    assert area(read(cross)) == pytest.approx(5)


def test_negative_indices_count_from_where_they_stand(read):
    text = SQUARE + "f -4 -3 -2\n" + SQUARE.replace("1", "2") + "f -4 -3 -2 -1\n"
    assert area(read(text)) == pytest.approx(0.5 + 4)


def test_materials_come_by_name_then_by_group(read):
    text = SQUARE + "g top\nusemtl wood\nf 1 2 3\ng side\nusemtl\nf 1 3 4\nf 1 2 4\n"
    scene = read(text, materials={"wood": WOOD, "side": GREY})
    assert [(s.name, s.material) for s in scene.surfaces] == [
        ("top", "wood"),
        ("side", "grey"),
    ]
    with pytest.raises(InputError, match=r'a.obj:7: no material for material "wood"'):
        read(text, materials={"side": GREY})


def test_colours_of_the_library_stand_in(read):
    library = "newmtl red\nKd .6 .1 .1\nnewmtl wood\nKd 1 1 1\n"
    text = "mtllib a.mtl\n" + SQUARE + "usemtl red\nf 1 2 3\nusemtl wood\nf 1 3 4\n"
    made = read(text, library, materials={"wood": WOOD}, colours=True).materials
    assert made["red"].reflectance.tolist() == [0.6, 0.1, 0.1]
    assert made["wood"] is WOOD


def test_units_are_scaled(read):
    assert area(read(SQUARE + "f 1 2 3 4", scale=0.01)) == pytest.approx(1e-4)


def test_triangles_without_area_are_counted_and_left_out(read):
    with pytest.warns(ClerestoryWarning, match="1 triangles without area"):
        scene = read(SQUARE + "f 1 2 2\nf 1 2 3\n")
    assert area(scene) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("v 1 2\n", "a.obj:1: a vertex of 2 numbers"),
        ("v 1 2 x\n", 'a.obj:1: "x" is found where'),
        ("v 0 0 0\nv 1 2 nan\n", "a.obj:2: a coordinate is not finite"),
        (SQUARE + "f 1 2\n", "a.obj:5: a face of 2 vertices"),
        (
            SQUARE + "f 1 2 3\nf 1 2 9\n",
            "a.obj:6: a face refers to vertex 9, but 4 precede it",
        ),
        (SQUARE + "f 1 2 0\n", "a.obj:5: a face refers to vertex 0"),
        (SQUARE + "f 1 2 -5\n", "vertex -5"),
        (
            "f 1 2 3\n" + SQUARE,
            "a.obj:1: a face refers to vertex 1, but 0 precede it",
        ),
        (SQUARE + "f 1 2 2.5\n", "vertex 2.5"),
        ("mtllib gone.mtl\n" + SQUARE + "f 1 2 3", 'library "gone.mtl" is missing'),
    ],
)
def test_broken_files_are_refused_with_their_line(read, text, message):
    with pytest.raises(InputError) as caught:
        read(text, colours=True)
    assert message in str(caught.value)


def test_long_files_are_read_in_pieces(monkeypatch):
    """The same triangles, whether the text is cut or not."""
    n = 40
    y, x = np.divmod(np.arange(n * n), n)
    lines = [f"v {a} {b} {a * b % 7}" for a, b in zip(x, y, strict=True)]
    corner = [i + 1 for i in range(n * n - n) if i % n < n - 1]
    lines += [f"f {i} {i + 1} {i + n + 1} -{n * n - i - n + 1}" for i in corner]
    text = "\n".join(lines).encode()
    whole = parse_obj(text, file="a.obj")
    monkeypatch.setattr("clerestory.formats.obj_text._PIECE", 300)
    cut = parse_obj(text, file="a.obj")
    assert len(whole.parts[0].faces) == 2 * (n - 1) ** 2
    order = [np.lexsort(p.parts[0].faces.T) for p in (whole, cut)]
    np.testing.assert_array_equal(
        whole.parts[0].faces[order[0]], cut.parts[0].faces[order[1]]
    )


WORDS = "v f g usemtl mtllib 0 1 2 3 -1 1/2 1//2 / # \\ nan 1e400 x \n \n \n é"
PIECES = st.sampled_from(WORDS.split(" "))


@settings(max_examples=200, suppress_health_check=list(HealthCheck), deadline=None)
@given(st.lists(PIECES, max_size=60))
def test_any_text_is_read_or_refused(tmp_path_factory, words):
    file = tmp_path_factory.getbasetemp() / "any.obj"
    file.write_bytes((SQUARE + " ".join(words)).encode())
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ClerestoryWarning)
            read_obj(file, materials={"*": GREY}).bounds()
    except InputError as error:
        message = str(error)
    else:
        message = ""
    assert "\n" not in message
