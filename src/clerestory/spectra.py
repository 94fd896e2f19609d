"""Spectra: quantities as functions of wavelength, interpolated linearly.

Wavelengths are in nanometres; the readers of glazing files convert micrometres.
"""

from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import finite, positive, require, same_length
from clerestory.errors import InputError

# Length of wavelength units in nanometres, by the first letters of the unit name
_UNITS_NM = {"nm": 1.0, "nano": 1.0, "um": 1000.0, "µm": 1000.0, "micro": 1000.0}


@final
@dataclass(frozen=True, eq=False)
class Spectrum:
    """A quantity as a function of wavelength; wavelengths increase.

    >>> ramp = Spectrum(np.array([400.0, 500.0]), np.array([0.0, 1.0]))
    >>> ramp.at(np.array([300.0, 450.0, 600.0])).tolist()
    [0.0, 0.5, 1.0]
    """

    wavelength_nm: Float[np.ndarray, " wavelength"]
    value: Float[np.ndarray, " wavelength"]

    __repr__ = brief

    def __post_init__(self) -> None:
        check_wavelengths(self.wavelength_nm)
        same_length(self.value, self.wavelength_nm, "values", "wavelengths")
        finite(self.value, "a value of a spectrum")

    def at(
        self, wavelength_nm: Float[np.ndarray, "*batch"]
    ) -> Float[np.ndarray, "*batch"]:
        """Values interpolated at given wavelengths [nm]; constant beyond both ends."""
        return np.asarray(np.interp(wavelength_nm, self.wavelength_nm, self.value))


def check_wavelengths(wavelength_nm: Float[np.ndarray, " wavelength"]) -> None:
    """Check that wavelengths are positive and increasing."""
    w = wavelength_nm
    require(len(w), "no wavelengths; one or more expected")
    positive(w, "wavelength", unit="nm")
    for at in np.flatnonzero(np.diff(w) <= 0):
        raise InputError(
            f"wavelength {w[at + 1]:g} nm follows {w[at]:g} nm; increasing wavelengths"
            " expected"
        )


def interpolation_matrix(
    known_nm: Float[np.ndarray, " known"], wanted_nm: Float[np.ndarray, " wanted"]
) -> Float[np.ndarray, "wanted known"]:
    """Matrix that interpolates values from known to wanted wavelengths [nm].

    Beyond the shortest and longest known wavelength, values are constant.

    >>> one = interpolation_matrix(np.array([1.0, 2.0]), np.array([1.25]))
    >>> one.tolist()
    [[0.75, 0.25]]
    """
    return np.stack(
        [np.interp(wanted_nm, known_nm, unit) for unit in np.eye(len(known_nm))],
        axis=1,
    )


def common_wavelengths(
    grids: list[Float[np.ndarray, " _"]],
) -> Float[np.ndarray, " wavelength"]:
    """Union of several wavelength grids within their common range [nm].

    >>> a, b = np.array([300.0, 400.0, 500.0]), np.array([350.0, 600.0])
    >>> common_wavelengths([a, b]).tolist()
    [350.0, 400.0, 500.0]
    """
    low = max(float(grid[0]) for grid in grids)
    high = min(float(grid[-1]) for grid in grids)
    require(
        low <= high,
        f"the spectrum of one layer begins at {low:g} nm, but that of another layer"
        f" ends at {high:g} nm; overlapping ranges expected",
    )
    every = np.unique(np.concatenate(grids))
    return every[(every >= low) & (every <= high)]


def wavelength_unit_nm(name: str) -> float | None:
    """Return the length of a named wavelength unit [nm]; None for unknown names.

    >>> wavelength_unit_nm("Microns"), wavelength_unit_nm("nanometers")
    (1000.0, 1.0)
    """
    word = name.strip().lower()
    return next((nm for key, nm in _UNITS_NM.items() if word.startswith(key)), None)
