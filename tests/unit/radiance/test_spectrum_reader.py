"""Spectral modifiers of scene files: rules of combination, and errors."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.band_conversion import in_bands, step_spectrum
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import band_set, wavelength_bands

STEPS = "void spectrum s 0 0 6 400 700 .1 .4 .9 .3\n"
MIDDLES = wavelength_bands([340, 440, 460, 540, 560, 640])
SHEET = "m polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n"


@pytest.fixture
def scene(tmp_path):
    """Read a scene beside two function files and two data files."""
    (tmp_path / "f.cal").write_text("up(v) = v/1000;\nhigh(v) = v*Px;\n")
    (tmp_path / "two.dat").write_text("2\n0 1 2\n400 700 3\n.1 .2 .3 .4 .5 .6\n")
    (tmp_path / "uneven.dat").write_text("1\n0 0 3\n400 500 700\n.1 .2 .3\n")

    def read(text):
        (tmp_path / "main.rad").write_text(text + SHEET)
        return read_rad(tmp_path / "main.rad")

    return read


@pytest.mark.parametrize(
    ("material", "field", "factor"),
    [
        ("s plastic m 0 0 5 .5 .5 .5 .02 .1", "reflectance", 0.5),
        ("s metal m 0 0 5 .8 .8 .8 .5 .1", "reflectance", 0.8),
        ("s trans m 0 0 7 .6 .6 .6 0 0 .5 .5", "reflectance", 0.6),
        ("s glass m 0 0 3 .9 .9 .9", "transmissivity", 0.9),
        ("s mirror m 0 0 3 .7 .7 .7", "reflectance", 0.7),
        ("s light m 0 0 3 2 2 2", "radiance", 2.0),
    ],
)
def test_a_spectrum_multiplies_the_colour_in_each_band(scene, material, field, factor):
    """Each value holds up to the middle between two wavelengths."""
    found = in_bands(scene(f"{STEPS}{material}\n"), MIDDLES).materials["m"]
    values = getattr(found, field) / factor
    np.testing.assert_allclose(values, [0.1 * 0.9, 0.25, 0.4, 0.65, 0.9], atol=1e-6)
    assert found.tint is None


def test_a_brightness_and_a_spectrum_multiply(scene):
    text = f"{STEPS}s brightfunc dark 2 .5 . 0 0\ndark plastic m 0 0 5 1 1 1 0 0\n"
    values = in_bands(scene(text), MIDDLES).materials["m"].reflectance
    assert values[2] == pytest.approx(0.2)
    text = "void brightfunc dark 2 .5 . 0 0\n" + STEPS.replace("void", "dark")
    values = in_bands(scene(f"{text}s plastic m 0 0 5 1 1 1 0 0\n"), MIDDLES)
    assert values.materials["m"].reflectance[2] == pytest.approx(0.2)


def test_both_parts_of_a_mixture_have_the_spectrum(scene):
    parts = "void plastic a 0 0 5 .5 .5 .5 0 0\nvoid plastic b 0 0 5 .1 .1 .1 0 0\n"
    mixed = f"{parts}s mixfunc m 4 a b .5 . 0 0\n{STEPS}".replace(STEPS, "")
    found = in_bands(scene(STEPS + mixed), MIDDLES).materials["m"]
    assert found.foreground.reflectance[4] == pytest.approx(0.45)
    assert found.background.reflectance[4] == pytest.approx(0.09)


def test_a_spectrum_given_from_python_replaces_that_of_the_file(scene):
    text = f"{STEPS}s plastic m 0 0 5 1 1 1 0 0\n"
    half = {"m": Spectrum(np.array([400.0]), np.array([0.5]))}
    found = in_bands(scene(text), MIDDLES, spectra=half)
    assert found.materials["m"].reflectance == pytest.approx(np.full(5, 0.5))


def test_coloured_materials_still_require_an_upsampling(scene):
    room = scene(f"{STEPS}s plastic m 0 0 5 .5 .2 .2 0 0\n")
    with pytest.raises(InputError, match="RGB does not determine its spectrum"):
        in_bands(room, MIDDLES)
    found = in_bands(room, MIDDLES, upsampling=step_spectrum).materials["m"]
    assert found.reflectance[2] == pytest.approx(0.2 * 0.4)


def test_two_weightings_of_a_lamp_differ_from_those_of_a_paint(scene):
    """Light is weighted by the function alone, a reflectance also by D65."""
    lamp = scene(f"{STEPS}s light m 0 0 3 1 1 1\n")
    paint = scene(f"{STEPS}s plastic m 0 0 5 1 1 1 0 0\n")
    two = band_set("melanopic+photopic")
    emitted = in_bands(lamp, two).materials["m"].radiance
    reflected = in_bands(paint, two).materials["m"].reflectance
    fine = in_bands(lamp, band_set("81")).materials["m"].radiance
    assert fine @ band_set("81").weights == pytest.approx(179 * emitted[1], rel=2e-3)
    assert abs(emitted[0] - reflected[0]) > 1e-3


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("void spectrum s 0 0 4 400 700 1 1", "4 numbers; two wavelengths"),
        ("void spectrum s 0 0 5 400 400 1 1 1", "both wavelengths are 400 nm"),
        ("void spectrum s 0 0 5 400 700 1 -1 1", "value of the spectrum"),
        ("void spectrum s 0 0 5 -400 700 1 1 1", "wavelength"),
        ("void specfile s 1 gone.dat 0 0", "gone.dat"),
        ("void specfile s 1 two.dat 0 0", "2 axes"),
        ("void specfile s 1 uneven.dat 0 0", "different distances"),
        ("void specfunc s 2 up f.cal 0 1 400", "two wavelengths"),
        ("void specfunc s 2 high f.cal 0 2 400 700", "varies over the surface"),
        ("void specfunc s 2 none f.cal 0 2 400 700", "not defined"),
        ("void specdata s 3 up two.dat f.cal 0 0", "one coordinate per axis"),
        ("void specdata s 4 up two.dat f.cal Px 0 0", "varies over the surface"),
        (STEPS + "s dielectric m 0 0 5 1 1 1 1.5 0", "cannot have a spectrum"),
    ],
)
def test_wrong_spectra_are_errors_of_one_line(scene, text, words):
    with pytest.raises(InputError, match=words) as caught:
        scene(f"{text}\ns plastic m 0 0 5 1 1 1 0 0\n")
    assert len(str(caught.value).splitlines()) == 1
    assert "main.rad:" in str(caught.value) or "dat" in str(caught.value)
