"""Standards for solar and visible averages of spectral properties.

A band is a set of weights at fixed wavelengths. The average of a spectrum is the
weighted sum of its values, accumulated wavelength by wavelength for layer stacks.

References: NFRC 300 (source ASTM E891 direct, AM 1.5; visible D65 and CIE 1931 Y); EN
410 (tables of weights). Sums include only intervals within the band, as in
WINDOW.
"""

from dataclasses import dataclass
from importlib import resources
from typing import Literal, final

import numpy as np

from clerestory.array_types import PerWavelength, Values
from clerestory.brief_repr import brief
from clerestory.checks import one_of, require
from clerestory.spectra import Spectrum, interpolation_matrix

Channel = Literal["solar", "visible"]
CHANNELS: tuple[Channel, ...] = ("solar", "visible")

# Tolerance for rounded wavelengths in files [nm].
_ROUNDING_NM = 1e-3


@final
@dataclass(frozen=True, eq=False)
class Band:
    """Weights of a spectral average, with sum 1."""

    wavelength_nm: PerWavelength
    weight: PerWavelength

    def __post_init__(self) -> None:
        total = float(self.weight.sum())
        require(abs(total - 1) <= 1e-9, f"the weights sum to {total:.6g}; 1 expected")

    def average(self, spectrum: Spectrum) -> float:
        """Average of a spectrum over the band."""
        return float(self.weight @ spectrum.at(self.wavelength_nm))

    def weights(self, known_nm: Values) -> Values:
        """Weights for a linearly interpolated spectrum with other wavelengths."""
        return np.asarray(
            self.weight @ interpolation_matrix(known_nm, self.wavelength_nm)
        )


@final
@dataclass(frozen=True, eq=False)
class Standard:
    """Solar and visible band of a spectral standard (NFRC or EN 410)."""

    name: str
    solar: Band
    visible: Band

    __repr__ = brief

    def band(self, channel: Channel) -> Band:
        """Return the solar or the visible band."""
        return self.solar if channel == "solar" else self.visible


def nfrc() -> Standard:
    """Return the bands of NFRC 300: direct solar AM 1.5, and D65 with CIE 1931 Y."""
    solar = trapezoidal_band(_table("astm_e891_direct"), low_nm=300, high_nm=2500)
    daylight, eye = _table("cie_d65"), _table("cie_1931_y")
    photopic = Spectrum(daylight.wavelength_nm, daylight.value * eye.value)
    return Standard("NFRC", solar, trapezoidal_band(photopic, low_nm=380, high_nm=780))


def en410() -> Standard:
    """Return the bands of EN 410, from its tables of weights."""
    tables = [_table(name) for name in ("en410_solar", "en410_visible")]
    solar, visible = (
        Band(table.wavelength_nm, table.value / table.value.sum()) for table in tables
    )
    return Standard("EN 410", solar, visible)


def standard(name: str) -> Standard:
    """Return a standard by its name, "nfrc" or "en410"."""
    known = {"nfrc": nfrc, "en410": en410}
    word = name.lower().replace(" ", "")
    one_of(word, "the standard", choices=known)
    return known[word]()


def trapezoidal_band(source: Spectrum, *, low_nm: float, high_nm: float) -> Band:
    """Return the band of a source spectrum, by the trapezoidal rule within a range."""
    inside = (source.wavelength_nm >= low_nm - _ROUNDING_NM) & (
        source.wavelength_nm <= high_nm + _ROUNDING_NM
    )
    wavelength, power = source.wavelength_nm[inside], source.value[inside]
    require(
        len(wavelength) > 1 and power.sum() > 0,
        f"the source has no power from {low_nm:g} to {high_nm:g} nm",
    )
    step = np.diff(wavelength)
    half = (np.append(step, 0) + np.insert(step, 0, 0)) / 2
    weight = half * power
    return Band(wavelength, weight / weight.sum())


def _table(name: str) -> Spectrum:
    file = resources.files("clerestory.glazing") / "data" / f"{name}.csv"
    lines = file.read_text(encoding="utf-8").splitlines()
    rows = [line.split(",") for line in lines if line[:1].isdigit()]
    wavelength, value = np.array(rows, dtype=float).T
    return Spectrum(wavelength, value)
