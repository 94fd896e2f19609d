"""Measured reflectances against the descriptions of their records in the source.

The positions of absorptions and peaks are those that the sample descriptions of the
USGS Spectral Library 7 state.
"""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.spectral.material_library import material_samples, material_spectrum
from clerestory.spectral.spectrum_file import format_spectrum, read_spectrum


def test_every_sample_is_a_reflectance_over_the_visible_range():
    for name, sample in material_samples().items():
        spectrum = sample.reflectance
        assert spectrum.wavelength_nm.tolist() == list(range(380, 785, 5)), name
        assert 0 < spectrum.value.min() < spectrum.value.max() < 1, name
        assert "" not in (sample.words, sample.record), name


@pytest.mark.parametrize(
    ("name", "extreme", "low", "high", "stated"),
    [
        ("pigment-cobalt-blue", np.argmax, 400, 520, 440),
        ("pigment-cobalt-blue", np.argmin, 520, 660, 588),
        ("paint-light-grey", np.argmax, 500, 700, 579),
    ],
)
def test_peaks_and_absorptions_are_where_the_source_states(
    name, extreme, low, high, stated
):
    """Stated for spectra divided by their continuum, which shifts them a little."""
    wavelength = np.arange(low, high + 1.0)
    values = material_spectrum(name).at(wavelength)
    assert wavelength[extreme(values)] == pytest.approx(stated, abs=15)


def test_titanium_white_absorbs_below_its_edge():
    """From 60 % to nearly 3 %, centred at 410 nm (below 380 nm in this table)."""
    below, edge, above = material_spectrum("pigment-titanium-white").at(
        np.array([380.0, 410.0, 500.0])
    )
    assert below < 0.1
    assert edge == pytest.approx((below + above) / 2, abs=0.1)
    assert above == pytest.approx(0.60, abs=0.04)


def test_spectra_are_found_by_name_like_files(tmp_path):
    pine = read_spectrum("library:pine")
    assert pine is material_spectrum("pine")
    file = tmp_path / "pine.csv"
    file.write_text(format_spectrum(pine, "reflectance"))
    np.testing.assert_allclose(read_spectrum(file).value, pine.value, rtol=1e-6)


@pytest.mark.parametrize(
    ("name", "words"),
    [("library:pin", "such as pine"), ("library:?" + "x" * 200, "another name")],
)
def test_unknown_names_are_errors(name, words):
    with pytest.raises(InputError, match=words) as caught:
        read_spectrum(name)
    assert len(str(caught.value)) < 300
