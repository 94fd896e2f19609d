"""Error of a set of bands against 1 nm, for given spectra of materials.

Daylight of three colour temperatures meets each spectrum once and each pair of spectra,
as after two reflections, or a transmission and a reflection. The quantities of light in
bands are compared with integrals over wavelengths at every nanometre.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np
from jaxtyping import Float

from clerestory.bands import Bands
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import (
    WEIGHTINGS,
    band_means,
    efficacy,
    gives,
    light_in_bands,
)
from clerestory.spectral.colour_temperature import (
    colour_temperature,
    daylight_spectrum,
    tristimulus,
)
from clerestory.spectral.functions import WAVELENGTH_NM, integral, spectral_function

# Colour temperatures of daylight: the sun, an overcast sky, a clear sky [K]
_KELVIN = (4500.0, 6504.0, 15_000.0)

# Largest number of spectra that are combined in pairs
_MOST = 12


@dataclass(frozen=True)
class BandErrors:
    """Largest errors of light in bands against 1 nm, after up to two materials.

    Attributes
    ----------
    illuminance, melanopic : relative error; None if the bands do not give the quantity
    kelvin : error of the correlated colour temperature [K]; None without wavelengths
    """

    illuminance: float | None
    melanopic: float | None
    kelvin: float | None

    def __str__(self) -> str:
        words = [
            f"{name} within {100 * value:.1f} %"
            for name, value in (
                ("illuminance", self.illuminance),
                ("melanopic EDI", self.melanopic),
            )
            if value is not None
        ]
        if self.kelvin is not None:
            words.append(f"colour temperature within {self.kelvin:.0f} K")
        return ", ".join(words)


def band_errors(bands: Bands, spectra: Sequence[Spectrum] = ()) -> BandErrors:
    """Return the largest errors of bands for daylight that meets given materials.

    Examples
    --------
    >>> from clerestory.spectral.band_sets import band_set
    >>> oak = Spectrum(np.array([400.0, 500.0, 600.0]), np.array([0.1, 0.25, 0.45]))
    >>> print(band_errors(band_set("melanopic+photopic"), [oak]))
    illuminance within 7.9 %, melanopic EDI within 11.0 %
    """
    errors: dict[str, list[float]] = {}
    for kelvin in _KELVIN:
        power = daylight_spectrum(kelvin)
        for chosen in _combinations(spectra[:_MOST]):
            fine, coarse = power, light_in_bands(power, bands)
            for one in chosen:
                fine = fine * one.at(WAVELENGTH_NM)
                coarse = coarse * band_means(one, bands)
            for name, error in _differences(fine, coarse, bands).items():
                errors.setdefault(name, []).append(error)
    most = {name: float(np.max(values)) for name, values in errors.items()}
    return BandErrors(most.get("photopic"), most.get("melanopic"), most.get("kelvin"))


def _combinations(spectra: Sequence[Spectrum]) -> Iterator[tuple[Spectrum, ...]]:
    yield ()
    yield from ((one,) for one in spectra)
    yield from combinations_with_replacement(spectra, 2)


def _differences(
    fine: Float[np.ndarray, " wavelength"],
    coarse: Float[np.ndarray, " band"],
    bands: Bands,
) -> dict[str, float]:
    found = {}
    for name in ("photopic", "melanopic"):
        if not gives(bands, name):
            continue
        exact = float(integral(fine * spectral_function(WEIGHTINGS[name])))
        value = float(efficacy(bands, name) @ coarse)
        if exact > 0:
            found[name] = abs(value / exact - 1)
    if bands.limits_nm is not None:
        xyz = [float(integral(fine * spectral_function(name))) for name in "xyz"]
        exact = float(colour_temperature(np.array(xyz)).kelvin)
        value = float(colour_temperature(tristimulus(coarse, bands)).kelvin)
        if np.isfinite(exact) and exact < 25_000:
            error = abs(value - exact) if np.isfinite(value) else np.inf
            found["kelvin"] = error
    return found
