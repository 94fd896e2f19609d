"""Scenes for viewers of VTK, decoded by the description of the format."""

import json
import math
import zipfile

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.image.colour_scale import ColourScale
from clerestory.scene.sensor_cells import sensor_faces
from clerestory.study.vtkjs import Surfaces, room_surfaces, write_vtkjs

# index.json of two rectangles, written by vtkJSONDataSetWriter of VTK 9.6.0 (without
# its indices of active arrays)
WRITTEN_BY_VTK = json.loads("""{
"vtkClass": "vtkPolyData",
"points": {"vtkClass": "vtkPoints", "name": "points", "numberOfComponents": 3,
  "dataType": "Float32Array", "ref": {"encode": "LittleEndian", "basepath": "data",
  "id": "Float32_18-13ec12278c18e47a64dd99d582662259"}, "size": 18},
"polys": {"vtkClass": "vtkCellArray", "name": "polys", "numberOfComponents": 1,
  "dataType": "Int32Array", "ref": {"encode": "LittleEndian", "basepath": "data",
  "id": "Int32_10-8795a6175aea6a25da7c9f14488fdc3b"}, "size": 10},
"cellData": {"vtkClass": "vtkDataSetAttributes", "arrays": [{"data": {
  "vtkClass": "vtkDataArray", "name": "DA [%]", "numberOfComponents": 1,
  "dataType": "Float32Array", "ref": {"encode": "LittleEndian", "basepath": "data",
  "id": "Float32_2-c190a256665fcbc1629bafe894d27ecf"}, "size": 2}}]}}""")

TYPES = {"Float32Array": "<f4", "Uint32Array": "<u4"}


def decoded(path):
    """Scene of a file, with the corners and values of each dataset by name."""
    archive = zipfile.ZipFile(path)
    scene = json.loads(archive.read("index.json"))
    found = {}
    for item in scene["scene"]:
        folder = item[item["type"]]["url"]
        dataset = json.loads(archive.read(f"{folder}/index.json"))

        def array(entry, folder=folder):
            reference = entry["ref"]
            assert reference["encode"] == "LittleEndian"
            member = f"{folder}/{reference['basepath']}/{reference['id']}"
            values = np.frombuffer(archive.read(member), TYPES[entry["dataType"]])
            assert values.size == entry["size"]
            return values.reshape(-1, entry["numberOfComponents"])

        points, cells = array(dataset["points"]), array(dataset["polys"]).ravel()
        polygons = []
        while len(cells):
            count = int(cells[0])
            polygons.append(points[cells[1 : 1 + count]])
            cells = cells[1 + count :]
        arrays = [each["data"] for each in dataset["cellData"]["arrays"]]
        values = {each["name"]: array(each).ravel() for each in arrays}
        found[item["name"]] = dataset, polygons, values
    return scene, found


@pytest.fixture
def squares():
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    return np.stack([square, square + np.array([1, 0, 0.5])])


def test_polygons_and_values_return(tmp_path, squares):
    triangle = np.array([[[0.0, 0, 0], [9, 0, 0], [0, 9, 0]]])
    given = Surfaces("grid", squares, {"DA [%]": np.array([10.0, 20.0])})
    write_vtkjs(tmp_path / "a.vtkjs", [given, Surfaces("wall", triangle)])
    scene, found = decoded(tmp_path / "a.vtkjs")
    _, polygons, values = found["grid"]
    assert np.array_equal(polygons, squares)
    assert values["DA [%]"].tolist() == [10, 20]
    assert np.array_equal(found["wall"][1], triangle)
    shown, plain = (item["mapper"] for item in scene["scene"])
    assert shown["colorByArrayName"] == "DA [%]"
    assert (shown["scalarVisibility"], plain["scalarVisibility"]) == (True, False)


def test_datasets_are_those_of_vtk(tmp_path, squares):
    """The description is that of VTK's writer but for digests and unsigned indices."""

    def plain(entry):
        if isinstance(entry, list):
            return [plain(each) for each in entry]
        if not isinstance(entry, dict):
            return {"Int32Array": "Uint32Array", 18: 24}.get(entry, entry)
        return {key: plain(each) for key, each in entry.items() if key != "id"}

    given = Surfaces("grid", squares, {"DA [%]": np.array([10.0, 20.0])})
    write_vtkjs(tmp_path / "a.vtkjs", [given])
    _, found = decoded(tmp_path / "a.vtkjs")
    # VTK shares the corners of neighbours: 6 points (18 numbers) in place of 8
    assert plain(found["grid"][0]) == plain(WRITTEN_BY_VTK)


def test_colours_follow_the_scale(tmp_path, squares):
    values = {"lux": np.array([10.0, 1000.0]), "share": np.array([0.0, 100.0])}
    scales = {
        "lux": ColourScale(10, 1000, (10, 1000), logarithmic=True),
        "share": ColourScale(0, 100, (0, 100)),
    }
    write_vtkjs(
        tmp_path / "a.vtkjs", [Surfaces("grid", squares, values)], scales=scales
    )
    scene, _ = decoded(tmp_path / "a.vtkjs")
    for name, middle in (("lux", 100.0), ("share", 50.0)):
        nodes = np.array(scene["lookupTables"][name]["nodes"])
        scale = scales[name]
        assert nodes[0, 0] == scale.smallest
        assert math.isclose(nodes[-1, 0], scale.largest)
        place = nodes[np.argmin(abs(nodes[:, 0] - middle))]
        assert place[0] == pytest.approx(middle)
        colour = scale.colours(np.array(0.5)) / 255
        assert place[1:4] == pytest.approx(colour)


def test_the_camera_faces_what_has_values(tmp_path, squares):
    """A ground of 1 km does not move the view away from the grid."""
    ground = Surfaces("ground", 1000 * squares - 500)
    grid = Surfaces("grid", squares, {"lux": np.ones(2)})
    write_vtkjs(tmp_path / "a.vtkjs", [ground, grid])
    camera = decoded(tmp_path / "a.vtkjs")[0]["camera"]
    assert camera["focalPoint"] == [1, 0.5, 0.25]
    assert np.linalg.norm(camera["position"]) < 10


def test_rooms_have_a_dataset_for_each_material(squares):
    colours = np.array([[0.5, 0.5, 0.5], [0.2, 0.3, 0.4]])
    found = room_surfaces(squares[:, :3], colours, ["wall", "floor"])
    assert [each.name for each in found] == ["wall", "floor"]
    assert found[1].colour == (0.2, 0.3, 0.4)


def test_a_scene_without_surfaces_is_an_error(tmp_path):
    with pytest.raises(InputError, match="no surfaces; at least one expected"):
        write_vtkjs(tmp_path / "a.vtkjs", [Surfaces("none", np.zeros((0, 3, 3)))])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("facing", [(0, 0, 1), (0, -1, 0), (0.6, 0, 0.8)])
def test_cells_of_sensors_lie_across_their_direction(facing):
    """Cells of a grid in a plane fill it without overlap, and face its direction."""
    facing = np.array(facing, dtype=float)
    across = np.array([0.0, 1, 0]) if facing[0] else np.array([1.0, 0, 0])
    along = np.cross(facing, across)
    u, v = np.meshgrid(np.arange(4) * 0.5, np.arange(3) * 0.4)
    position = u.ravel()[:, None] * across + v.ravel()[:, None] * along
    faces = sensor_faces(position, np.tile(facing, (12, 1)))
    side = faces[:, [1, 3]] - faces[:, :1]
    area = np.cross(side[:, 0], side[:, 1])
    assert np.allclose(area, 0.5 * 0.4 * facing)
    assert np.allclose(faces.mean(axis=1), position)
