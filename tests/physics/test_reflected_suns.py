"""Patches of sunlight by way of mirrors, panes and glossy slats, against closed forms.

Each estimate is repeated by 40 sensors in one place, as by 40 seeds.
"""

import numpy as np
import pytest
from repeated_estimates import agrees
from sun_patch_scenes import (
    DOWN,
    REFLECTORS,
    SENSOR,
    patch,
    place_in,
    reflectors,
    slat,
    slat_light,
)

from clerestory.phases.rendering import irradiance
from clerestory.scene.sensors import Sensors

UPWARDS = np.array([0.0, 0, 1])


@pytest.mark.parametrize("name", REFLECTORS)
@pytest.mark.parametrize("where", [(0, 0), (0.9, -0.9)])
def test_a_reflected_patch_of_sunlight(device, name, where):
    """Its irradiance follows from the laws of reflection, and Fresnel's formulas."""
    corners, truth = patch(name)
    place = place_in(corners, *where)
    agrees(reflectors(name), place, UPWARDS, truth[0], device, samples=1024)


@pytest.mark.parametrize("name", REFLECTORS)
def test_a_reflected_patch_has_sharp_edges(device, name):
    """Beyond the penumbra, the floor in the shade of the canopy is dark."""
    corners, truth = patch(name)
    sides = (1.1, 0), (-1.1, 0), (0, 1.1), (0, -1.1)
    places = np.array([place_in(corners, *side) for side in sides])
    sensors = Sensors(places, np.tile(UPWARDS, (4, 1)))
    found = irradiance(reflectors(name), sensors, samples=4096, device=device)
    assert np.all(found.irradiance < 1e-3 * truth)


@pytest.mark.parametrize(("facets", "rough"), [(1, 0.03), (1, 0.012), (8, 0.03)])
def test_a_glossy_slat_reflects_the_sun(device, facets, rough):
    """Flat slats, and one of eight facets, each with its own highlight."""
    truth, variance = slat_light(facets, rough)
    agrees(slat(facets, rough), SENSOR, DOWN, truth, device, variance=variance)
