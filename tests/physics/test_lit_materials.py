"""Materials in scenes at one instant, where the light has a closed form."""

import numpy as np
import pytest
from physics_scenes import quad, sensor, window

import clerestory as cl
from clerestory.phases.rendering import irradiance
from clerestory.scene.model import (
    DistantSource,
    Glow,
    Illum,
    Light,
    Mirror,
    Mixture,
    Plastic,
    Scene,
    Trans,
    Void,
)

FAR = 1e3
SUN_DEG = 0.5
SUN_SR = 2 * np.pi * (1 - np.cos(np.radians(SUN_DEG / 2)))
BELOW = sensor((0, 0, 0), (0, 0, 1))


def sky():
    """A sky of unit radiance, over a black ground."""
    glow = Glow("sky", np.ones(3))
    return {"sky": glow}, DistantSource(np.array([0.0, 0, 1]), 180.0, "sky")


def sun(direction):
    """A sun of unit irradiance across its beam."""
    light = Light("sun", np.full(3, 1 / SUN_SR))
    direction = np.array(direction) / np.linalg.norm(direction)
    return {"sun": light}, DistantSource(direction, SUN_DEG, "sun")


def under_a_sheet(material, light):
    """A sheet at z = 1 as far as a sensor below can tell."""
    named, source = light
    corners = (-FAR, -FAR, 1), (FAR, -FAR, 1), (FAR, FAR, 1), (-FAR, FAR, 1)
    sheet = quad(*corners, material="sheet")
    return Scene({"sheet": material, **named}, (sheet,), (source,))


def assert_reads(scene, truth, *, precision, where=BELOW, **options):
    """What the sensor reads is the truth, within four standard errors."""
    found = irradiance(scene, where, **options)
    error = found.error.max()
    assert error < precision
    assert found.irradiance[0] == pytest.approx(truth, abs=4 * error + 1e-4)


SHEETS = {
    "diffuse": (Trans("sheet", np.full(3, 0.8), 0.0, 0.0, 0.5, 0.0), 0.8 * 0.5),
    "clear": (Trans("sheet", np.full(3, 0.8), 0.0, 0.0, 0.5, 1.0), 0.8 * 0.5),
    "hidden": (Illum("sheet", np.zeros(3)), 1.0),
    "net": (
        Mixture("sheet", Plastic("sheet", np.full(3, 0.8)), Void(), 0.3),
        0.7,
    ),
}


@pytest.mark.parametrize("name", SHEETS)
def test_a_sheet_passes_its_share_of_the_sky(device, name):
    """E = τπL below, since the ground is black and sends nothing back up.

    An illum passes all light: what it looks like is nothing.
    """
    material, share = SHEETS[name]
    assert_reads(
        under_a_sheet(material, sky()),
        share * np.pi,
        precision=0.03,
        samples=1 << 14,
        device=device,
    )


@pytest.mark.parametrize("name", SHEETS)
def test_a_sheet_passes_its_share_of_the_sun(device, name):
    """Diffusely or straight on, the flux through the sheet is the same: τE·cos θ."""
    material, share = SHEETS[name]
    assert_reads(
        under_a_sheet(material, sun((0.0, 0.6, 0.8))),
        share * 0.8,
        precision=0.03,
        samples=1 << 14,
        device=device,
    )


@pytest.mark.parametrize(("radius", "share"), [(0.0, 1.0), (9.0, 1.0), (-1.0, 0.0)])
def test_a_glow_of_any_radius_lights_a_sensor(device, radius, share):
    """The only emitter, found by chance at radius 0; a square of 2 m overhead at 1 m.

    E = 4 L x atan(y / r) / r for a quarter of sides x = y at height 1, where
    r² = 1 + x². Of negative radius it is seen, but illuminates nothing.
    """
    corners = (-1, 1, 1), (1, 1, 1), (1, -1, 1), (-1, -1, 1)
    panel = quad(*corners, material="panel")
    scene = Scene({"panel": Glow("panel", np.ones(3), radius)}, (panel,), ())
    truth = 4 * np.arctan(1 / np.sqrt(2)) / np.sqrt(2) * share
    options = {"samples": 1 << 14, "seed": 3, "device": device}
    assert_reads(scene, truth, precision=0.02, **options)


def test_diffuse_transmission_counts_as_a_bounce(device):
    """The sky needs two gathers through a diffuser; `-ab 1` sees black beneath it."""
    scene = under_a_sheet(SHEETS["diffuse"][0], sky())
    for bounces, truth in ((1, 0.0), (2, 0.4 * np.pi)):
        assert_reads(
            scene,
            truth,
            precision=0.03,
            samples=1 << 14,
            bounces=bounces,
            device=device,
        )


def test_a_mirror_shows_the_sun_to_a_sensor(device):
    """A sensor that faces the mirror reads ρE·cos θ of the sun behind its back."""
    direction = np.array([0.0, 0.8, 0.6])
    wall = quad((-5, -2, -5), (-5, -2, 5), (5, -2, 5), (5, -2, -5), material="mirror")
    named, source = sun(direction)
    scene = Scene(
        {"mirror": Mirror("mirror", np.full(3, 0.9)), **named}, (wall,), (source,)
    )
    where = sensor((0, 0, 0), (0, -1, 0))
    assert_reads(
        scene, 0.9 * 0.8, precision=1e-3, where=where, samples=256, device=device
    )
    # From behind it is black, and no sun comes through it
    turned = quad(*wall.vertices[::-1], material="mirror")
    black = Scene(scene.materials, (turned,), (source,))
    assert_reads(black, 0.0, precision=1e-3, where=where, samples=256, device=device)


def test_highlights_do_not_count_as_bounces(device):
    """All light of a surface without diffuse part comes with the first gather."""
    wall = quad((-5, 3, -5), (-5, 3, 5), (5, 3, 5), (5, 3, -5), material="shiny")
    shiny = Plastic("shiny", np.ones(3), specularity=1.0, roughness=0.2)
    opening = window(quad((-1, -2, -1), (-1, -2, 1), (1, -2, 1), (1, -2, -1)))
    once, always = (
        cl.view_matrix(
            Scene({"shiny": shiny}, (wall,)),
            opening,
            sensors=sensor((0, 0, 0), (0, 1, 0)),
            samples=1 << 19,
            bounces=bounces,
            seed=seed,
            device=device,
        )
        for bounces, seed in ((1, 1), (None, 2))
    )
    sums = [m.values[0].sum() for m in (once, always)]
    errors = [m.components[:, 0].sum(axis=(1, 2)) for m in (once, always)]
    error = np.sqrt(sum(np.square(e).sum() for e in errors))
    assert error < 0.01 * sums[1]
    assert abs(sums[0] - sums[1]) < 4 * error


# Mirror reflection and direct transmission by angle, and diffuse parts, of both sides
_SHEET = (
    "void BRTDfunc x 10 if(Rdot,.1,.3)+.5*(1-abs(Rdot))^5 .1 .1 .6*abs(Rdot) .5 .5"
    " 0 0 0 . 0 9 .05 .05 .05 .2 .2 .2 .1 .1 .1\n"
)


@pytest.mark.parametrize(("front", "share"), [(True, 0.15), (False, 0.5)])
def test_a_sheet_of_functions_reflects_and_passes_what_they_say(
    tmp_path, device, front, share
):
    """∫ 2 cos (r + (1-cos)⁵/2) = r + 1/42 and ∫ 2 cos · .6 cos = .4; diffuse parts."""
    corners = ((-FAR, -FAR, 1), (FAR, -FAR, 1), (FAR, FAR, 1), (-FAR, FAR, 1))
    words = " ".join(
        str(x) for corner in corners[:: 1 if front else -1] for x in corner
    )
    (tmp_path / "sheet.rad").write_text(f"{_SHEET}x polygon p 0 0 12 {words}\n")
    sheet = cl.read_rad(tmp_path / "sheet.rad")
    named, source = sky()
    scene = Scene({**sheet.materials, **named}, sheet.surfaces, (source,))

    # Below, a sensor that looks up through the sheet; above, one that looks down on it
    up, down = sensor((0, 0, 1 - 1e-3), (0, 0, 1)), sensor((0, 0, 1 + 1e-3), (0, 0, -1))
    for where, truth in ((up, 0.4 + 0.1), (down, share + 1 / 42)):
        found = irradiance(scene, where, samples=1 << 14, seed=2, device=device)
        difference = abs(found.irradiance[0, 0] - np.pi * truth)
        assert difference < 4 * found.error[0, 0] + 1e-5
        assert found.error[0, 0] < 0.01 * np.pi * truth
