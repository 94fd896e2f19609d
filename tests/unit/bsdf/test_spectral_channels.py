"""BSDFs with spectral channels: in other bands, in files, and with a tint."""

import numpy as np
import pytest

from clerestory.bands import RGB
from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.spectral_channels import (
    band_groups_of,
    bsdf_in_bands,
    is_spectral,
    spectral_limits,
    spectral_nodes,
    with_spectral_transmittance,
)
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.hemisphere.klems import klems
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import band_means, band_set, wavelength_bands

QUARTER = klems("quarter")
GREY = lambertian(0.5, QUARTER, reflectance=0.25)


def spectral(**shares):
    """Lambertian BSDF with the transmittances of channels, and a visible channel."""
    functions = dict(GREY.functions)
    for channel, share in shares.items():
        part = lambertian(share, QUARTER)
        functions |= {(channel, name): part.function(name) for name in FUNCTIONS}
    return Bsdf(functions)


def shares(bsdf, bands):
    return [bsdf.diffuse("transmission_front", channel=name) for name in bands.names]


POINTS = {"400 nm": 0.2, "500 nm": 0.6, "600 nm": 0.4}


@pytest.mark.parametrize("name", ["20", "81", "melanopic+photopic"])
def test_channels_at_wavelengths_are_interpolated(name):
    bands = band_set(name)
    course = Spectrum(np.array([400.0, 500.0, 600.0]), np.array([0.2, 0.6, 0.4]))
    found = bsdf_in_bands(spectral(**POINTS), bands)
    np.testing.assert_allclose(shares(found, bands), band_means(course, bands))


def test_intervals_in_wider_intervals_are_averaged():
    """Two intervals of 20 nm and 80 nm in one of 100 nm."""
    narrow = spectral(**{"400-420 nm": 0.1, "420-500 nm": 0.6})
    wide = wavelength_bands([400, 500])
    found = shares(bsdf_in_bands(narrow, wide), wide)
    assert found == pytest.approx([0.2 * 0.1 + 0.8 * 0.6], abs=1e-8)


def test_own_bands_and_grey_layers_are_unchanged():
    two = band_set("melanopic+photopic")
    known = spectral(melanopic=0.3, photopic=0.5)
    assert bsdf_in_bands(known, two) is known
    assert bsdf_in_bands(GREY, two) is GREY
    assert is_spectral(known)
    assert not is_spectral(GREY)
    matrix = bsdf_in_bands(spectral(**POINTS), RGB).transmission_matrix()
    assert len(matrix.values) == 1


def test_groups_of_bands_are_red_green_and_blue():
    """The seven bands, three at a time, through the tristimulus values of RGB."""
    bands = band_set("7")
    known = spectral(**dict(zip(bands.names, np.linspace(0.1, 0.7, 7), strict=True)))
    groups = band_groups_of(known, bands)
    expected = ([0.1, 0.2, 0.3], [0.4, 0.5, 0.6], [0.7, 0.7, 0.7])
    for group, colours in zip(groups, expected, strict=True):
        rgb = group.transmission_matrix().values
        measure = QUARTER.projected_solid_angles()
        found = np.tensordot(rgb, measure, axes=(1, 0))[:, 0]
        np.testing.assert_allclose(found / measure[0], colours, rtol=1e-6)


def test_trees_are_combined_cell_by_cell():
    def tree(value):
        slots = np.array([value], dtype=np.float32).view(np.int32)
        return ScatteringTree(slots, 3, 0)

    parts = {"400 nm": tree(0.1), "600 nm": tree(0.3)}
    both = Bsdf({(c, "transmission_front"): part for c, part in parts.items()})
    green = bsdf_in_bands(both, wavelength_bands([450, 550]))
    found = green.functions["450-550 nm", "transmission_front"].slots
    assert found.view(np.float32)[0] == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("channels", "words"),
    [
        ({"400 nm": 0.1, "450-500 nm": 0.1}, "wavelengths, or intervals"),
        ({"400-480 nm": 0.1, "450-500 nm": 0.1}, "do not overlap"),
    ],
)
def test_mixed_or_overlapping_channels_are_refused(channels, words):
    with pytest.raises(InputError, match=words):
        spectral_nodes(spectral(**channels))


def test_files_keep_wavelengths_and_bands(tmp_path):
    bands = band_set("melanopic+photopic")
    known = bsdf_in_bands(spectral(**POINTS), bands)
    write_bsdf(tmp_path / "layer.xml", known)
    text = (tmp_path / "layer.xml").read_text()
    assert '<Wavelength unit="Nanometer">500</Wavelength>' in text
    again = read_bsdf(tmp_path / "layer.xml")
    assert again.channels == known.channels
    assert spectral_limits(again) == spectral_limits(known)
    for channel in known.channels:
        assert again.diffuse("transmission_front", channel=channel) == known.diffuse(
            "transmission_front", channel=channel
        )


def test_wavelengths_in_micrometres_are_read(tmp_path):
    write_bsdf(tmp_path / "layer.xml", spectral(**POINTS))
    text = (tmp_path / "layer.xml").read_text()
    changed = text.replace('"Nanometer">500<', '"Micrometer">0.5<')
    (tmp_path / "layer.xml").write_text(changed)
    assert set(POINTS) <= set(read_bsdf(tmp_path / "layer.xml").channels)
    wrong = text.replace('"Nanometer">500<', '"Nanometer">green<')
    (tmp_path / "layer.xml").write_text(wrong)
    with pytest.raises(InputError, match="wavelength is 'green'; a number above 0"):
        read_bsdf(tmp_path / "layer.xml")


def test_a_tint_multiplies_transmission_and_keeps_the_photopic_value():
    blue = Spectrum(np.array([400.0, 700.0]), np.array([0.9, 0.3]))
    bands = band_set("melanopic+photopic")
    tinted = with_spectral_transmittance(GREY, blue, bands)
    melanopic, photopic = band_means(blue, bands)
    found = shares(tinted, bands)
    np.testing.assert_allclose(found, [0.5 * melanopic / photopic, 0.5])
    back = tinted.diffuse("reflection_front", channel="melanopic")
    assert back == pytest.approx(0.25)


def test_a_tint_that_makes_light_is_warned_of():
    """More than one and less than five times 0.5, and reflectance 0.25."""
    blue = Spectrum(np.array([480.0, 500.0]), np.array([1.0, 0.2]))
    with pytest.warns(ClerestoryWarning, match="scatters 2.* times"):
        with_spectral_transmittance(GREY, blue, band_set("20"))


def test_a_tint_of_a_spectral_layer_is_refused():
    flat = Spectrum(np.array([400.0, 700.0]), np.array([0.5, 0.5]))
    with pytest.raises(InputError, match="has spectral channels"):
        with_spectral_transmittance(spectral(**POINTS), flat, band_set("20"))
