"""Built-in library of measured spectral reflectances: woods, paints, bricks, fabrics.

Source: R. F. Kokaly et al., USGS Spectral Library Version 7 (2017), doi:10.3133/ds1035,
in the public domain. Each is one sample, not the mean of a kind of material.
"""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np

from clerestory.constants import LIBRARY_PREFIX
from clerestory.errors import InputError
from clerestory.spectra import Spectrum

# Longest name in an error message
_SHOWN = 60


@dataclass(frozen=True, eq=False)
class MaterialSample:
    """A measured sample: its description, its record in the source, its reflectance."""

    words: str
    record: str
    reflectance: Spectrum


@cache
def material_samples() -> Mapping[str, MaterialSample]:
    """Return all samples by name.

    >>> material_samples()["pine"].words
    'new pine beam'
    """
    file = resources.files("clerestory.spectral") / "data" / "materials.csv"
    lines = file.read_text(encoding="utf-8").splitlines()
    head, *rows = [line.split(",") for line in lines if not line.startswith("#")]
    wavelength = np.array(head[3:], dtype=float)
    return {
        name: MaterialSample(words, record, Spectrum(wavelength, np.array(row, float)))
        for name, words, record, *row in rows
    }


def material_spectrum(name: str) -> Spectrum:
    """Return the reflectance of a sample by name, with or without `library:` before it.

    Raises
    ------
    InputError : no sample has the name

    Examples
    --------
    >>> pine = material_spectrum("library:pine")
    >>> pine.at(np.array([450.0, 650.0])).round(2).tolist()
    [0.22, 0.46]
    """
    given, samples = name.removeprefix(LIBRARY_PREFIX), material_samples()
    if given in samples:
        return samples[given].reflectance
    near = difflib.get_close_matches(given[:_SHOWN], samples, n=3)
    such = f"one such as {', '.join(near)}" if near else "another name"
    raise InputError(
        f"no built-in spectrum is named {given[:_SHOWN]!r}; {such} expected"
        " (`clerestory bsdf library` lists all)"
    )
