"""Windows of models: areas and orientations of known rectangles."""

import json

import numpy as np
import pytest

from clerestory.energyplus.building_model import BuildingModel, read_building_model
from clerestory.errors import InputError

SQUARE = ((1, 0, 2.5), (1, 0, 1), (3, 0, 1), (3, 0, 2.5))


def model(corners=SQUARE, *, coordinates="Relative", north=0, turn=0, source="m"):
    """A south window of 3 m² in a wall of one zone."""
    vertices = {
        f"vertex_{k}_{axis}_coordinate": float(value)
        for k, corner in enumerate(corners, 1)
        for axis, value in zip("xyz", corner, strict=True)
    }
    return BuildingModel(
        {
            "GlobalGeometryRules": {"R": {"coordinate_system": coordinates}},
            "Building": {"B": {"north_axis": north}},
            "Zone": {"Office": {"direction_of_relative_north": turn}},
            "BuildingSurface:Detailed": {"Wall": {"zone_name": "OFFICE"}},
            "FenestrationSurface:Detailed": {
                "Pane": {"building_surface_name": "wall", **vertices}
            },
            "Construction": {"a": {}},
            "Construction:ComplexFenestrationState": {"b": {}},
        },
        source,
    )


@pytest.mark.parametrize(
    ("settings", "normal"),
    [
        ({}, (0, -1, 0)),
        ({"north": 90}, (-1, 0, 0)),
        ({"turn": 90}, (-1, 0, 0)),
        ({"north": 45, "turn": 45}, (-1, 0, 0)),
        ({"north": 90, "coordinates": "World"}, (0, -1, 0)),
    ],
)
def test_south_turned_clockwise_by_90_degrees_is_west(settings, normal):
    window = model(**settings).window("PANE")
    assert (window.name, window.zone) == ("Pane", "OFFICE")
    assert window.area == pytest.approx(3)
    np.testing.assert_allclose(window.normal, normal, atol=1e-12)


def test_triangles_have_half_the_area():
    assert model(SQUARE[:3]).window("Pane").area == pytest.approx(1.5)


def test_all_kinds_of_constructions_are_known():
    assert model().constructions() == ["a", "b"]


@pytest.mark.parametrize("corners", [SQUARE[:2], SQUARE[:1] * 4])
def test_windows_without_area_are_refused(corners):
    with pytest.raises(InputError, match=r"^m: .*(corners|no area)"):
        model(corners).window("Pane")


def test_unknown_windows_are_refused_with_those_there_are():
    with pytest.raises(InputError, match='"Door"; Pane in the model'):
        model().window("Door")


@pytest.mark.parametrize("text", ["", "[]", "{", '{"Zone": 1}', '{"Zone": {"a": 2}}'])
def test_other_json_is_refused(text, tmp_path):
    path = tmp_path / "a.epJSON"
    path.write_text(text)
    with pytest.raises(InputError, match=r"a\.epJSON: is not epJSON"):
        read_building_model(path)


def test_epjson_is_read_without_the_engine(tmp_path):
    path = tmp_path / "a.epJSON"
    path.write_text(json.dumps(dict(model().objects)))
    assert read_building_model(path).window("pane").area == pytest.approx(3)
    with pytest.raises(InputError, match="no such file"):
        read_building_model(tmp_path / "b.idf")
