"""Screens and blinds against geometry that can be done by hand."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.glazing.pane import grey_pane
from clerestory.glazing.screen import PerforatedScreen, WovenShade
from clerestory.glazing.slat_cell import SlatCell, SlatGeometry
from clerestory.glazing.venetian import VenetianBlind
from clerestory.hemisphere.klems import klems

QUARTER = klems("quarter")
GREEN = np.array([550.0])
NORMAL = np.array([[0.0, 0.0, 1.0]])


def oblique(theta_deg, phi_deg=0.0):
    theta, phi = np.radians(theta_deg), np.radians(phi_deg)
    sine = np.sin(theta)
    return np.array([[sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)]])


def totals(layer):
    """What leaves and what is kept from each patch, front and back."""
    shares = layer.matrices(GREEN, QUARTER)
    measure = QUARTER.projected_solid_angles()
    return shares.map(lambda f: np.asarray(measure @ f[0]))


def test_a_thin_perforated_sheet_is_as_open_at_any_angle():
    sheet = replace(grey_pane(0, 0.5), thickness=1e-9)
    screen = PerforatedScreen(sheet, "circular", (0.01, 0.01), (0.003, 0.003))
    for angle in (0, 40, 80):
        assert screen.openness(oblique(angle))[0] == pytest.approx(
            np.pi * 0.09, abs=1e-6
        )


def test_thickness_shades_square_holes():
    """A hole as deep as wide passes nothing beyond 45° in its plane."""
    sheet = replace(grey_pane(0, 0), thickness=0.01)
    screen = PerforatedScreen(sheet, "rectangular", (0.02, 0.02), (0.01, 0.01))
    assert screen.openness(oblique(46))[0] == 0
    assert screen.openness(oblique(np.degrees(np.arctan(0.5))))[0] == pytest.approx(
        0.25 * 0.5
    )


def test_overlapping_holes_are_refused():
    with pytest.raises(InputError, match="overlap"):
        PerforatedScreen(grey_pane(0, 0), "circular", (0.01, 0.01), (0.006, 0.006))


def test_cloth_closes_at_its_cut_off_angle():
    cloth = WovenShade(grey_pane(0, 0), thread_diameter=1e-3, thread_spacing=2e-3)
    assert cloth.openness(NORMAL)[0] == pytest.approx(0.25)
    assert cloth.openness(oblique(61))[0] == 0


@pytest.mark.parametrize("reflectance", [0.0, 0.3, 0.9])
def test_screens_make_no_light(reflectance):
    material = grey_pane(0.05, reflectance)
    for layer in (
        WovenShade(material, thread_diameter=0.4e-3, thread_spacing=1e-3),
        PerforatedScreen(material, "circular", (0.01, 0.01), (0.002, 0.002)),
    ):
        for side in ("front", "back"):
            assert np.all(totals(layer).absorption(side) > -1e-9)


def test_view_factors_between_facing_plates_follow_crossed_strings():
    """Two flat slats of width w at distance s: F = √(1 + s²/w²) − s/w."""
    cell = SlatCell.between(SlatGeometry(width=0.05, spacing=0.04, segments=4))
    factors = cell.view_factors()
    weight = cell.lengths[:4] / cell.lengths[:4].sum()
    across = weight @ factors[:4, 4:8].sum(axis=1)
    assert across == pytest.approx(np.sqrt(1 + 0.64) - 0.8, abs=2e-3)
    assert np.allclose(factors.sum(axis=1), 1)
    flux = cell.lengths[:, None] * factors
    assert np.allclose(flux, flux.T, atol=1e-8)


@pytest.mark.parametrize("curvature", [0.0, 0.04, -0.04])
def test_white_slats_lose_nothing(curvature):
    slats = SlatGeometry(width=0.05, spacing=0.04, tilt=0.5, curvature_radius=curvature)
    passed = totals(VenetianBlind(grey_pane(0, 1), slats, distribution="uniform"))
    for side in ("front", "back"):
        kept = passed.absorption(side)
        assert np.all(np.abs(kept) < 0.02)


def test_black_slats_pass_only_what_misses_them():
    slats = SlatGeometry(width=0.05, spacing=0.04, tilt=np.radians(20))
    black = VenetianBlind(grey_pane(0, 0), slats)
    assert np.allclose(totals(black).reflection_front, 0)
    width, rise = 0.05 * np.cos(slats.tilt), 0.05 * np.sin(slats.tilt)
    y, z = QUARTER.centres()[:, 1:].T
    free = np.maximum(1 - np.abs(rise - width * y / z) / 0.04, 0)
    assert np.allclose(totals(black).transmission_front, free, atol=2e-3)


def test_tilted_slats_stop_sun_from_above_and_show_the_ground():
    """Positive tilt turns the edge at the sky down: light from below passes."""
    slats = SlatGeometry(width=0.05, spacing=0.05, tilt=np.radians(40))
    blind = VenetianBlind(grey_pane(0, 0), slats)
    downwards, upwards = oblique(40, 270), oblique(40, 90)
    assert blind.openness(upwards)[0] > 0.9
    assert blind.openness(downwards)[0] == 0


def test_upright_slats_are_the_blind_turned_by_a_right_angle():
    slats = SlatGeometry(width=0.05, spacing=0.04, tilt=0.4)
    lying = VenetianBlind(grey_pane(0, 0.5), slats)
    upright = VenetianBlind(grey_pane(0, 0.5), slats, vertical=True)
    for azimuth in (0, 30, 200):
        assert upright.openness(oblique(30, azimuth))[0] == pytest.approx(
            lying.openness(oblique(30, 90 - azimuth))[0], abs=1e-9
        )


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ({"width": 0.0}, "a positive number expected"),
        ({"tilt": 2.0}, "from -90 to 90"),
        ({"curvature_radius": 0.01}, "more than half the width"),
        ({"segments": 0}, "from 1 to 100"),
    ],
)
def test_slats_that_cannot_be_are_refused(fault, words):
    with pytest.raises(InputError, match=words):
        SlatGeometry(**({"width": 0.05, "spacing": 0.04} | fault))
