"""Measured spectra of sky and sun: against models of the same spectra, and formulas."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import clerestory as cl
from clerestory.errors import InputError
from clerestory.sky.daylight_spectra import DaylightSpectra
from clerestory.sky.measured_spectra import MeasuredSpectra, read_measured_spectra
from clerestory.sky.sky_conditions import sky_conditions
from clerestory.spectral.band_sets import band_set
from clerestory.spectral.colour_temperature import (
    colour_temperature,
    daylight_spectrum,
    tristimulus,
)
from clerestory.spectral.functions import WAVELENGTH_NM, spectral_function

HOURS = np.arange("2023-06-20T07", "2023-06-20T18", 1, dtype="datetime64[h]")
BANDS = band_set("81")


@pytest.fixture
def weather():
    """A clear day in summer."""
    sine = np.sin(np.linspace(0.3, np.pi - 0.3, len(HOURS)))
    return cl.Weather(
        "", 36.1, -80.0, 270.0, -5.0, HOURS.astype("datetime64[s]"), 60.0,
        850 * sine**0.5, 110 * sine,
    )  # fmt: skip


def measured(spectra):
    return MeasuredSpectra(HOURS, WAVELENGTH_NM, np.asarray(spectra))


def test_measured_d65_is_the_model_d65(weather):
    d65 = measured(np.tile(7.0 * spectral_function("d65"), (len(HOURS), 1)))
    model = DaylightSpectra(measured_sky=d65, measured_sun=d65)
    found = cl.sky_matrix(weather, subdivision=1, bands=BANDS, daylight=model)
    known = cl.sky_matrix(
        weather,
        subdivision=1,
        bands=BANDS,
        daylight=DaylightSpectra(sky="d65", sun="d65"),
    )
    assert_allclose(found.values, known.values, rtol=2e-3, atol=1e-3)
    assert found.attributes["sky_colour_model"] == "measured"


def test_every_step_has_its_spectrum(weather):
    """A sky from 6000 K to 16,000 K, a sun from 3000 K; the ground mixes both."""
    sky_kelvin = np.linspace(6000, 16_000, len(HOURS))
    nm = WAVELENGTH_NM * 1e-9
    planck = [nm**-5 / np.expm1(0.014388 / (nm * t)) for t in sky_kelvin / 2]
    model = DaylightSpectra(
        measured_sky=measured([daylight_spectrum(t) for t in sky_kelvin]),
        measured_sun=measured(planck),
    )
    made = cl.sky_matrix(
        weather, subdivision=1, bands=BANDS, daylight=model, include="sky"
    )
    white = cl.sky_matrix(weather, subdivision=1, bands=BANDS, include="sky")
    assert_allclose(made.luminance().values, white.luminance().values, rtol=1e-4)
    for patch in (1, 60, 145):
        seen = colour_temperature(tristimulus(made.values[:, patch], BANDS)).kelvin
        assert_allclose(seen, sky_kelvin, rtol=5e-3)
    conditions = sky_conditions(weather)
    direct = conditions.direct_horizontal()
    share = direct / (direct + conditions.diffuse_horizontal)
    suns = cl.sky_matrix(
        weather, subdivision=1, bands=BANDS, daylight=model, include="sun"
    )
    sun = suns.values.sum(axis=1)
    sun /= BANDS.weights @ sun
    sky = made.values[:, 1] / (BANDS.weights @ made.values[:, 1])
    ground = made.values[:, 0] / (BANDS.weights @ made.values[:, 0])
    mixed = share * sun + (1 - share) * sky
    assert_allclose(ground, mixed, rtol=0.01, atol=0.01 * mixed.max())


def test_spectra_are_interpolated_in_time_and_wavelength():
    """Half way between red and blue of equal power, both have equal shares."""
    two = MeasuredSpectra(
        np.array(["2026-06-20T12:00", "2026-06-20T13:00"], dtype="datetime64[s]"),
        np.array([400.0, 700.0]),
        np.array([[4.0, 0.0], [0.0, 1.0]]),
    )
    times = np.array(["2026-06-20T12:30", "2026-06-20T12:00"], dtype="datetime64[s]")
    half, first = two.at(times, np.ones(2, bool))
    assert_allclose(half, 0.5)
    assert first[WAVELENGTH_NM == 550].item() == pytest.approx(0.5)


def test_steps_with_light_need_a_spectrum():
    one = MeasuredSpectra(HOURS[:1], np.array([400.0, 700.0]), np.ones((1, 2)))
    far = HOURS[:1].astype("datetime64[s]") + 3601
    assert one.at(far, np.zeros(1, bool)).shape == (1, len(WAVELENGTH_NM))
    with pytest.raises(InputError, match="no measured spectrum within an hour"):
        one.at(far, np.ones(1, bool))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no spectra"),
        ("time,400,700\n", "no spectra"),
        ("hour,400,700\n", "1: the line begins"),
        ("time,blue\n", "1: the values are"),
        ("time,700,400\n2026-06-20T12:00,1,1\n", "increasing"),
        ("time,400,700\n2026-06-20T12:00,1\n", "2: the line has 1 values"),
        ("time,400,700\nnoon,1,1\n", "2: the time is"),
        ("time,400,700\n2026-06-20T12:00,1,-1\n", "0 or more"),
        ("time,400,700\n2026-06-20T12:00,0,0\n", "zero"),
        ("time,400,700\n" + 2 * "2026-06-20T12:00,1,1\n", "increasing times"),
    ],
)
def test_wrong_files_are_errors(tmp_path, text, words):
    file = tmp_path / "sky.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        read_measured_spectra(file)
    assert "sky.csv" in str(caught.value)
