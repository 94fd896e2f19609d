"""Solar properties and surfaces of models, and objects that give their radiation."""

import json
from dataclasses import replace

import numpy as np
import pytest

from clerestory.energyplus.building_model import BuildingModel
from clerestory.energyplus.complex_fenestration import complex_fenestration
from clerestory.energyplus.complex_optics import complex_optics
from clerestory.energyplus.input_objects import as_json
from clerestory.energyplus.scheduled_solar import (
    layer_radiation,
    surface_radiation,
    with_objects,
)
from clerestory.energyplus.zone_enclosure import (
    black_inside,
    inside_surfaces,
    other_windows,
)
from clerestory.errors import InputError
from clerestory.glazing.glazing_system import Gap, GlazingSystem
from clerestory.glazing.stack import stack_layers
from energy_models import BASIS, PANE

PAIR = GlazingSystem("pair", (PANE, PANE), (Gap(0.012),))
LIGHT = stack_layers(PAIR.layers, partition=BASIS, method="bands")


def corners(*points):
    return [
        {f"vertex_{axis}_coordinate": v for axis, v in zip("xyz", p, strict=True)}
        for p in points
    ]


FLOOR = corners((0, 0, 0), (0, 5, 0), (4, 5, 0), (4, 0, 0))
WALL = corners((0, 0, 3), (0, 0, 0), (4, 0, 0), (4, 0, 3))


def model(**changed):
    """A zone of a floor and a wall with a window."""
    objects = {
        "GlobalGeometryRules": {"R": {"vertex_entry_direction": "Counterclockwise"}},
        "Material": {
            "Concrete": {"thickness": 0.1, "solar_absorptance": 0.6},
            "Board": {"thickness": 0.01},
        },
        "Material:NoMass": {
            "Wool": {"thermal_resistance": 4, "solar_absorptance": 0.3}
        },
        "Construction": {
            "Slab": {"outside_layer": "Concrete"},
            "Wall": {
                "outside_layer": "Concrete",
                "layer_2": "Wool",
                "layer_3": "BOARD",
            },
        },
        "BuildingSurface:Detailed": {
            "Floor": {
                "zone_name": "OFFICE",
                "construction_name": "slab",
                "outside_boundary_condition": "Adiabatic",
                "vertices": FLOOR,
            },
            "South": {
                "zone_name": "Office",
                "construction_name": "Wall",
                "outside_boundary_condition": "Outdoors",
                "vertices": WALL,
            },
        },
        "FenestrationSurface:Detailed": {
            "Pane": {"building_surface_name": "SOUTH"},
        },
    }
    objects |= as_json(complex_fenestration(PAIR, LIGHT))
    objects = json.loads(json.dumps(objects)) | changed
    return BuildingModel(objects, "m.idf")


def test_matrices_are_those_that_were_written():
    found = complex_optics(model(), "PAIR")
    assert found.partition.matches(BASIS)
    expected = LIGHT.direct_hemispherical("transmission_front", channel="solar")
    np.testing.assert_allclose(found.transmittance, expected, atol=1e-5)
    np.testing.assert_allclose(
        found.front, LIGHT.absorptance["solar", "front"], atol=1e-6
    )
    reflectance, absorbed = found.diffuse_back()
    np.testing.assert_allclose(
        absorbed, LIGHT.diffuse_absorptance(side="back"), atol=1e-6
    )
    back = LIGHT.diffuse("reflection_back", channel="solar")
    assert reflectance == pytest.approx(back, abs=1e-5)


def test_light_is_reflected_absorbed_or_transmitted():
    """The sum of all shares of each incident patch is one, to the digits of files."""
    found = complex_optics(model(), "pair")
    reflected = LIGHT.direct_hemispherical("reflection_front", channel="solar")
    whole = found.transmittance + found.front.sum(axis=0) + reflected
    np.testing.assert_allclose(whole, 1, atol=1e-5)


def test_inside_surfaces_face_the_zone():
    floor, south = inside_surfaces(model(), "office")
    assert (floor.name, floor.construction) == ("Floor", "slab")
    np.testing.assert_allclose(floor.normal, [0, 0, 1])
    np.testing.assert_allclose(south.normal, [0, 1, 0])
    # The absorptance of the innermost layer; EnergyPlus' default is 0.7
    assert (floor.absorptance, south.absorptance) == (0.6, 0.7)


def test_clockwise_corners_face_the_zone_too():
    rules = {"GlobalGeometryRules": {"R": {"vertex_entry_direction": "Clockwise"}}}
    floor, _ = inside_surfaces(model(**rules), "Office")
    np.testing.assert_allclose(floor.normal, [0, 0, -1])


def test_black_inside_faces_keep_thickness_and_outside():
    building = model()
    floor, south = inside_surfaces(building, "Office")
    found = black_inside(building, floor)
    halves = found["Material"]
    assert [m["thickness"] for m in halves.values()] == [0.05, 0.05]
    assert [m["solar_absorptance"] for m in halves.values()] == [0.6, 1.0]
    layers = found["Construction"][floor.scheduled]
    assert list(layers.values()) == list(halves)
    surface = found["BuildingSurface:Detailed"]["Floor"]
    assert surface["construction_name"] == floor.scheduled
    layers = black_inside(building, south)["Construction"][south.scheduled]
    assert list(layers.values())[:2] == ["Concrete", "Wool"]
    whole = with_objects(building.objects, [found])
    assert set(whole["Material"]) == {"Concrete", "Board", *halves}
    assert "thickness" in whole["Material"]["Concrete"]


def test_surfaces_of_two_zones_keep_their_layers():
    building = model()
    floor, _ = inside_surfaces(building, "Office")
    one = building.objects["BuildingSurface:Detailed"]["Floor"]
    one["outside_boundary_condition_object"] = "Ceiling below"
    assert black_inside(building, floor) == {}
    one["outside_boundary_condition_object"] = "FLOOR"
    assert black_inside(building, floor)


def test_schedules_are_those_of_the_actuators():
    values = np.arange(3.0)
    objects, actuator = surface_radiation("Floor", "slab", values)
    (fields,) = objects["SurfaceProperty:SolarIncidentInside"].values()
    name = fields["inside_surface_incident_sun_solar_radiation_schedule_name"]
    assert actuator.key == name
    assert name in objects["Schedule:Constant"]
    objects, actuators = layer_radiation("Pane", {"a": 2, "b": 3}, np.ones((3, 4)))
    layers = objects["ComplexFenestrationProperty:SolarAbsorbedLayers"]
    counts = [len(fields) - 2 for fields in layers.values()]
    assert counts == [2, 3]
    assert [a.key for a in actuators] == list(objects["Schedule:Constant"])


def test_windows_that_the_study_lacks_are_known():
    surfaces = inside_surfaces(model(), "Office")
    assert other_windows(model(), surfaces, ["PANE"]) == []
    assert other_windows(model(), surfaces, []) == ["Pane"]


WRONG = {
    "zone": (lambda: inside_surfaces(model(), "Hall"), 'zone "Hall" without'),
    "class": (
        lambda: inside_surfaces(model(**{"Wall:Exterior": {"W": {}}}), "Office"),
        "Wall:Exterior",
    ),
    "construction": (
        lambda: complex_optics(model(), "Slab"),
        'no Construction:ComplexFenestrationState "Slab"',
    ),
    "matrix": (
        lambda: complex_optics(
            model(**{"Matrix:TwoDimension": {"pair_Basis": {}}}), "pair"
        ),
        "a basis of 0 rings",
    ),
    "material": (
        lambda: inside_surfaces(model(Material={"Board": {}}), "Office"),
        'no Material "Concrete"',
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_lacks_is_one_line(name):
    function, message = WRONG[name]
    with pytest.raises(InputError, match=message) as found:
        function()
    assert str(found.value).startswith("m.idf")
    assert "\n" not in str(found.value)


def test_renamed_systems_have_matrices_of_their_own():
    renamed = replace(PAIR, name="a, b")
    objects = as_json(complex_fenestration(renamed, LIGHT))
    found = complex_optics(BuildingModel(objects), "a=2C=20b")
    assert len(found.front) == 2
