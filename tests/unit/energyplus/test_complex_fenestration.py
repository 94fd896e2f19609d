"""Complex fenestration states: what the objects hold, and their text."""

import json

import numpy as np
import pytest

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.energyplus.complex_fenestration import basis_rows, complex_fenestration
from clerestory.energyplus.input_objects import InputObject, write_objects
from clerestory.errors import InputError
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.glazing_system import Gap, GlazingSystem, system_with_equal_gaps
from clerestory.glazing.layer import Glass
from clerestory.glazing.pane import grey_pane
from clerestory.glazing.slat_cell import SlatGeometry
from clerestory.glazing.stack import stack_layers
from clerestory.glazing.venetian import VenetianBlind
from clerestory.hemisphere.klems import klems

PANE = Glass(grey_pane(0.8, 0.08))
BLIND = VenetianBlind(grey_pane(0.0, 0.7), SlatGeometry(width=0.025, spacing=0.02))


def state(system, basis="quarter"):
    """Objects of a system by name."""
    light = stack_layers(system.layers, partition=klems(basis))
    return {one.name: one for one in complex_fenestration(system, light)}


def matrix(one):
    """The values of a matrix object."""
    size = one.fields["number_of_rows"], one.fields["number_of_columns"]
    return np.array(one.values).reshape(size)


@pytest.mark.parametrize("basis", ["full", "half", "quarter"])
def test_what_is_not_transmitted_or_reflected_is_absorbed(basis):
    objects = state(system_with_equal_gaps([PANE, BLIND], name="s"), basis)
    measure = klems(basis).projected_solid_angles()
    absorbed = sum(matrix(objects[f"s_Layer_{n}_bAbs"])[0] for n in (1, 2))
    light = stack_layers([PANE, BLIND], partition=klems(basis))
    through = light.direct_hemispherical("transmission_back", channel="solar")
    sent_back = measure @ matrix(objects["s_RbSol"])
    np.testing.assert_allclose(absorbed + sent_back + through, 1, atol=1e-4)


def test_rows_are_exit_directions():
    """A layer that turns all light into the first patch fills the first row."""
    partition, values = klems("quarter"), np.zeros((41, 41))
    values[0] = 0.5 / partition.projected_solid_angles()[0]
    matrices = {name: np.zeros((41, 41)) for name in FUNCTIONS}
    matrices["transmission_front"] = values
    layer = BsdfLayer(
        Bsdf(
            {
                (channel, name): ScatteringMatrix(value, partition, partition)
                for channel in ("visible", "solar")
                for name, value in matrices.items()
            }
        )
    )
    found = matrix(state(GlazingSystem("s", (layer,)))["s_TfSol"])
    assert np.all(found[0] > 6)
    assert np.all(found[1:] == 0)


# Polar angles of the middles of the rings, by Klems (1994) and WINDOW [°]
RINGS = {
    "full": [0, 10, 20, 30, 40, 50, 60, 70, 82.5],
    "half": [0, 13, 26, 39, 52, 65, 80.75],
    "quarter": [0, 18, 36, 54, 76.5],
}


@pytest.mark.parametrize("basis", RINGS)
def test_rings_are_those_of_window(basis):
    rows = basis_rows(klems(basis))
    np.testing.assert_allclose(rows[:, 0], RINGS[basis], atol=1e-9)
    assert rows[:, 1].sum() == len(klems(basis))


def test_gases_openings_and_layers_are_named(tmp_path):
    gap = Gap(0.016, {"argon": 0.9, "air": 0.1})
    system = system_with_equal_gaps([PANE, BLIND, PANE], gap=gap, name="a, b; c!")
    light = stack_layers(system.layers, partition=klems("quarter"))
    objects = complex_fenestration(system, light)
    write_objects(tmp_path / "s.epJSON", objects)
    document = json.loads((tmp_path / "s.epJSON").read_text())
    name = "a=2C=20b=3B=20c=21"
    construction = document["Construction:ComplexFenestrationState"][name]
    assert construction["layer_3_name"] == f"{name}_Layer_3"
    mixture = document["WindowMaterial:GasMixture"][f"{name}_Gas_1"]
    assert mixture["gas_1_fraction"] == 0.9
    shade = document["WindowMaterial:ComplexShade"][f"{name}_Layer_2"]
    assert 0 < shade["front_opening_multiplier"] < 1
    assert len(document["Matrix:TwoDimension"][f"{name}_TfVis"]["values"]) == 41**2


def test_every_name_that_is_referred_to_exists():
    objects = state(system_with_equal_gaps([PANE, BLIND, PANE], name="s"))
    names = [
        value
        for one in objects.values()
        for key, value in one.fields.items()
        if key.endswith("_name")
        or key in ("window_thermal_model", "gas_or_gas_mixture_")
    ]
    assert {name for name in names if name} <= objects.keys()


def test_text_has_one_value_for_each_comma(tmp_path):
    """Read back by the rules of IDF: comments after !, fields between commas."""
    system = system_with_equal_gaps([PANE, PANE], name="s")
    light = stack_layers(system.layers, partition=klems("quarter"))
    objects = complex_fenestration(system, light)
    write_objects(tmp_path / "s.idf", objects, comment="two panes\nZone, x;")
    lines = (tmp_path / "s.idf").read_text().splitlines()
    text = "".join(line.split("!")[0] for line in lines)
    read = [part.split(",") for part in text.split(";") if part.strip()]
    assert len(read) == len(objects)
    for cells, one in zip(read, objects, strict=True):
        assert [cells[0].strip(), cells[1].strip()] == [one.kind, one.name]
        assert len(cells) <= 2 + len(one.fields) + len(one.values)


def test_more_layers_than_energyplus_reads_are_refused():
    system = system_with_equal_gaps([PANE] * 6, name="s")
    with pytest.raises(InputError, match="6 layers; EnergyPlus reads at most 5"):
        complex_fenestration(system, stack_layers(system.layers))


def test_properties_of_other_layers_are_refused():
    system = system_with_equal_gaps([PANE, BLIND], name="s")
    with pytest.raises(InputError, match="those of the system's layers expected"):
        complex_fenestration(system, stack_layers([PANE], partition=klems("quarter")))


def test_names_that_differ_in_case_only_are_refused(tmp_path):
    twins = [InputObject("Zone", name, {}) for name in ("A", "a")]
    with pytest.raises(InputError, match="two objects"):
        write_objects(tmp_path / "s.idf", twins)
