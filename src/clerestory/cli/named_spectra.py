"""Spectra of materials on the command line, as MATERIAL=FILE."""

from collections.abc import Sequence

from clerestory.bands import RGB, Bands
from clerestory.checks import require
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import band_set
from clerestory.spectral.spectrum_file import read_spectrum


def spectral_bands(
    name: str, texts: Sequence[str] | None
) -> tuple[Bands, dict[str, Spectrum]] | None:
    """Return the bands of --spectral and the spectra of --spectrum; None without.

    Raises
    ------
    InputError : unknown bands, or a text is not MATERIAL=FILE
    """
    if not name:
        require(not texts, "--spectrum without --spectral; the bands expected")
        return None
    spectra = {}
    for text in texts or []:
        material, _, file = text.partition("=")
        require(
            material and file,
            f'--spectrum is "{text}"; a text such as slat=library:pine expected',
        )
        spectra[material] = read_spectrum(file)
    bands = band_set(name)
    require(bands != RGB, f"--spectral {RGB}; bands such as 20 expected")
    return bands, spectra
