"""Checks of directions and of reverse energy, with deliberately faulty layers."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory.bsdf.analytic import clear_air, lambertian, thin_pane
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.quality_checks import check
from clerestory.bsdf.resample import to_trees
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.hemisphere.klems import klems

FULL = klems("full")
THETA_DEG = np.degrees(np.arccos(FULL.centres()[:, 2]))
EVEN = np.full((145, 145), 1 / np.pi)


def names(bsdf):
    return {finding.name for finding in check(bsdf) if finding.matters}


def only(bsdf, name):
    return next(finding for finding in check(bsdf) if finding.name == name)


def matrix(values):
    return ScatteringMatrix(values, FULL, FULL)


def one_sided(front, reflection):
    """A file without the transmission from the back, which follows by reciprocity."""
    return Bsdf(
        {
            ("visible", "transmission_front"): front,
            ("visible", "reflection_back"): reflection,
        }
    )


def changed(bsdf, change):
    functions = {
        key: replace(part, values=change(key[1], part.values.copy()))
        for key, part in bsdf.functions.items()
    }
    return replace(bsdf, functions=functions)


def turned(bsdf, **signs):
    """Exchange incident patches with those of a rotated or mirrored direction."""
    order = FULL.find(FULL.centres() * [signs.get("x", -1), signs.get("y", -1), 1])
    return changed(bsdf, lambda _, values: values[:, order])


def test_energy_of_a_transmission_that_only_reciprocity_gives():
    """Light leaves within 15° of the normal: f = 0.9/π there; 0.9 returns from there.

    With a reflectance of 0.471 of the back, 1.371 of the light leaves the layer.
    """
    table = np.zeros((145, 145))
    table[:9] = 0.9 / np.pi
    bsdf = one_sided(matrix(table), matrix(0.471 * EVEN))
    finding = only(bsdf, "energy")
    assert finding.size == pytest.approx(0.371)
    assert finding.severity == "error"
    assert "reciprocity" in finding.what
    assert "back" in finding.where
    assert "energy" in names(to_trees(bsdf, halvings=4))


def test_energy_of_a_sound_file_with_one_transmission():
    assert names(one_sided(matrix(0.5 * EVEN), matrix(0.4 * EVEN))) == set()


def test_a_file_measured_at_normal_incidence_alone():
    def keep_normal(_, values):
        values[:, 1:] = 0
        return values

    bsdf = changed(lambertian(0.5, FULL, reflectance=0.2), keep_normal)
    finding = only(bsdf, "empty")
    assert finding.size == pytest.approx(144 / 145)
    assert "144 of 145 incident directions" in finding.what
    assert finding.severity == "error"
    front = {k: v for k, v in bsdf.functions.items() if k[1] == "transmission_front"}
    assert "144 of 145" in only(Bsdf(front), "empty").what


@pytest.mark.parametrize("directions", ["incident", "exit"])
def test_directions_beyond_a_measured_range(directions):
    """A goniophotometer that stops at 65°, and zeros beyond."""

    def cut(_, values):
        values[
            (slice(None), THETA_DEG > 65)[:: 1 if directions == "incident" else -1]
        ] = 0
        return values

    finding = only(changed(lambertian(0.5, FULL, reflectance=0.2), cut), "range")
    assert finding.matters
    assert finding.size == pytest.approx(65)
    assert f"{directions} directions beyond 65°" in finding.what


def test_last_measured_ring_repeated_to_the_horizon():
    """A pane whose transmittance no longer falls beyond 55°, as if held constant."""

    def hold(_, values):
        shares = np.diag(values) * FULL.projected_solid_angles()
        ring = FULL.projected_solid_angles()
        grazing = THETA_DEG > 55
        values[grazing, grazing] = shares[60] / ring[grazing]
        return values

    def pane(_, values):
        values[np.arange(145), np.arange(145)] *= np.cos(np.radians(THETA_DEG)) ** 0.2
        return values

    sound = changed(clear_air(FULL), pane)
    assert "range" not in names(sound)
    held = changed(sound, hold)
    finding = only(held, "range")
    assert "65°" in finding.what or "55°" in finding.what
    assert finding.matters


@pytest.mark.parametrize("make", [clear_air, lambda p: thin_pane(0.96, p)])
@pytest.mark.parametrize("basis", ["full", "half", "quarter"])
def test_a_clear_pane_with_incident_azimuths_half_a_turn_off(make, basis):
    """It is reciprocal, and conserves energy: only its peaks are in wrong places."""
    partition = klems(basis)
    order = partition.find(partition.centres() * [-1, -1, 1])
    sound = make(partition)
    functions = {
        key: replace(part, values=part.values[:, order])
        for key, part in sound.functions.items()
    }
    finding = only(replace(sound, functions=functions), "azimuth")
    assert finding.severity == "error"
    assert "half a turn" in finding.what
    assert finding.size > 0.9
    assert "azimuth" not in names(sound)


def test_half_of_the_light_straight_and_half_diffuse_turned():
    air, haze = clear_air(FULL), lambertian(0.5, FULL)
    functions = {
        key: replace(part, values=0.3 * part.values + haze.functions[key].values)
        for key, part in air.functions.items()
    }
    layer = replace(air, functions=functions)
    assert names(layer) == set()
    assert "half a turn" in only(turned(layer), "azimuth").what


def test_a_film_that_mirrors_light_up_and_down_is_not_called_broken():
    """Mirrors parallel to the ground do this."""
    film = turned(clear_air(FULL), x=1)
    assert {f.name: f.severity for f in check(film)}["azimuth"] == "warning"


def test_an_opaque_cloth_is_sound():
    """Transmittances below 1e-4 are noise, and reciprocal in nothing."""
    rng = np.random.default_rng(4)
    bsdf = lambertian(0.0, FULL, reflectance=0.4)

    def noise(name, values):
        if name.startswith("transmission"):
            return 6e-5 / np.pi * rng.random(values.shape) ** 30
        return values

    cloth = changed(bsdf, noise)
    assert names(cloth) == set()
    finding = only(cloth, "opaque")
    assert finding.size < 1e-4

    def one_side(name, values):
        return values if name != "transmission_back" else 0 * values

    assert names(changed(cloth, one_side)) == set()
