"""Solar radiation and loads of windows in EnergyPlus: what the models differ by.

EnergyPlus runs alone, with one time step in an hour, so that its sun is where the sun
is in the middle of the hour.
"""

import importlib.util
from dataclasses import replace

import numpy as np
import pytest

from clerestory.energyplus.building_model import read_building_model
from clerestory.energyplus.complex_fenestration import complex_fenestration
from clerestory.energyplus.engine_run import AnnualRun, Output, simulate
from clerestory.energyplus.input_objects import as_idf
from clerestory.glazing.stack import stack_layers
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.patch_interpolation import patch_weights
from energy_models import (
    DEMO_OFFICE,
    PANE,
    PLAIN,
    SMALL_OFFICE,
    blind,
    double_glazing,
    shaded_glazing,
)
from slat_walk import pane_pair, transmitted

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        importlib.util.find_spec("pyenergyplus") is None,
        reason="EnergyPlus is not installed (extra energy)",
    ),
]

FULL = klems("full")
AREA, DIM = 3.0, 20.0
HOURLY = ("Timestep,4", "Timestep,1")
EVERY_STEP = "ShadowCalculation,PolygonClipping,Timestep;"
WINDOW = {
    "beam": "Surface Outside Face Incident Beam Solar Radiation Rate per Area",
    "sky": "Surface Outside Face Incident Sky Diffuse Solar Radiation Rate per Area",
    "ground": "Surface Outside Face Incident Ground Diffuse Solar Radiation Rate per"
    " Area",
    "cosine": "Surface Outside Face Beam Solar Incident Angle Cosine Value",
    "beam in": "Surface Window Transmitted Beam Solar Radiation Rate",
    "diffuse in": "Surface Window Transmitted Diffuse Solar Radiation Rate",
}
SUN = {"altitude": "Site Solar Altitude Angle", "azimuth": "Site Solar Azimuth Angle"}


@pytest.fixture(scope="module")
def systems():
    """Systems on the full Klems basis: optical properties, and IDF text."""
    found = {}
    for system in (double_glazing(), shaded_glazing(45)):
        light = stack_layers(system.layers, partition=FULL, method="bands")
        found[system.name] = light, as_idf(complex_fenestration(system, light))
    return found


@pytest.fixture
def run(tmp_path, shared_data):
    """Function that returns hourly outputs of a year of Chicago."""

    def simulated(text, outputs):
        path = tmp_path / "in.idf"
        path.write_text(text)
        model = read_building_model(path).objects
        weather = shared_data / "weather" / "chicago.epw"
        return simulate(AnnualRun(model, weather, [], outputs))

    return simulated


@pytest.fixture
def hours(run):
    """Function that returns the sun on the window of a construction, by name."""

    def of_window(construction, objects):
        text = SMALL_OFFICE.text(construction, objects, EVERY_STEP).replace(*HOURLY)
        outputs = [Output(name, "South Window") for name in WINDOW.values()]
        outputs += [Output(name, "Environment") for name in SUN.values()]
        names = [*WINDOW, *SUN]
        return dict(zip(names, run(text, outputs), strict=True))

    return of_window


def solar_transmittance(light):
    return light.direct_hemispherical("transmission_front", channel="solar")


def hemispherical(light):
    """Transmittance of radiation that is equal from all directions."""
    share = FULL.projected_solid_angles() / np.pi
    return float(solar_transmittance(light) @ share)


def test_clear_glass_transmits_what_ordinary_glazing_does_in_every_hour(hours, systems):
    """With EnergyPlus' radiation on the window, and its one diffuse transmittance."""
    light, _ = systems["clear"]
    found = hours("plain", PLAIN)
    diffuse = hemispherical(light) * (found["sky"] + found["ground"])
    lit = found["beam"] + found["sky"] + found["ground"] > DIM
    expected = (found["beam in"] + found["diffuse in"])[lit]
    assert lit.sum() > 4000
    cosine = np.clip(found["cosine"], 1e-3, 1)
    exact = AREA * (pane_pair(PANE.material)(cosine)[0] * found["beam"] + diffuse)[lit]
    np.testing.assert_allclose(exact, expected, rtol=0.01)

    # Interpolation between patches differs where the sun grazes the window
    way = np.stack([0 * cosine, -np.sqrt(1 - cosine**2), cosine], axis=1)
    between = solar_transmittance(light) @ patch_weights(FULL, way)
    ours = AREA * (between * found["beam"] + diffuse)[lit]
    near = np.abs(ours / expected - 1) < 0.03
    assert near.mean() > 0.97
    assert expected[near].sum() > 0.99 * expected.sum()
    assert ours.sum() == pytest.approx(expected.sum(), rel=0.005)


def test_a_state_has_the_transmittance_of_the_patch_with_the_sun(hours, systems):
    light, objects = systems["clear"]
    found = hours("clear", objects)
    sunny = found["beam"] > DIM
    cosine = np.clip(found["cosine"][sunny], 1e-3, 1)
    way = np.stack([0 * cosine, -np.sqrt(1 - cosine**2), cosine], axis=1)
    patch = solar_transmittance(light)[FULL.find(way)]
    ratio = found["beam in"][sunny] / (AREA * found["beam"][sunny])
    # Apart from suns on a limit between two rings
    assert np.mean(np.abs(ratio / patch - 1) < 0.001) > 0.99


def test_sunlight_through_a_blind_by_random_walks_between_the_slats(hours, systems):
    """Interpolated transmittance is nearer to the walks than EnergyPlus' patch."""
    light, objects = systems["blind"]
    found = hours("blind", objects)
    sunny = np.flatnonzero((found["beam"] > DIM) & (found["altitude"] > 1))
    chosen = sunny[:: len(sunny) // 100]
    altitude, azimuth = (np.radians(found[name][chosen]) for name in SUN)
    # The window faces south; azimuths are measured from north to east
    level = np.cos(altitude)
    way = np.stack(
        [level * -np.sin(azimuth), -np.sin(altitude), level * -np.cos(azimuth)], axis=1
    )
    panes = pane_pair(PANE.material)
    slats = {"slats": blind(45).slats, "reflectance": 0.7, "gap": 0.05}
    walked = np.array([transmitted(each, panes, **slats) for each in way])
    ours = solar_transmittance(light) @ patch_weights(FULL, way)
    theirs = found["beam in"][chosen] / (AREA * found["beam"][chosen])
    beam = found["beam"][chosen] / found["beam"][chosen].sum()
    error, other = (beam @ np.abs(each / walked - 1) for each in (ours, theirs))
    assert error < 0.04
    assert other > 2 * error
    assert beam @ ours == pytest.approx(beam @ walked, rel=0.02)


METERS = [Output(f"{use}:EnergyTransfer", sum=True) for use in ("Heating", "Cooling")]


@pytest.mark.parametrize("zone", [SMALL_OFFICE, DEMO_OFFICE], ids=["small", "demo"])
def test_annual_loads_are_those_of_ordinary_windows(zone, run, systems):
    """In rooms that return no sunlight, whose loss through states is EnergyPlus' own.

    Of diffuse sunlight from indoors, EnergyPlus lets clear double glazing absorb and
    transmit half as much if it is a complex fenestration state.
    """
    black = zone.materials.replace("0.9,0.6,0.6", "0.9,1,1")
    black = black.replace("0.9,0.4,0.4", "0.9,1,1")
    room = replace(zone, materials=black)
    _, objects = systems["clear"]
    plain = run(room.text("plain", PLAIN), METERS).sum(axis=1)
    found = run(room.text("clear", objects), METERS).sum(axis=1)
    np.testing.assert_allclose(found, plain, rtol=0.01)
