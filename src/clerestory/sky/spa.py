"""NREL's Solar Position Algorithm (SPA), as implemented by pvlib.

The module of pvlib is loaded without the package, whose import of pandas, SciPy and a
web client takes a second.

Reference: I. Reda, A. Andreas, Solar Position Algorithm for Solar Radiation
Applications, NREL/TP-560-34302, 2008.
"""

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
from jaxtyping import Float

# Terrestrial time minus universal time around now [s], and refraction at sunrise [°]
_DELTA_T = 67.0
_REFRACTION_AT_SUNRISE = 0.5667

# The troposphere of ISO 2533: hPa, K, K/m, and the exponent g / (R L)
_PRESSURE, _TEMPERATURE, _LAPSE, _EXPONENT = 1013.25, 288.15, 0.0065, 5.25588


def standard_pressure(elevation: float) -> float:
    """Return the pressure of the standard atmosphere at an elevation [m], in hPa.

    >>> round(standard_pressure(1000), 1)
    898.7
    """
    ratio = 1 - _LAPSE * elevation / _TEMPERATURE
    return float(_PRESSURE * ratio**_EXPONENT)


def solar_position(
    seconds: Float[np.ndarray, " time"],
    *,
    latitude_deg: float,
    longitude_deg: float,
    elevation: float,
    temperature_c: float,
) -> tuple[Float[np.ndarray, " time"], Float[np.ndarray, " time"]]:
    """Return the solar altitude, with refraction, and azimuth [°].

    Parameters
    ----------
    seconds : since 1970, universal time
    elevation : above sea level [m]
    """
    position = _ALGORITHM.solar_position(
        seconds,
        latitude_deg,
        longitude_deg,
        elevation,
        standard_pressure(elevation),
        temperature_c,
        _DELTA_T,
        _REFRACTION_AT_SUNRISE,
        numthreads=1,
    )
    return position[2], position[4]


def _load() -> ModuleType:
    # Find the package without importing it
    package = importlib.util.find_spec("pvlib")
    if package is None or not package.submodule_search_locations:
        raise ModuleNotFoundError("pvlib is not installed", name="pvlib")
    file = Path(package.submodule_search_locations[0]) / "spa.py"
    spec = importlib.util.spec_from_file_location("clerestory.sky._pvlib_spa", file)
    if spec is None or spec.loader is None:
        raise ModuleNotFoundError(f"{file} cannot be loaded", name="pvlib.spa")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


_ALGORITHM = _load()
