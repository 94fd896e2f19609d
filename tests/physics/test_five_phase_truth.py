"""The references of `benchmarks/five_phase_truth.py`: closed form, and both methods."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

import clerestory as cl
from clerestory.bands import RGB
from clerestory.engine import device as devices
from clerestory.errors import DeviceError
from clerestory.image.camera import Camera
from clerestory.scene.model import Dielectric, Polygon, Scene
from clerestory.scene.view import View, solid_angles

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
from truth import methods, reference
from truth.facades import Kind, Part, field_kinds, kinds
from truth.setting import WIDTH, cameras, demo, weather
from truth.slats import PixelPaths

INDEX = 1.49


@pytest.fixture(scope="module", autouse=True)
def cpu():
    """Load the compute device; tests skip without one."""
    try:
        devices.load("cpu")
    except DeviceError as error:
        pytest.skip(str(error))


def sheet(height):
    """Return the two faces of a clear sheet, as wide as the window."""
    faces = []
    for depth, turn in ((0.0, 1), (-0.002, -1)):
        corners = [(0, 0), (WIDTH, 0), (WIDTH, height), (0, height)][::turn]
        vertices = np.array([(x, y, depth) for x, y in corners])
        faces.append(Polygon(vertices, "film", "face"))
    return Scene({"film": Dielectric("film", np.ones(3), INDEX)}, tuple(faces))


def transmittance(cosine):
    """Transmittance of a clear sheet with all interreflections, by Fresnel."""
    inner = np.sqrt(1 - (1 - cosine**2) / INDEX**2)
    across = (cosine - INDEX * inner) / (cosine + INDEX * inner)
    along = (INDEX * cosine - inner) / (INDEX * cosine + inner)
    once = (across**2 + along**2) / 2
    return (1 - once) / (1 + once)


def test_an_eye_sees_the_sun_through_a_clear_sheet():
    """The irradiance of its image across the beam is τ times that outdoors."""
    hours = weather(["12-21T13:30"])
    time = hours.times[0].item()
    part = Part("sheet", kinds()["film"].parts[0].cell, sheet, clear=True)
    film = reference.truth(Kind("sheet", (part,)))
    eye = View("angular", (3.05, 1.2, 1.0), (0, -1, 0), horizontal=180, vertical=180)
    camera = Camera(eye, 100, 100)
    beams = film.when(hours, time).beams
    images = importlib.import_module("truth.sun_rays").sun_images(beams, camera, 4)
    found = images.mean(axis=0) @ solid_angles(eye, 100, 100).ravel()
    light = cl.sky_at(hours, time)
    [sun] = [source for source in light.distant if source.angle_deg < 1]
    solid_angle = 2 * np.pi * (1 - np.cos(np.radians(sun.angle_deg / 2)))
    outdoors = light.materials[sun.material].radiance.mean() * solid_angle
    expected = outdoors * transmittance(-sun.direction[1])
    assert abs(found / expected - 1) < 0.005
    place = np.unravel_index(images.mean(axis=0).argmax(), (100, 100))
    straight = eye.pixel(sun.direction, columns=100, rows=100)
    assert straight == pytest.approx(np.array(place) + 0.5, abs=1)


def test_a_sensor_receives_the_sun_through_a_clear_sheet():
    """Illuminance straight from the window is τ times that outdoors, by the cosine."""
    hours = weather(["12-21T13:30"])
    time = hours.times[0].item()
    part = Part("sheet", kinds()["film"].parts[0].cell, sheet, clear=True)
    film = reference.truth(Kind("sheet", (part,)))
    light = cl.sky_at(hours, time)
    [sun] = [source for source in light.distant if source.angle_deg < 1]
    solid_angle = 2 * np.pi * (1 - np.cos(np.radians(sun.angle_deg / 2)))
    # The second is above the sunlit part
    places = np.array([(3.05, 1.2, 1.0), (3.05, 1.2, 2.5)])
    sensors = cl.Sensors(places, np.tile([0.0, -1.0, 0.0], (2, 1)))
    lux, error = film.direct_sun(hours, time, sensors)
    cosine = -sun.direction[1]
    outdoors = light.materials[sun.material].radiance @ RGB.weights * solid_angle
    assert abs(lux[0] / (outdoors * cosine * transmittance(cosine)) - 1) < 0.005
    assert error[0] < 0.005 * lux[0]
    assert lux[1] == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["louvre", "double", "DL-L2"])
def test_methods_and_path_tracing_agree_at_small_size(name, monkeypatch):
    """Illuminance within a quarter, DGP within 0.05, as in the tables of the docs."""
    kind = (kinds() | field_kinds())[name]
    hours = weather(["03-21T11:30"])
    monkeypatch.setattr(methods, "tree_effort", lambda part: methods.TreeEffort(5, 100))
    of = kind, hours, demo()[2]
    true = reference.illuminances(*of, samples=4096)
    paths = methods.MethodPaths(row=4096, pixel=32, direct=16)
    found = methods.illuminances(*of, paths=paths)
    ratio = found["lux_five"].sum() / true["lux"].sum()
    assert abs(ratio - 1) < 0.25
    assert np.median(true["lux_error"] / true["lux"]) < 0.1
    eye = cameras()[:1]
    glare = reference.glares(kind, hours, eye, paths=PixelPaths(8, 1024))
    five = methods.glares(kind, hours, eye, paths=paths)["glare_five"]
    assert glare["glare_error"][0].max() < 0.02
    assert abs(five[0] - glare["glare"][0]).max() < 0.05
