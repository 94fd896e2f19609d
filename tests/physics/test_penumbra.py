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
    # A disc that is alike at the rim has four rays: 5 % of it are hidden or visible
    np.testing.assert_allclose(share[partly], expected[partly], atol=0.03)
    assert np.mean(share - expected) == pytest.approx(0, abs=0.003)


def test_partly_visible_discs_have_all_samples(device):
    """Where the rim is partly hidden, the result is the mean of all samples."""
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


def perforated_sheet(*, pitch, share):
    """A black sheet of 0.2 m at z = 1 m with square holes that fill a share of it."""
    half, solid, bars = 0.1, pitch * (1 - share**0.5), []
    for one in np.arange(-half, half - pitch / 2, pitch):
        other = one + solid
        bars.append(
            quad((one, -half, 1), (other, -half, 1), (other, half, 1), (one, half, 1))
        )
        bars.append(
            quad((-half, one, 1), (half, one, 1), (half, other, 1), (-half, other, 1))
        )
    return Scene({"wall": grey(0.0)}, tuple(bars))


def test_holes_finer_than_the_disc_are_estimated_without_bias(device):
    """Sun through a sheet with holes of 0.4 mm, 5 % of it; the disc covers 9.3 mm."""
    rng = np.random.default_rng(5)
    places = np.column_stack([rng.uniform(-0.04, 0.04, (100, 2)), np.zeros(100)])
    suns = np.column_stack([rng.uniform(-0.03, 0.03, (60, 2)), np.ones(60)])
    suns /= np.linalg.norm(suns, axis=1, keepdims=True)
    found = unscattered_sun(
        perforated_sheet(pitch=0.002, share=0.05),
        sensors=Sensors(places, np.repeat(UP, len(places), axis=0)),
        suns=suns,
        seed=4,
        device=device,
    )
    share, parts = found.values[0] / suns[:, 2], found.components[:, 0] / suns[:, 2]
    # All sensors have the same points of a disc, and each disc has others
    of_suns = np.sum(np.square(parts.mean(axis=1)), axis=0)
    error = np.sqrt(of_suns.sum()) / len(suns)
    assert abs(share.mean() - 0.05) < 4 * error
    assert error < 0.05 * 0.05
    # Errors of single sensors and suns are stated as well
    stated = np.square(parts).sum(axis=0).mean()
    assert np.square(share - 0.05).mean() == pytest.approx(stated, rel=0.2)
