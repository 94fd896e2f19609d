"""Scenes in other bands than red, green and blue."""

import numpy as np
import pytest

from clerestory.bands import unnamed_bands
from clerestory.errors import InputError
from clerestory.radiance.rad_writer import format_rad
from clerestory.scene.band_conversion import in_bands, step_spectrum
from clerestory.scene.model import Glass, Light, Mixture, Plastic, Scene
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import wavelength_bands

NINE = wavelength_bands(range(380, 830, 45))
GREY = Plastic("grey", np.full(3, 0.5))
RED = Plastic("red", np.array([0.6, 0.2, 0.1]))


def test_greys_are_the_same_in_all_bands():
    lamp = Light("lamp", np.full(3, 7.0))
    scene = in_bands(Scene({"grey": GREY, "lamp": lamp}), NINE)
    assert scene.bands == NINE
    assert scene.materials["grey"].reflectance == pytest.approx(np.full(9, 0.5))
    assert scene.materials["lamp"].radiance == pytest.approx(np.full(9, 7.0))


def test_colours_are_not_guessed():
    """Also not those inside another material."""
    mixed = Mixture("mixed", GREY, RED, 0.5)
    for material in (RED, mixed):
        with pytest.raises(InputError, match="RGB does not determine its spectrum"):
            in_bands(Scene({material.name: material}), NINE)


def test_steps_are_taken_when_asked_for():
    """Blue below 480 nm, green to 588 nm, red above; means across the steps."""
    mixed = Mixture("mixed", GREY, RED, 0.5)
    scene = in_bands(Scene({"mixed": mixed}), NINE, upsampling=step_spectrum)
    spectrum = scene.materials["mixed"].background.reflectance
    assert spectrum[:2] == pytest.approx(np.full(2, 0.1))
    assert spectrum[2] == pytest.approx((10 * 0.1 + 35 * 0.2) / 45)
    assert spectrum[3] == pytest.approx(0.2)
    assert spectrum[4] == pytest.approx((28 * 0.2 + 17 * 0.6) / 45)
    assert spectrum[5:] == pytest.approx(np.full(4, 0.6))


def test_steps_need_wavelengths():
    with pytest.raises(InputError, match="wavelengths of the bands"):
        step_spectrum(RED.reflectance, unnamed_bands(5))


def test_a_scene_has_one_set_of_bands():
    """A coloured scene in other bands is not added; a grey one has any bands."""
    spectral = Scene({"leaf": Plastic("leaf", np.linspace(0, 1, 9))}, bands=NINE)
    coloured, grey = Scene({"red": RED}), Scene({"grey": GREY})
    for pair in ((spectral, coloured), (coloured, spectral)):
        with pytest.raises(InputError, match="one for each of the bands"):
            pair[0] + pair[1]
    assert (spectral + grey).bands == (grey + spectral).bands == NINE
    assert (Scene() + spectral).bands == NINE
    assert (spectral + Scene()).bands == NINE
    assert len((spectral + spectral).materials) == 1


def test_radiance_s_language_is_in_rgb():
    with pytest.raises(InputError, match="red, green, blue expected"):
        format_rad(Scene({"grey": GREY}, bands=NINE), bsdf_file={})


def test_colours_have_a_value_per_band():
    with pytest.raises(InputError, match='"red" has 3 values; one for each'):
        Scene({"red": RED}, bands=NINE)
    with pytest.raises(InputError, match="one for each of the bands"):
        Scene({"pane": Glass("pane", np.ones(9))})
    assert Scene({"grey": GREY}, bands=NINE).bands == NINE


def test_materials_have_the_spectra_that_are_given():
    """Reflectances are means in the bands; copies of a material have them too."""
    two = wavelength_bands([400, 500, 600])
    ramp = Spectrum(np.array([400.0, 600.0]), np.array([0.2, 0.6]))
    copy = Plastic("red#2", RED.reflectance)
    scene = Scene({"red": RED, "red#2": copy, "grey": GREY})
    found = in_bands(scene, two, spectra={"red": ramp}).materials
    for name in ("red", "red#2"):
        assert found[name].reflectance == pytest.approx([0.3, 0.5])
    assert found["grey"].reflectance == pytest.approx([0.5, 0.5])


def test_glass_has_the_transmittance_that_is_given():
    """Series of reflections at normal incidence: T = (1-F)² t / (1 - F² t²)."""
    two = wavelength_bands([400, 500, 600])
    flat = Spectrum(np.array([400.0, 600.0]), np.array([0.7, 0.7]))
    pane = Glass("pane", np.full(3, 0.96))
    found = in_bands(Scene({"pane": pane}), two, spectra={"pane": flat})
    t, mirrored = found.materials["pane"].transmissivity, (0.52 / 2.52) ** 2
    through = (1 - mirrored) ** 2 * t / (1 - (mirrored * t) ** 2)
    assert through == pytest.approx([0.7, 0.7])


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        ("blue", (0.5, 0.5), 'no material "blue"'),
        ("lamp", (0.5, 0.5), "no spectrum"),
        ("mixed", (0.5, 0.5), "no spectrum"),
        ("grey", (0.5, 1.5), "from 0 to 1"),
    ],
)
def test_impossible_spectra_of_materials_are_errors(name, values, words):
    spectrum = Spectrum(np.array([400.0, 600.0]), np.array(values))
    materials = {
        "grey": GREY,
        "lamp": Light("lamp", np.full(3, 7.0)),
        "mixed": Mixture("mixed", GREY, GREY, 0.5),
    }
    with pytest.raises(InputError, match=words):
        in_bands(Scene(materials), NINE, spectra={name: spectrum})
