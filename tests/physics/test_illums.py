"""Rooms lit by precomputed window emitters equal those lit through the windows."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.phases.rendering import irradiance, render
from clerestory.phases.window_emitters import precompute_illums
from clerestory.radiance.illum_table import write_illums
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.model import (
    DistantSource,
    Glass,
    Glow,
    Illum,
    Light,
    Metal,
    Plastic,
    Polygon,
    Scene,
    Sphere,
    Trans,
)
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View

UP, NORTH = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])


def polygon(material, *corners):
    return Polygon(np.array(corners, dtype=float), material, material)


# A room of 3 × 4 × 3 m that is open to the south, and the pane that closes it
BOX = (
    polygon("wall", (0, 0, 0), (3, 0, 0), (3, 4, 0), (0, 4, 0)),
    polygon("wall", (0, 0, 3), (0, 4, 3), (3, 4, 3), (3, 0, 3)),
    polygon("wall", (0, 4, 0), (3, 4, 0), (3, 4, 3), (0, 4, 3)),
    polygon("wall", (0, 0, 0), (0, 4, 0), (0, 4, 3), (0, 0, 3)),
    polygon("wall", (3, 0, 0), (3, 0, 3), (3, 4, 3), (3, 4, 0)),
)
PANE = polygon("pane", (0, 0, 0), (0, 0, 3), (3, 0, 3), (3, 0, 0))
SENSORS = Sensors(
    np.array([[1.5, 1, 0.8], [1, 3, 0.8], [1.5, 2, 1.5], [2.5, 3.5, 2.0]]),
    np.array([[0, 0, 1], [0, 0, 1], [0, -1, 0], [-1, 0, 0.0]]),
)


def room(*, sun=False):
    """The box under a sky brighter above, with or without a sun."""
    materials = {
        "wall": Plastic("wall", np.array([0.6, 0.5, 0.4])),
        "sky": Glow("sky", np.array([2.0, 3.0, 4.0]), 0.0),
        "ground": Glow("ground", np.full(3, 0.5), 0.0),
        "sun": Light("sun", np.full(3, 4e5)),
    }
    towards = np.array([0.4, -0.7, 0.6])
    distant = [
        DistantSource(UP, 180.0, "sky"),
        DistantSource(-UP, 180.0, "ground"),
        DistantSource(towards / np.linalg.norm(towards), 0.533, "sun"),
    ]
    return Scene(materials, BOX, tuple(distant[: 3 if sun else 2]))


def pane(kind):
    match kind:
        case "glass":
            material = Glass("pane", np.full(3, 0.88))
        case "cloth":
            material = Trans("pane", np.full(3, 0.9), 0.02, 0.1, 0.7, 0.4)
    return Scene({"pane": material}, (PANE,))


@pytest.mark.slow
@pytest.mark.parametrize("sun", [False, True], ids=["sky", "sun"])
@pytest.mark.parametrize("kind", ["glass", "cloth"])
def test_sensors_read_what_they_read_behind_the_window(device, kind, sun):
    """Within 2 %, which is for the tables' steps, and the joint noise.

    The cloth's highlight about the sun is 6° wide: steps of 5° would blur it by 4 %.
    Bounces are not limited: light of a lamp takes one more than that of a sky, since
    lamps are aimed at from the last surface as well.
    """
    here, window = room(sun=sun), pane(kind)
    lamps = precompute_illums(
        here, window, zone=1.6, rings=36 if sun else 18, samples=64, device=device
    )
    assert len(lamps.surfaces) == 4
    found, truth = (
        irradiance(here + panes, SENSORS, samples=1 << 17, device=device)
        for panes in (lamps, window)
    )
    error = np.hypot(found.error, truth.error)
    assert np.all(error < 0.02 * truth.irradiance)
    difference = np.abs(found.irradiance - truth.irradiance)
    assert np.all(difference < 4 * error + 0.02 * truth.irradiance)


def test_an_even_window_becomes_an_even_lamp(device):
    """A diffusing film before a uniform sky: radiance τL in all directions."""
    film = Trans("pane", np.ones(3), 0.0, 0.0, 1.0, 0.0)
    sky = Glow("sky", np.full(3, 2.0), 0.0)
    around = (DistantSource(NORTH, 180.0, "sky"), DistantSource(-NORTH, 180.0, "sky"))
    lamps = precompute_illums(
        Scene({"sky": sky}, (), around),
        Scene({"pane": film}, (PANE,)),
        samples=512,
        device=device,
    )
    [lamp] = [m for m in lamps.materials.values() if isinstance(m, Illum)]
    rng = np.random.default_rng(1)
    along = rng.normal(size=(500, 3))
    along[:, 1] = np.abs(along[:, 1]) + 1e-3
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    value = lamp.pattern.value(along, np.tile(NORTH, (500, 1)), np.zeros((500, 3)))
    assert value.mean() == pytest.approx(2.0, rel=0.01)
    assert value.std() < 0.1


def test_the_eye_sees_the_window_and_direct_sun(device):
    """A view through the lamp shows the sky as through the pane."""
    here, window = room(sun=True), pane("glass")
    lamps = precompute_illums(here, window, samples=32, bounces=1, device=device)
    view = View("perspective", np.array([1.5, 3, 1.5]), -NORTH, UP, 20, 20)
    shown = [
        render(here + p, view, columns=4, rows=4, samples=256, bounces=0, device=device)
        for p in (lamps, window)
    ]
    assert shown[0].picture.radiance == pytest.approx(
        shown[1].picture.radiance, rel=0.05, abs=0.02
    )


@pytest.mark.parametrize("kind", ["glass", "cloth"])
def test_files_hold_what_was_found(device, tmp_path, kind):
    here, window = room(), pane(kind)
    lamps = precompute_illums(
        here, window, zone=2.0, samples=16, bounces=1, device=device
    )
    files = write_illums(lamps, tmp_path / "lamps.rad")
    assert len(files) == 1 + 3 * len(lamps.surfaces)
    (tmp_path / "glass.rad").write_text("void glass pane 0 0 3 .88 .88 .88\n")
    again = read_rad(tmp_path / "glass.rad", tmp_path / "lamps.rad")
    along = np.array([[0.1, 0.9, -0.3], [0.6, 0.5, 0.2], [0.0, 1.0, 0.0]])
    for surface, other in zip(lamps.surfaces, again.surfaces, strict=True):
        one, two = lamps.materials[surface.material], again.materials[other.material]
        np.testing.assert_allclose(other.vertices, surface.vertices, atol=1e-7)
        np.testing.assert_allclose(
            two.pattern.value(along, along, along),
            one.pattern.value(along, along, along),
            rtol=1e-5,
        )


def test_what_cannot_be_a_lamp_is_refused(device):
    with pytest.raises(InputError, match="no panes given"):
        precompute_illums(room(), Scene(), device=device)
    with pytest.raises(InputError, match="edge length of zones is 0 m"):
        precompute_illums(room(), pane("glass"), zone=0.0, device=device)
    with pytest.raises(InputError, match="number of rings is 1"):
        precompute_illums(room(), pane("glass"), rings=1, device=device)
    with pytest.raises(InputError, match="is not a window emitter"):
        write_illums(pane("glass"), "never.rad")


def test_light_that_is_found_by_chance_is_named():
    """A polished ball before the window sends light of a lamp that few paths find."""
    ball = Sphere(np.array([1.5, -3, 1]), 0.5, False, "ball")
    lamp = Sphere(np.array([1.5, -4, 3]), 0.1, False, "sun")
    polished = Metal("ball", np.full(3, 0.9), specularity=1.0)
    garden = room() + Scene({"ball": polished}, (ball,))
    garden = replace(garden, surfaces=(*garden.surfaces, lamp))
    with pytest.warns(ClerestoryWarning, match="1 curved smooth .* by chance"):
        precompute_illums(garden, pane("glass"), rings=2, samples=1, device="cpu")
