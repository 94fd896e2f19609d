"""IFC models: areas, panes, materials, north and site of rooms of known dimensions."""

import importlib.util

import numpy as np
import pytest

from clerestory.errors import ClerestoryError, InputError
from clerestory.formats import ifc_process
from clerestory.formats.ifc import read_ifc
from clerestory.formats.ifc_glazing import is_glass
from clerestory.formats.triangle_outlines import outlines
from clerestory.scene.materials.glass import transmissivity
from clerestory.scene.model import Plastic, Polygon, TriangleMesh
from clerestory.scene.surface import area_vector
from ifc_models import FLOOR, GLASS, OPENING, ifc_room

with_ifcopenshell = pytest.mark.skipif(
    importlib.util.find_spec("ifcopenshell") is None,
    reason="ifcopenshell is not installed: pip install 'clerestory[ifc]'",
)


def area(outline):
    return float(np.linalg.norm(area_vector(outline)))


def surfaces(model, material):
    return [s for s in model.scene.surfaces if s.material.startswith(material)]


def glass(model):
    return surfaces(model, "glazing")


@pytest.fixture
def read(tmp_path):
    def write_and_read(text, **options):
        path = tmp_path / "m.ifc"
        path.write_text(text)
        return read_ifc(path, **options)

    return write_and_read


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    """The room with glass by its style, read once."""
    path = tmp_path_factory.mktemp("ifc") / "room.ifc"
    path.write_text(ifc_room())
    return read_ifc(path)


@with_ifcopenshell
@pytest.mark.parametrize("reversed_", [(), (0, 1), (1,), tuple(range(6))])
def test_the_floor_of_a_space_whose_faces_look_anywhere(read, reversed_):
    """A surface model of a box; floor, ceiling or all faces are the other way round."""
    [space] = read(ifc_room(space_faces=reversed_)).rooms
    assert sum(map(area, space.outlines)) == pytest.approx(20, rel=1e-6)
    assert all(outline[:, 2].max() == pytest.approx(0) for outline in space.outlines)


@with_ifcopenshell
def test_the_floor_of_a_space_is_its_outline(room):
    [space] = room.rooms
    assert space.name == "1.01 Office"
    assert sum(map(area, space.outlines)) == pytest.approx(FLOOR, rel=1e-6)
    assert space.top == pytest.approx(3)
    assert space.contains(np.array([[3.5, 3.5, 1.0]]))
    assert not space.contains(np.array([[3.5, 4.5, 1.0]]))


@with_ifcopenshell
def test_two_panes_of_a_glazing_are_one_surface_between_them(room):
    [pane] = glass(room)
    assert area(pane.vertices) == pytest.approx(GLASS, rel=1e-6)
    assert np.allclose(pane.vertices[:, 1], -0.102)
    assert pane.name == "W1"
    [frame] = [s for s in surfaces(room, "IfcWindow") if s.name == "W1"]
    assert len(frame.faces) == 4 * 12


@with_ifcopenshell
def test_the_wall_is_open_where_the_window_is(room):
    """Both faces of the wall lose the opening, as the reveal shows its depth."""
    [wall] = [s for s in room.scene.surfaces if s.name == "south"]
    corner = wall.vertices[wall.faces]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 2
    inner = np.all(np.abs(corner[:, :, 1]) < 1e-6, axis=1)
    assert normal[inner][:, 1].sum() == pytest.approx(4.4 * 3 - OPENING)


@with_ifcopenshell
def test_reflectances_are_those_of_lm_83_and_are_listed(room):
    used = {name: float(m.reflectance[0]) for name, m in room.scene.materials.items()
            if isinstance(m, Plastic)}  # fmt: skip
    assert used == {
        "IfcSlab_0.20": 0.2,
        "IfcSlab_0.70": 0.7,
        "IfcSlab_0.50": 0.5,
        "IfcWall_0.50": 0.5,
        "IfcFurniture_0.50": 0.5,
        "IfcWindow_0.50": 0.5,
    }
    ceiling = surfaces(room, "IfcSlab_0.70")
    assert all(isinstance(surface, TriangleMesh) for surface in ceiling)
    assert sorted({float(s.vertices[:, 2].max()) for s in ceiling}) == [-0.3, 3.0]
    assert "reflectance 0.7 of IfcSlab (lower side): 2" in room.assumptions
    assert "visible transmittance 0.64 of the glass of IfcWindow: 1" in room.assumptions


@with_ifcopenshell
def test_north_and_site_are_read(room):
    """TrueNorth (1, √3)/2 is 30° clockwise from +y."""
    assert room.north_deg == pytest.approx(-30)
    assert room.site.latitude_deg == pytest.approx(59 + 54 / 60 + 30 / 3600)
    assert room.site.longitude_deg == pytest.approx(-10.75)
    assert room.name == "Test house"


@with_ifcopenshell
@pytest.mark.parametrize(
    ("window", "share", "expected"),
    [
        ("shape", 1.0, GLASS),
        ("box", 1.0, OPENING),
        ("box", 0.75, 0.75 * OPENING),
        ("opening", 0.75, 0.75 * OPENING),
    ],
)
def test_panes_are_found_without_a_style(read, window, share, expected):
    model = read(ifc_room(window=window, numbers={"GlazingAreaFraction": share}))
    [pane] = glass(model)
    assert area(pane.vertices) == pytest.approx(expected, rel=1e-6)
    assert any('IfcWindow "W1": pane' in text for text in model.assumptions)
    frames = [s for s in surfaces(model, "IfcWindow") if isinstance(s, Polygon)]
    rest = sum(area(frame.vertices) for frame in frames)
    assert rest == pytest.approx(OPENING - expected if share < 1 else 0, abs=1e-9)


@with_ifcopenshell
@pytest.mark.parametrize(("value", "share"), [(0.78, 0.78), (78.0, 0.78)])
def test_the_transmittance_is_that_of_the_property_sets(read, value, share):
    numbers = {"Translucency": 0.1, "VisibleLightTransmittance": value}
    model = read(ifc_room(numbers=numbers, metres=1.0, north=None))
    material = model.scene.materials[glass(model)[0].material]
    expected = transmissivity(np.full(3, share), 1.52)
    assert np.allclose(material.transmissivity, expected)
    assert not any("transmittance" in text for text in model.assumptions)
    assert "north: the direction +y, as the file has none" in model.assumptions
    assert sum(map(area, model.rooms[0].outlines)) == pytest.approx(FLOOR)


@with_ifcopenshell
def test_a_map_gives_materials_by_class_and_to_the_rest(read):
    brick = Plastic("brick", np.array([0.3, 0.2, 0.1]))
    rest = Plastic("rest", np.full(3, 0.4))
    model = read(ifc_room(), materials={"IfcWall": brick, "*": rest})
    assert {s.name for s in surfaces(model, "brick")} == {
        *("south", "north", "east", "west", "corner")
    }
    assert {s.name for s in surfaces(model, "rest")} == {"floor", "roof", "desk", "W1"}
    assert len(glass(model)) == 1


@with_ifcopenshell
def test_a_model_far_from_the_origin_is_moved(read, room):
    model = read(ifc_room(shift=1e6, metres=1.0))
    [text] = [text for text in model.assumptions if text.startswith("origin")]
    moved = float(text.split("(")[1].split(",")[0])
    assert np.allclose(
        model.scene.bounds()[:, 0] + moved - 1e6, room.scene.bounds()[:, 0], atol=1e-5
    )


@with_ifcopenshell
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: text[: len(text) // 2], 'no IFC file, or incomplete; "END-'),
        (lambda text: text.replace("IFC4'", "IFC9'"), "cannot be read by ifcopenshell"),
        (lambda text: "solid stl\n" + text[14:], '"ISO-10303-21;" expected at its st'),
        (
            lambda text: text.split("DATA;")[0] + "DATA;\nENDSEC;\nEND-ISO-10303-21;\n",
            "no element with surfaces; walls, slabs or windows expected",
        ),
    ],
)
def test_bad_files_are_refused_in_one_line(read, change, message):
    with pytest.raises(InputError) as caught:
        read(change(ifc_room()))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_without_the_library_the_extra_is_named(read, monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ClerestoryError, match=r"pip install 'clerestory\[ifc\]'"):
        read(ifc_room())


@with_ifcopenshell
def test_a_process_that_crashes_or_hangs_is_an_error(read, tmp_path, monkeypatch):
    script = tmp_path / "crash.py"
    monkeypatch.setattr(ifc_process.ifc_extraction, "__file__", str(script))
    script.write_text("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n")
    with pytest.raises(InputError, match="ended with status -11; an undamaged file"):
        read(ifc_room())
    script.write_text("import time\ntime.sleep(60)\n")
    with pytest.raises(InputError, match="was not read by ifcopenshell within 0 s"):
        read(ifc_room(), seconds=0.3)


@pytest.mark.parametrize("name", ["Glas", "VERRE clair", "Vidrio", "Double glazing"])
def test_words_for_glass(name):
    assert is_glass(name)
    assert not is_glass("Glaswolle")
    assert not is_glass("Fibreglass")


@with_ifcopenshell
def test_the_outline_of_a_tilted_frame_has_its_hole():
    """A square frame of 2 m, 0.5 m wide, in a plane at 45°: 3 m²."""
    outer = np.array([[0, 0], [2, 0], [2, 2], [0, 2]], float)
    inner = np.array([[0.5, 0.5], [1.5, 0.5], [1.5, 1.5], [0.5, 1.5]])
    triangles = []
    for i in range(4):
        j = (i + 1) % 4
        triangles += [(outer[i], outer[j], inner[j]), (outer[i], inner[j], inner[i])]
    turn = np.array([[1, 0, 0], [0, 0.5**0.5, 0.5**0.5]])
    [frame] = outlines(np.array(triangles) @ turn, gap=0.01)
    assert area(frame) == pytest.approx(3)
    assert len(frame) == 4 + 1 + 4 + 1
