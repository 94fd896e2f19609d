"""Spectra of sun and sky against published examples."""

from dataclasses import replace

import numpy as np
from numpy.testing import assert_allclose

import clerestory as cl
from clerestory.sky.daylight_spectra import (
    DaylightSpectra,
    sky_colour_temperature,
    sun_spectra,
)
from clerestory.sky.sky_conditions import sky_conditions
from clerestory.sky.solar_position import sun_at
from clerestory.spectral.colour_temperature import (
    colour_temperature,
    daylight_spectrum,
)
from clerestory.spectral.functions import (
    WAVELENGTH_NM,
    integral,
    spectral_function,
)


def sine(degrees):
    return np.sin(np.radians(degrees))


def ozone_cm(latitude, longitude, day):
    """Ozone of the northern hemisphere west of Greenwich (Van Heuklon 1979)."""
    season = 40 * sine(0.9865 * (day - 30))
    own = (150 + season + 20 * sine(3 * longitude)) * sine(1.28 * latitude) ** 2
    return (235 + own) / 1000


def test_sunlight_is_that_of_the_example_of_spectrl2():
    """NREL's test program spectest.c: Atlanta, 22 July 1999, 9:45:37, 1006 mbar.

    The direct spectra it gives as reference are 1066.0, 1220.4 and 923.4 W/(m² µm) at
    450, 550 and 724.4 nm, of which the last has a kink between two nanometres.
    """
    stated = np.array([1066.0, 1220.4, 923.4])
    latitude, longitude = 33.65, -84.43
    elevation = 44307.69 * (1 - (1006 / 1013.25) ** 0.190284)
    times = np.array(["1999-07-22T09:45:37"], dtype="datetime64[s]")
    irradiance = np.array([[800.0], [100.0]])
    place = cl.Weather(
        "", latitude, longitude, elevation, -5.0, times, 1.0, *irradiance
    )
    conditions = replace(
        sky_conditions(place),
        sun=sun_at(place, times, temperature_c=27.0),
        dew_point_c=np.array([(np.log(1.36) + 0.075) / 0.07]),  # 1.36 cm of water
    )
    model = DaylightSpectra(
        aerosol_optical_depth=0.2, ozone_cm=ozone_cm(latitude, longitude, 203)
    )
    spectrum = sun_spectra(place, conditions, model)[0]
    found = np.interp([450, 550, 724.4], WAVELENGTH_NM, spectrum)
    ratio = found / found[1] / (stated / stated[1])
    assert (np.abs(ratio - 1) <= [3e-4, 0, 3e-3]).all()


# Altitudes of Tregenza's rings [°], and the number of patches in each
RINGS = ((6, 30), (18, 30), (30, 24), (42, 24), (54, 18), (66, 12), (78, 6), (90, 1))


def clear_sky(sun_azimuth, sun_altitude):
    """CIE sky 12 at the centres of 145 patches: altitude, azimuth, area, luminance."""
    altitude = np.radians([a for a, count in RINGS for _ in range(count)])
    azimuth = np.concatenate([np.arange(c) * 2 * np.pi / c for _, c in RINGS])
    area = np.concatenate(
        [
            np.full(c, 2 * np.pi / c * (sine(min(a + 6, 90)) - sine(a - 6)))
            for a, c in RINGS
        ]
    )
    area[-1] = 2 * np.pi * (1 - sine(84))
    across = np.cos(azimuth - np.radians(sun_azimuth)) * np.cos(
        np.radians(sun_altitude)
    )
    angle = np.arccos(sine(sun_altitude) * np.sin(altitude) + across * np.cos(altitude))
    scattered = np.exp(-3 * angle) - np.exp(-3 * np.pi / 2)
    luminance = 1 + 10 * scattered + 0.45 * np.cos(angle) ** 2
    luminance *= 1 - np.exp(-0.32 / np.sin(altitude))
    return altitude, azimuth, area, luminance


def test_colour_temperatures_by_chain_are_those_of_another_program():
    """CIE sky 12, sun at 160° and 40°, 10,000 lux: horizontal, and four vertical.

    The example of plotpolarCCT (frudawski.de/plotpolarcct) has 145 patches, and colour
    temperatures by Robertson's method, which is less exact above 10,000 K.
    """
    stated = np.array([12093, 14159, 11316, 10243, 13357])
    altitude, azimuth, area, luminance = clear_sky(160, 40)
    horizontal = area * np.sin(altitude)
    luminance *= 10_000 / (luminance @ horizontal)
    kelvin = sky_colour_temperature(luminance[:, None], np.array([4.0]), "chain")
    spectra = np.array([daylight_spectrum(float(t)) for t in kelvin[:, 0]])
    sides = np.radians([0, 90, 180, 270])[:, None]
    facing = np.maximum(np.cos(azimuth - sides) * np.cos(altitude), 0) * area
    light = (np.vstack([horizontal, facing]) * luminance) @ spectra
    xyz = np.stack([integral(light * spectral_function(name)) for name in "xyz"])
    assert_allclose(colour_temperature(xyz).kelvin, stated, rtol=0.01)
