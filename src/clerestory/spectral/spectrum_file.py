"""Text files of spectral reflectances and transmittances."""

from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.constants import LIBRARY_PREFIX
from clerestory.errors import located
from clerestory.files import read_text
from clerestory.spectra import Spectrum
from clerestory.spectral.material_library import material_spectrum


def read_spectrum(path: str | Path) -> Spectrum:
    r"""Read a spectrum from a file with a wavelength [nm] and a value on each line.

    `library:NAME` is a built-in measured reflectance.

    Columns are separated by spaces, tabs, commas or semicolons. Blank lines, what
    follows a #, and one line of headings are ignored.

    Raises
    ------
    InputError : the file is missing, a line is not two numbers, or wavelengths do not
        increase; no built-in spectrum has the name

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "blue.csv")
    ...     _ = file.write_text("nm, reflectance\n400, 0.6\n700, 0.1\n")
    ...     read_spectrum(file).value.tolist()
    [0.6, 0.1]
    """
    if str(path).startswith(LIBRARY_PREFIX):
        return material_spectrum(str(path))
    rows: list[list[float]] = []
    headed = False
    for number, line in enumerate(read_text(path).split("\n"), start=1):
        words = line.partition("#")[0].replace(",", " ").replace(";", " ").split()
        if not words:
            continue
        if not rows and not headed and not _is_number(words[0]):
            headed = True
            continue
        with located(file=path, line=number):
            rows.append(_row(words))
    require(rows, "no values; lines of wavelength [nm] and value expected", file=path)
    wavelength, value = np.array(rows).T
    with located(file=path):
        return Spectrum(wavelength, value)


def format_spectrum(spectrum: Spectrum, quantity: str) -> str:
    r"""Return the text of a spectrum, with a line of headings.

    >>> format_spectrum(Spectrum(np.array([500.0]), np.array([0.25])), "reflectance")
    'wavelength [nm],reflectance\n500,0.25\n'
    """
    lines = [f"wavelength [nm],{quantity}"]
    pairs = zip(spectrum.wavelength_nm, spectrum.value, strict=True)
    lines += [f"{wavelength:g},{value:.6g}" for wavelength, value in pairs]
    return "\n".join([*lines, ""])


def _row(words: list[str]) -> list[float]:
    require(
        len(words) == 2 and all(map(_is_number, words)),
        f'the line is "{" ".join(words)[:60]}"; a wavelength [nm] and a value expected',
    )
    return [float(word) for word in words]


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
