"""The bundled BSDFs do what their geometry says: up is up, in is in."""

from importlib.resources import files

import numpy as np
import pytest

from clerestory.bsdf.xml_reader import read_bsdf

WIDTH, SPACING = 25.4, 21.0  # slats tilted by 45°, outer edge down [mm]
VISIBLE_TRANSMITTANCE = 0.64


@pytest.fixture(scope="module")
def blind():
    return read_bsdf(files("clerestory") / "demo" / "venetian_blind.xml")


@pytest.fixture(scope="module")
def pane():
    return read_bsdf(files("clerestory") / "demo" / "double_pane.xml")


def towards(altitude_deg):
    """Direction to a point outside, straight ahead at this altitude."""
    altitude = np.radians(altitude_deg)
    return np.array([0, np.sin(altitude), -np.cos(altitude)])


def exit_flux(blind, altitude_deg):
    """Flux into each exit patch per flux from a source at this altitude."""
    part = blind.function("transmission_front")
    source = part.incidents.find(-towards(altitude_deg))
    return part.values[:, source] * part.exits.projected_solid_angles(), source


def test_pane_has_the_transmittance_of_the_test_room(pane):
    share = pane.direct_hemispherical()
    assert share[0] == pytest.approx(VISIBLE_TRANSMITTANCE, rel=1e-3)
    assert share.max() == share[0]
    energy = share + pane.direct_hemispherical("reflection_front")
    assert energy.max() <= 1


def test_blind_passes_no_more_than_the_glazing(blind, pane):
    assert np.all(blind.direct_hemispherical() <= pane.direct_hemispherical() + 0.01)
    assert blind.direct_hemispherical().min() > 0.01


def test_light_along_the_normal_passes_between_the_slats(blind):
    """The open share of the face is (21 mm - 25.4 mm·sin 45°) / 21 mm, times 0.64."""
    open_share = (SPACING - WIDTH * np.sin(np.radians(45))) / SPACING
    flux, source = exit_flux(blind, 0)
    assert flux[source] == pytest.approx(open_share * VISIBLE_TRANSMITTANCE, rel=0.05)


@pytest.mark.parametrize("altitude", [20, 30, 40, 50, 60, 70])
def test_no_sun_from_above_passes_straight_on(blind, altitude):
    """Slats tilted by 45° cut off all light that falls more steeply than 10°."""
    flux, source = exit_flux(blind, altitude)
    assert flux[source] < 0.002


@pytest.mark.parametrize("altitude", [20, 30, 40, 50, 60, 70])
def test_sun_from_above_is_sent_upwards(blind, altitude):
    """Between slats whose inner edges are higher, light leaves towards the ceiling."""
    flux, _ = exit_flux(blind, altitude)
    up = blind.function("transmission_front").exits.centres()[:, 1]
    assert flux[up > 0.01].sum() > 1.4 * flux[up < -0.01].sum()


def test_the_ground_is_seen_between_the_slats_and_the_sky_is_not(blind):
    from_ground, source = exit_flux(blind, -45)
    assert from_ground[source] > 0.4
    assert from_ground.sum() > 5 * exit_flux(blind, 45)[0].sum()


def test_left_and_right_are_alike(blind):
    part = blind.function("transmission_front")
    mirror = part.exits.find(part.exits.centres() * [-1, 1, 1])
    np.testing.assert_allclose(
        part.values[np.ix_(mirror, mirror)], part.values, rtol=1e-3, atol=1e-5
    )


def test_up_and_down_are_not_alike(blind):
    part = blind.function("transmission_front")
    mirror = part.exits.find(part.exits.centres() * [1, -1, 1])
    share = part.direct_hemispherical()
    assert np.max(share[mirror] / share) > 5
