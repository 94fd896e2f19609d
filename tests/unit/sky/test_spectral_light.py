"""Spectra of sky and sun against formulas, a reference spectrum and brute force."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

import clerestory as cl
from clerestory.bands import RGB
from clerestory.errors import InputError
from clerestory.matrix.axis import sensor_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.column_light import SunLight
from clerestory.sky.daylight_spectra import (
    DaylightSpectra,
    sky_colour_temperature,
    sun_spectra,
)
from clerestory.sky.sky_conditions import sky_conditions
from clerestory.sky.solar_position import SunPosition
from clerestory.sky.sun_matrix import sun_matrix
from clerestory.spectral.alpha_opic import equivalent_daylight_illuminance
from clerestory.spectral.band_sets import band_set
from clerestory.spectral.colour_temperature import (
    colour_temperature,
    daylight_spectrum,
    tristimulus,
)
from clerestory.spectral.functions import (
    WAVELENGTH_NM,
    integral,
    spectral_function,
)

SPECTRA = DaylightSpectra()
FINE = band_set("81")


@pytest.fixture
def weather():
    """A clear and an overcast day in summer, in steps of two hours."""
    hours = np.arange("2023-06-20T05", "2023-06-20T20", 2, dtype="datetime64[h]")
    times = np.concatenate([hours, hours + 24]).astype("datetime64[s]")
    sine = np.sin(np.linspace(0.2, np.pi - 0.2, 8))
    direct = np.concatenate([850 * sine**0.5, np.zeros(8)])
    diffuse = np.concatenate([110 * sine, 250 * sine])
    return cl.Weather("", 36.1, -80.0, 270.0, -5.0, times, 120.0, direct, diffuse)


@pytest.mark.parametrize(
    ("model", "luminance", "kelvin"),
    [
        ("diakite", 5000, 1e6 / (-180.956 + 78.648 * np.log10(5000))),
        ("chain", 5000, 1e6 / (-132.1 + 59.77 * np.log10(5000))),
        ("takagi", 5000, 6500 + 1.1985e8 / 5000**1.2),
        ("diakite", 1, 25_000),
        ("diakite", 1e9, 4000),
        ("d65", 5000, 6504),
    ],
)
def test_colour_temperature_of_the_clear_sky(model, luminance, kelvin):
    """The formulas of the authors, within the range of daylight of CIE 15."""
    given = np.array([[float(luminance)]])
    found = sky_colour_temperature(given, np.array([4.0]), model)
    limited = min(max(kelvin, 4000), 25_000)
    assert found.item() == pytest.approx(limited, rel=1e-6)


@pytest.mark.parametrize(("model", "kelvin"), [("diakite", 6191), ("chain", 6514)])
def test_overcast_skies_have_one_colour(model, kelvin):
    given = np.array([[2000.0], [9000.0]])
    assert_allclose(sky_colour_temperature(given, np.array([1.0]), model), kelvin)


def test_sunlight_at_air_mass_1_5_is_the_reference_spectrum():
    """ASTM G173 direct, under its atmosphere, 400 to 680 nm.

    The extraterrestrial spectra of both differ, by up to 7 % around 430 nm.
    """
    reference = pytest.importorskip("pvlib.spectrum").get_reference_spectra()
    times = np.array(["2023-04-03T12:00"], dtype="datetime64[s]")
    place = cl.Weather("", 0.0, 0.0, 0.0, 0.0, times, 1.0, *np.array([[900.0], [90.0]]))
    sun = SunPosition(np.radians([90 - 48.19]), np.zeros(1))
    dew_point = np.array([(np.log(1.416) + 0.075) / 0.07])  # of 1.416 cm of water
    conditions = replace(sky_conditions(place), sun=sun, dew_point_c=dew_point)
    model = DaylightSpectra(aerosol_optical_depth=0.084, ozone_cm=0.3438)
    found = sun_spectra(place, conditions, model)[0]
    known = np.interp(WAVELENGTH_NM, reference.index, reference["direct"])
    known /= 683 * integral(known * spectral_function("y"))
    smooth = np.ones(21) / 21
    ratio = np.convolve(found, smooth, "valid") / np.convolve(known, smooth, "valid")
    ratio = ratio[10:291]  # means about 400 to 680 nm
    assert np.abs(ratio - 1).mean() < 0.02
    assert np.abs(ratio - 1).max() < 0.075
    for name in ("melanopic", "s_cone", "l_cone"):
        powers = [integral(one * spectral_function(name)) for one in (found, known)]
        assert powers[0] == pytest.approx(powers[1], rel=0.02)


def test_spectra_do_not_change_the_luminance(weather):
    """Of any patch at any time, in fine and coarse bands."""
    for name in ("81", "9", "melanopic+photopic"):
        bands = band_set(name)
        coloured = cl.sky_matrix(weather, subdivision=1, bands=bands, daylight=SPECTRA)
        white = cl.sky_matrix(weather, subdivision=1, bands=bands)
        assert coloured.values.min() >= 0
        found = np.tensordot(bands.weights, coloured.values, axes=1)
        expected = np.tensordot(bands.weights, white.values, axes=1)
        assert_allclose(found, expected, rtol=2e-5, atol=1e-2)
        assert_allclose(coloured.luminance().values, white.luminance().values)


def test_an_open_sensor_sees_the_spectrum_of_every_patch(weather):
    """Melanopic light of the dome: brute force over patches, each by CIE 15."""
    sky = cl.sky_matrix(
        weather, subdivision=1, bands=FINE, daylight=SPECTRA, include="sky"
    )
    dome = sky.partition.dome.projected_solid_angles()
    received = np.einsum("bpt,p->bt", sky.values[:, 1:], dome)
    clearness = sky_conditions(weather).state.clearness
    luminance = sky.luminance().values[0, 1:].astype(float)
    kelvin = sky_colour_temperature(luminance, clearness)
    for step in (1, 3, 12):
        power = sum(
            daylight_spectrum(float(t)) * level * area
            for t, level, area in zip(
                kelvin[:, step], luminance[:, step], dome, strict=True
            )
        )
        expected = integral(power * spectral_function("melanopic")) / 1.3262132e-3
        found = equivalent_daylight_illuminance(received[:, step], FINE)
        assert found == pytest.approx(expected, rel=5e-4)


def test_the_sun_turns_red_towards_the_horizon(weather):
    """Its colour at each step is that of SPECTRL2, as a sum of a few colours."""
    suns = sun_matrix(weather, bands=FINE, daylight=SPECTRA)
    parts = [
        colour[0][:, None] * np.asarray(normal.sum(axis=0)).ravel()
        for normal, colour in suns.weighted(np.ones((1, 81)))
    ]
    light = np.sum(parts, axis=0)
    spectra = sun_spectra(weather, sky_conditions(weather), SPECTRA)
    lit = np.flatnonzero(suns.direct_normal.sum(axis=0))
    found = colour_temperature(tristimulus(light[:, lit], FINE)).kelvin
    xyz = np.stack([integral(spectra[lit] * spectral_function(c)) for c in "xyz"])
    assert_allclose(found, colour_temperature(xyz).kelvin, rtol=5e-3)
    assert found[0] < found[3] - 500


def test_products_are_those_of_the_dense_sky(weather):
    """Coloured coefficients: the sum over parts equals the sum over bands."""
    rng = np.random.default_rng(5)
    bands = band_set("20")
    sky = cl.sky_matrix(weather, subdivision=1, bands=bands, daylight=SPECTRA)
    values = rng.random((20, 3, len(sky.partition)))
    parts = rng.normal(size=(4, *values.shape)) * 0.01
    matrix = TransferMatrix(
        values, sensor_axis(3), sky.rows, components=parts, bands=bands
    )
    lux = (matrix @ sky).illuminance()
    light = bands.weights[:, None, None] * sky.values
    assert_allclose(
        lux["illuminance"], np.einsum("brp,bpt->rt", values, light), rtol=1e-4
    )
    error = np.einsum("kbrp,bpt->krt", parts, light)
    expected = np.sqrt(np.square(error).sum(axis=0))
    assert_allclose(lux["standard_error"], expected, rtol=1e-3, atol=1)
    rows = np.concatenate([np.moveaxis(b, -1, 0) for b in sky.row_blocks()], axis=1)
    assert_allclose(rows, sky.values, rtol=1e-5, atol=1e-3)
    half = sky.select(slice(3, 9))
    assert_allclose(half.values, sky.values[..., 3:9])
    mean = sky.values.mean(axis=2, keepdims=True)
    assert_allclose(sky.mean().values, mean, rtol=1e-4, atol=1e-4)


def test_direct_light_of_coloured_suns(weather):
    """C_ds times suns, in two outputs: brute force over bands."""
    rng = np.random.default_rng(6)
    bands = band_set("9")
    suns = sun_matrix(weather, bands=bands, daylight=SPECTRA)
    weights = rng.random((2, 9))
    matrix = rng.random((1, 9, 4, len(suns))).astype(np.float32)
    found = SunLight(suns, weights).received(matrix)[0]
    for step in range(len(weather)):
        power = np.zeros((9, len(suns)))
        for normal, colour in suns.weighted(np.ones((1, 9))):
            power += colour[0][:, None] * normal[:, [step]].toarray()[:, 0]
        expected = np.einsum("ob,brs,bs->or", weights, matrix[0], power)
        assert_allclose(found[..., step], expected, rtol=1e-4, atol=1e-3)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"daylight": SPECTRA, "bands": RGB}, "wavelengths"),
        ({"daylight": SPECTRA, "bands": FINE, "spectrum": "solar"}, "one of them"),
        (
            {"daylight": SPECTRA, "bands": FINE, "sky_colour": (1.0,) * 81},
            "one of them",
        ),
    ],
)
def test_impossible_spectra_are_errors(weather, change, words):
    with pytest.raises(InputError, match=words):
        cl.sky_matrix(weather, subdivision=1, **change)


@pytest.mark.parametrize(
    "change",
    [{"sky": "blue"}, {"sun": "red"}, {"aerosol_optical_depth": -1}, {"ozone_cm": 2}],
)
def test_impossible_models_are_errors(change):
    with pytest.raises(InputError, match="expected"):
        DaylightSpectra(**change)
