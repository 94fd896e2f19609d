"""Scenes in other bands than red, green and blue."""

import numpy as np
import pytest

from clerestory.bands import unnamed_bands
from clerestory.errors import InputError
from clerestory.radiance.rad_writer import format_rad
from clerestory.scene.band_conversion import in_bands, step_spectrum
from clerestory.scene.model import Glass, Light, Mixture, Plastic, Scene
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
