"""Reader of two-column spectra of light sources, detectors and materials."""

from pathlib import Path

import numpy as np

from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.spectra import Spectrum, wavelength_unit_nm


def read_spectrum(path: str | Path) -> Spectrum:
    """Read a table of two columns, wavelength and value.

    Lines with other text are comments. A comment "Wavelength Units: microns" (as in
    .ssp and .dsp files of LBNL) gives the unit. Default: nanometres, or micrometres
    if all wavelengths are below 100.
    """
    rows: list[tuple[float, float]] = []
    unit = None
    for line in read_text(path).splitlines():
        words = line.replace(",", " ").replace(";", " ").split()
        try:
            rows.append((float(words[0]), float(words[1])))
        except (ValueError, IndexError):
            key, _, name = line.partition(":")
            if "wavelength unit" in key.lower():
                unit = wavelength_unit_nm(name)
    if not rows:
        raise InputError(
            "no rows of wavelength and value; at least one expected", file=path
        )
    wavelength, value = np.array(rows).T
    if unit is None:
        unit = 1000.0 if wavelength.max() < 100 else 1.0
    try:
        return Spectrum(wavelength * unit, value)
    except InputError as error:
        raise InputError(error.message, file=path) from error
