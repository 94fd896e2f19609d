"""Spectra of sunlight and skylight at each time step.

Sunlight has the spectrum of direct irradiance through a clear atmosphere (SPECTRL2),
scaled to the illuminance of the weather data. Skylight has the spectrum of daylight
(CIE 15) of a colour temperature that depends on the luminance of the sky patch.

References: R. Bird, C. Riordan, "Simple solar spectral model for direct and diffuse
irradiance on horizontal and tilted planes", J. Climate Appl. Meteorol. 25 (1986), as
implemented in pvlib; C. Chain, D. Dumortier, M. Fontoynont, Solar Energy 65 (1999); T.
Takagi et al., Proc. Japanese Congress (1990), and A. Diakite-Kortlever, M. Knoop,
Lighting Res. Technol. 53 (2021), with the figures in Radiance's perezlum_c.cal.
"""

import importlib
from dataclasses import dataclass
from typing import Literal, final

import numpy as np
from jaxtyping import Bool, Float

from clerestory.argument_types import checked_fields
from clerestory.array_types import Series
from clerestory.checks import one_of, within
from clerestory.sky.measured_spectra import MeasuredSpectra
from clerestory.sky.sky_conditions import SkyConditions
from clerestory.sky.sky_state import precipitable_water_cm
from clerestory.sky.solar_position import day_of_year
from clerestory.sky.weather import Weather
from clerestory.spectra import interpolation_matrix
from clerestory.spectral.functions import (
    MAXIMUM_EFFICACY,
    WAVELENGTH_NM,
    integral,
    spectral_function,
)

SkyColour = Literal["diakite", "chain", "takagi", "d65"]
SunColour = Literal["spectrl2", "d65"]
SKY_COLOURS: tuple[SkyColour, ...] = ("diakite", "chain", "takagi", "d65")
SUN_COLOURS: tuple[SunColour, ...] = ("spectrl2", "d65")

# Colour temperature of D65, and of overcast skies by two of the models [K]
_D65_K, _OVERCAST_K = 6504.0, {"diakite": 6191.0, "chain": 6514.0}

# Perez clearness below which a sky is overcast (Perez et al. 1990, category 1)
_OVERCAST = 1.065

# Coefficients a and b of 1e6/T = a + b log10(L), with the luminance L in cd/m²
_RECIPROCAL = {"diakite": (-180.956, 78.648), "chain": (-132.1, 59.77)}

# Limits of colour temperatures: those of daylight in CIE 15
_LEAST_K, _MOST_K = 4000.0, 25_000.0

# Luminance below which the models are not used [cd/m²]
_LEAST_LUMINANCE = 250.0


@final
@checked_fields
@dataclass(frozen=True)
class DaylightSpectra:
    """Models of the spectra of sky and sun, and the atmosphere of the latter.

    Attributes
    ----------
    sky : colour of the sky by luminance: "diakite", "chain" or "takagi"; or "d65"
    sun : "spectrl2" or "d65"
    aerosol_optical_depth : aerosol optical depth at 500 nm
    ozone_cm : ozone [atm-cm]

    measured_sky, measured_sun : measured spectra in place of the models

    Precipitable water follows from the dew point of the weather data, as for luminous
    efficacy.

    Examples
    --------
    >>> DaylightSpectra().sky
    'diakite'
    """

    sky: SkyColour = "diakite"
    sun: SunColour = "spectrl2"
    aerosol_optical_depth: float = 0.1
    ozone_cm: float = 0.3
    measured_sky: MeasuredSpectra | None = None
    measured_sun: MeasuredSpectra | None = None

    def __post_init__(self) -> None:
        one_of(self.sky, "the colour of the sky", choices=SKY_COLOURS)
        one_of(self.sun, "the colour of the sun", choices=SUN_COLOURS)
        depth, ozone = self.aerosol_optical_depth, self.ozone_cm
        within(depth, "aerosol optical depth", least=0, most=5)
        within(ozone, "ozone", least=0, most=1, unit="atm-cm")

    def attributes(self) -> dict[str, str | float]:
        """Provenance of a sky with these spectra."""
        return {
            "sky_colour_model": "measured" if self.measured_sky else self.sky,
            "sun_spectrum": "measured" if self.measured_sun else self.sun,
            "aerosol_optical_depth": self.aerosol_optical_depth,
            "ozone_cm": self.ozone_cm,
        }


def sky_colour_temperature(
    luminance: Float[np.ndarray, "patch time"],
    clearness: Series,
    model: SkyColour = "diakite",
) -> Float[np.ndarray, "patch time"]:
    """Correlated colour temperature [K] of sky patches, from 4000 to 25000 K.

    Parameters
    ----------
    luminance : luminance of the patches [cd/m²]
    clearness : sky clearness ε of the Perez model at each time step

    Examples
    --------
    >>> sky_colour_temperature(np.array([[5000.0]]), np.array([4.0])).round()
    array([[9094.]])
    """
    one_of(model, "the colour of the sky", choices=SKY_COLOURS)
    if model == "d65":
        return np.full(luminance.shape, _D65_K)
    bright = np.maximum(luminance, _LEAST_LUMINANCE)
    if model == "takagi":
        return np.asarray(np.clip(6500 + 1.1985e8 / bright**1.2, _LEAST_K, _MOST_K))
    a, b = _RECIPROCAL[model]
    reciprocal = np.clip(a + b * np.log10(bright), 1e6 / _MOST_K, 1e6 / _LEAST_K)
    return np.where(clearness < _OVERCAST, _OVERCAST_K[model], 1e6 / reciprocal)


def sun_spectra(
    weather: Weather, conditions: SkyConditions, model: DaylightSpectra
) -> Float[np.ndarray, "time wavelength"]:
    """Direct spectral irradiance at `WAVELENGTH_NM`, per lux of direct illuminance.

    The unit is W/(m²·nm·lux). Without direct light it is the spectrum of D65.
    """
    lit = conditions.direct_normal > 0
    if model.measured_sun is not None:
        found = model.measured_sun.at(weather.times, lit)
    else:
        found = np.tile(spectral_function("d65"), (len(weather), 1))
        if model.sun == "spectrl2" and lit.any():
            found[lit] = _spectrl2(weather, conditions, model, lit)
    lux = MAXIMUM_EFFICACY * integral(found * spectral_function("y"))
    return np.asarray(found / lux[:, None])


def _spectrl2(
    weather: Weather,
    conditions: SkyConditions,
    model: DaylightSpectra,
    lit: Bool[np.ndarray, " time"],
) -> Float[np.ndarray, "lit wavelength"]:
    # Imported here, since pvlib loads slowly
    atmosphere = importlib.import_module("pvlib.atmosphere")
    spectrum = importlib.import_module("pvlib.spectrum")
    zenith = np.clip(90 - np.degrees(conditions.sun.altitude[lit]), 0, 90)
    spectra = spectrum.spectrl2(
        apparent_zenith=zenith,
        aoi=zenith,
        surface_tilt=0,
        ground_albedo=0.2,
        surface_pressure=atmosphere.alt2pres(weather.elevation),
        relative_airmass=atmosphere.get_relative_airmass(zenith, "kastenyoung1989"),
        precipitable_water=precipitable_water_cm(conditions.dew_point_c)[lit],
        ozone=model.ozone_cm,
        aerosol_turbidity_500nm=model.aerosol_optical_depth,
        dayofyear=day_of_year(weather.times)[lit],
    )
    known, direct = spectra["wavelength"], np.nan_to_num(spectra["dni"])
    return np.asarray(direct.T @ interpolation_matrix(known, WAVELENGTH_NM).T)
