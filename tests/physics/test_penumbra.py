"""Sun behind a straight edge: the visible share of the disc is that of a segment."""

from dataclasses import replace

import numpy as np
import pytest
from physics_scenes import grey, quad

from clerestory.constants import SUN_DIAMETER
from clerestory.engine.controller import estimate
from clerestory.phases.unscattered_light import sun_job, unscattered_sun
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors

UP = np.array([[0.0, 0.0, 1.0]])


def half_plane():
    """A black plane at z = 1 m that ends at x = 0, as far as sensors can tell."""
    far = 1e3
    edge = quad((0, -far, 1), (far, -far, 1), (far, far, 1), (0, far, 1))
    return Scene({"wall": grey(0.0)}, (edge,))


def segment_share(distance):
    """Share of a disc of radius 1 beyond a chord at a distance from its centre."""
    x = np.clip(distance, -1, 1)
    return (np.arccos(x) - x * np.sqrt(1 - x**2)) / np.pi


def in_the_penumbra(count):
    """Sensors below the edge, from shade to sun, and chords in radii of the disc."""
    radius = np.tan(SUN_DIAMETER / 2)
    chord = np.linspace(-1.5, 1.5, count)
    places = np.zeros((count, 3))
    places[:, 0] = chord * radius
    return Sensors(places, np.repeat(UP, count, axis=0)), chord


def test_share_of_the_disc_in_the_penumbra_of_an_edge(device):
    """Between umbra and full sun, C_ds is the visible share of the disc."""
    sensors, chord = in_the_penumbra(121)
    found = unscattered_sun(
        half_plane(), sensors=sensors, suns=UP, samples=4096, seed=2, device=device
    )
    share, expected = found.values[0, :, 0], segment_share(chord)
    error = np.sqrt(np.square(found.components[:, 0, :, 0]).sum(axis=0))
    partly = (expected > 0.05) & (expected < 0.95)
    assert np.all(abs(share - expected)[partly] < 4 * error[partly])
    assert error.max() < 0.01
    # Of a disc whose probes are alike, 3 % may be hidden or visible
    np.testing.assert_allclose(share, expected, atol=0.03)
    assert np.mean(share - expected) == pytest.approx(0, abs=0.003)


def test_partly_visible_discs_have_all_samples(device):
    """Where probes differ, the result is the mean of all samples, traced one by one."""
    sensors, chord = in_the_penumbra(41)
    how = {"sensors": sensors, "suns": UP, "samples": 1024, "device": device}
    found = unscattered_sun(half_plane(), **how).values[0, :, 0]
    job, effort = sun_job(
        unscattered_sun, half_plane(), sensors, UP, {"samples": 1024, "device": device}
    )
    whole = estimate(replace(job, probes=None), effort).values[0, :, 0]
    partly = abs(chord) < 0.9
    np.testing.assert_allclose(found[partly], whole[partly], rtol=1e-6)
    np.testing.assert_allclose(found, whole, atol=0.03)
