"""Scenes in nine bands: closed forms, and three scenes in red, green and blue."""

from dataclasses import replace

import numpy as np
import pytest
from physics_scenes import box, endless_ground, sensor

import clerestory as cl
from clerestory.bands import RGB
from clerestory.bsdf.analytic import lambertian
from clerestory.bsdfgen.panes_and_fabrics import diffuse_pane
from clerestory.engine import work_units
from clerestory.engine.work_units import Local
from clerestory.errors import InputError, MatrixError
from clerestory.image.camera import Camera
from clerestory.phases.picture_matrices import picture_view_matrices
from clerestory.phases.rendering import irradiance, render
from clerestory.scene.model import DistantSource, Glow, Metal, Plastic, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.sky.patch_radiance import SkyMatrix
from clerestory.spectral.band_sets import wavelength_bands

NINE = wavelength_bands(range(380, 830, 45))
REFLECTANCE = np.array([0.5, 0.2, 0.8, 0.6, 0.7, 0.1, 0.9, 0.3, 0.4])
UP, NORTH, DOWN = (0, 0, 1), (0, 1, 0), (0, 0, -1)
GROUPS = (slice(0, 3), slice(3, 6), slice(6, 9))


def spectral(scene, reflectance=REFLECTANCE, bands=NINE):
    """The same surfaces with walls of another colour."""
    return Scene({"wall": Plastic("wall", reflectance)}, scene.surfaces, bands=bands)


def sky_of(partition, colour, bands):
    """One step: a sky brighter in the south, of one colour, over a grey ground."""
    level = 1.0 + 0.5 * np.cos(np.arange(len(partition)))
    flat = cl.sky_matrix(_noon(), subdivision=partition.subdivision)
    return SkyMatrix(
        partition,
        flat.times,
        level.astype(np.float32)[:, None],
        np.repeat(np.asarray(colour)[:, None], len(partition), axis=1),
        flat.sun * 0,
        np.ones(len(colour)),
        {},
        bands,
    )


def agree(found, components, expected, other_components):
    """Check that two estimates differ by their standard errors, of up to 20 %."""
    error, other = (
        np.sqrt(np.square(each).sum(axis=0)) for each in (components, other_components)
    )
    off, both = np.abs(found - expected), np.sqrt(error**2 + other**2)
    assert (off <= 4.5 * both + 1e-5 * expected).all()
    assert np.median(both) < 0.2 * np.median(expected)


def _noon():
    times = np.array(["2023-03-21T12:30"], dtype="datetime64[s]")
    number = np.array([300.0])
    return cl.Weather("", 50.0, 8.0, 100.0, 1.0, times, 60.0, number, number / 2)


def test_an_open_sensor_reads_pi_in_every_band(device):
    """Nothing reflects, so one channel serves all bands; lux is π Σ K_b L_b."""
    matrix = cl.daylight_coefficients(
        Scene(bands=NINE),
        sensors=sensor((0, 0, 1), UP),
        subdivision=1,
        samples=4096,
        device=device,
    )
    assert (len(matrix.values), matrix.bands) == (1, NINE)
    colour = np.linspace(0.5, 1.5, 9)
    sky = sky_of(matrix.columns.partition, colour, NINE)
    sky = replace(sky, diffuse=np.ones_like(sky.diffuse))
    lux = (matrix @ sky).illuminance()["illuminance"].item()
    assert lux == pytest.approx(np.pi * NINE.weights @ colour, rel=1e-5)


@pytest.mark.parametrize("count", [2, 4, 9])
def test_the_ground_reflects_every_band_by_itself(device, count):
    """A sensor that faces an endless ground: E = π ρ in each band."""
    bands = wavelength_bands(np.linspace(380, 780, count + 1))
    matrix = cl.daylight_coefficients(
        spectral(endless_ground(0.5), REFLECTANCE[:count], bands),
        sensors=sensor((0, 0, 1), DOWN),
        samples=1 << 14,
        device=device,
    )
    expected = np.pi * REFLECTANCE[:count]
    assert matrix.values.sum(axis=(1, 2)) == pytest.approx(expected, rel=1e-5)


def test_light_sources_have_nine_bands(device):
    """Sky and earth of radiance L in each band: E = π L."""
    radiance = np.linspace(1, 3, 9)
    up = np.array(UP, dtype=float)
    scene = Scene(
        {"sky": Glow("sky", radiance), "earth": Glow("earth", 2 * radiance)},
        distant=(DistantSource(up, 180.0, "sky"), DistantSource(-up, 180.0, "earth")),
        bands=NINE,
    )
    sensors = Sensors(np.zeros((2, 3)), np.array([UP, NORTH], dtype=float))
    found = irradiance(scene, sensors, samples=4096, device=device)
    expected = np.pi * np.array([[1.0], [1.5]]) * radiance
    assert np.abs(found.irradiance - expected).max() < 4 * found.error.max() + 1e-4
    assert found.error.max() < 0.05
    lux = found.illuminance()
    assert lux == pytest.approx(found.irradiance @ NINE.weights, rel=1e-6)


def test_nine_bands_are_three_scenes_in_rgb(device):
    """V T D S: the same numbers, band by band, and their errors."""
    scene, south = box(4, 5, 3, 0.5)
    sensors = Sensors(np.array([[2, 1, 1.0], [2, 4, 1]]), np.tile([0, 0, 1.0], (2, 1)))
    options = {"samples": 1024, "device": device, "seed": 4}
    ground = spectral(endless_ground(0.2))
    colour = np.linspace(0.6, 1.4, 9)
    pane = lambertian(0.5, south.partition).transmission_matrix()

    def product(reflectance, colour, bands):
        room = spectral(scene, reflectance, bands)
        site = spectral(ground, reflectance, bands)
        view = cl.view_matrix(room, south, sensors=sensors, **options)
        daylight = cl.daylight_matrix(site, south, subdivision=1, **options)
        through = view @ pane @ daylight
        return through @ sky_of(daylight.columns.partition, colour, bands)

    whole = product(REFLECTANCE, colour, NINE)
    dense = whole.rgb()
    parts = [product(REFLECTANCE[g], colour[g], RGB).rgb() for g in GROUPS]
    together = np.concatenate([part.values for part in parts])
    error = dense.components
    other = np.concatenate([part.components for part in parts], axis=1)
    agree(dense.values, error, together, other)

    # Illuminance and its error, from values and components of all bands
    found = whole.illuminance()
    lux = np.tensordot(NINE.weights, dense.values, axes=1)
    np.testing.assert_allclose(found["illuminance"], lux, rtol=1e-5)
    spread = np.tensordot(error, NINE.weights, axes=(1, 0))
    np.testing.assert_allclose(
        found["standard_error"], np.sqrt((spread**2).sum(axis=0)), rtol=1e-3
    )


def test_pictures_have_nine_bands(device):
    """A rendering and a view matrix, against three in RGB."""
    scene, south = box(4, 5, 3, 0.5)
    view = View(
        position=np.array([2.0, 0.3, 1.2]),
        direction=np.array([0.0, 1.0, 0.0]),
        horizontal=60.0,
        vertical=60.0,
    )
    camera = Camera(view, 8, 6)
    options = {"samples": 64, "device": device}
    sky = Glow("sky", np.ones(3))
    dome = (DistantSource(np.array(UP, dtype=float), 180.0, "sky"),)

    def traced(reflectance, bands):
        room = spectral(scene, reflectance, bands)
        matrix = picture_view_matrices(room, [south], camera, **options)["south"]
        materials = {**room.materials, "sky": sky}
        lit = Scene(materials, room.surfaces, dome, bands)
        return matrix, render(lit, view, columns=8, rows=6, **options).picture

    matrix, picture = traced(REFLECTANCE, NINE)
    assert (matrix.bands, picture.bands) == (NINE, NINE)
    for group in GROUPS:
        one, shown = traced(REFLECTANCE[group], RGB)
        off = matrix.values[group].sum(axis=-1) - one.values.sum(axis=-1)
        parts = matrix.components[:, group], one.components
        error = [np.square(each.sum(axis=-1)).sum(axis=0) for each in parts]
        assert np.mean(off**2) < 1.5**2 * np.mean(error[0] + error[1])
        assert np.mean(off**2) < 0.1**2 * np.mean(one.values.sum(axis=-1) ** 2)
        np.testing.assert_allclose(
            picture.radiance[..., group], shown.radiance, rtol=1e-5, atol=1e-7
        )
    expected = picture.radiance @ NINE.weights
    assert picture.luminance() == pytest.approx(expected, rel=1e-5)


MATERIALS = {
    "matt": lambda colour: Plastic("wall", colour),
    "coated": lambda colour: Plastic("wall", colour, 0.1),
    "glossy": lambda colour: Plastic("wall", colour, 0.2, 0.15),
    "metal": lambda colour: Metal("wall", colour, 0.6, 0.1),
}


@pytest.mark.parametrize("kind", MATERIALS)
def test_bands_share_paths(device, monkeypatch, kind):
    """Sensors in a room of one coloured material: as with three bands at a time."""
    scene, south = box(4, 5, 3, 0.5)
    four = wavelength_bands((380, 480, 580, 680, 780))
    wall = MATERIALS[kind](np.array([0.5, 0.0, 0.8, 0.6]))
    room = Scene({"wall": wall}, scene.surfaces, bands=four)
    sensors = Sensors(np.array([[2, 1, 1.0], [2, 4, 1]]), np.tile([0, 0, 1.0], (2, 1)))

    def traced():
        found = cl.view_matrix(
            room, south, sensors=sensors, samples=4096, device=device, executor=Local()
        )
        return found.values.sum(axis=-1), found.components.sum(axis=-1)

    shared = traced()
    monkeypatch.setattr(work_units, "bands_share_paths", lambda _: False)
    agree(*shared, *traced())


def test_generated_bsdfs_have_a_channel_for_each_band(device):
    """A matt sheet reflects each band by itself; luminance is their weighted mean."""
    sheet = diffuse_pane(transmittance=0.0, reflectance=0.5)
    scene = Scene(
        {"pane": Plastic("pane", REFLECTANCE)}, sheet.scene.surfaces, bands=NINE
    )
    bsdf = cl.generate_bsdf(
        scene, area=sheet.area, basis="quarter", samples=256, device=device
    )
    assert bsdf.channels == ("visible", *NINE.names)
    found = [bsdf.diffuse("reflection_front", channel=name) for name in NINE.names]
    assert found == pytest.approx(REFLECTANCE, rel=1e-5)
    luminous = bsdf.diffuse("reflection_front")
    assert luminous == pytest.approx(NINE.shares @ REFLECTANCE, rel=1e-5)
    with pytest.raises(InputError, match="red, green, blue expected"):
        cl.generate_bsdf(scene, area=sheet.area, colour=True, device=device)


def test_matrices_of_other_bands_do_not_fit(device):
    """A room in nine bands under a sky in three."""
    scene, south = box(4, 5, 3, 0.5)
    options = {"samples": 16, "device": device}
    view = cl.view_matrix(
        spectral(scene), south, sensors=sensor((2, 3, 1), UP), **options
    )
    daylight = cl.daylight_matrix(Scene(), south, subdivision=1, **options)
    product = view @ lambertian(0.5, south.partition).transmission_matrix() @ daylight
    assert product.bands == NINE
    with pytest.raises(MatrixError, match="red, green, blue"):
        product @ cl.sky_matrix(_noon(), subdivision=1)


def test_colours_of_other_bands_do_not_fit():
    """Before anything is traced."""
    scene, _ = box(4, 5, 3, (0.5, 0.4, 0.3))
    with pytest.raises(InputError, match="one for each of the bands"):
        Scene(scene.materials, scene.surfaces, bands=NINE)
