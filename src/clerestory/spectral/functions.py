"""Spectral weighting functions and daylight spectra, every 1 nm from 380 to 780 nm.

The CIE 1931 observer (ISO/CIE 11664-1), illuminant D65 (ISO/CIE 11664-2), the
components S0, S1 and S2 of daylight (CIE 15:2018) and the α-opic action spectra of
CIE S 026:2018. Between the wavelengths all are interpolated linearly.
"""

from functools import cache
from importlib import resources

import numpy as np
from jaxtyping import Float

# Wavelengths of all functions [nm]
WAVELENGTH_NM: Float[np.ndarray, " wavelength"] = np.arange(380.0, 781.0)

# Weights of the trapezoidal rule over these wavelengths [nm]
STEP_NM: Float[np.ndarray, " wavelength"] = np.ones(len(WAVELENGTH_NM))
STEP_NM[[0, -1]] = 0.5

# Maximum luminous efficacy of photopic vision [lm/W]
MAXIMUM_EFFICACY = 683.0


@cache
def spectral_function(name: str) -> Float[np.ndarray, " wavelength"]:
    """Values of a function by its name, such as "y", "melanopic", "d65" or "s0".

    >>> float(spectral_function("y").max())  # at 555 nm
    1.0
    """
    file = resources.files("clerestory.spectral") / "data" / "spectral_functions.csv"
    lines = file.read_text(encoding="utf-8").splitlines()
    names, *rows = [line.split(",") for line in lines if not line.startswith("#")]
    values = np.array([row[names.index(name)] for row in rows], dtype=float)
    values.flags.writeable = False
    return values


def integral(values: Float[np.ndarray, "*batch wavelength"]) -> np.ndarray:
    """Integral over wavelength by the trapezoidal rule, of values at `WAVELENGTH_NM`.

    >>> round(float(integral(spectral_function("y"))), 2)  # ∫ V(λ) dλ [nm]
    106.86
    """
    return np.asarray(values @ STEP_NM)
