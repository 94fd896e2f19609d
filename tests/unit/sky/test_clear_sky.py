"""The clear sky of Ineichen and Perez against pvlib's, which is independent of ours."""

import numpy as np
import pvlib
import pytest

from clerestory.errors import InputError
from clerestory.sky.clear_sky import clear_sky_irradiance, clear_sky_weather
from clerestory.sky.sky_state import orbit_factor
from clerestory.sky.weather import Site

INNSBRUCK = Site(47.27, 11.39, 1.0, 580.0, "Innsbruck")


@pytest.mark.parametrize("turbidity", [2.0, 3.0, 5.0])
@pytest.mark.parametrize("elevation", [0.0, 580.0, 2500.0])
def test_irradiance_is_that_of_pvlib(turbidity, elevation):
    altitude = np.radians(np.array([3.0, 10.0, 25.0, 50.0, 80.0]))
    zenith = 90 - np.degrees(altitude)
    mass = pvlib.atmosphere.get_absolute_airmass(
        pvlib.atmosphere.get_relative_airmass(zenith, model="kastenyoung1989"),
        pvlib.atmosphere.alt2pres(elevation),
    )
    theirs = pvlib.clearsky.ineichen(
        zenith, mass, turbidity, altitude=elevation, dni_extra=1400.0
    )
    direct, diffuse = clear_sky_irradiance(
        altitude, extraterrestrial=1400.0, turbidity=turbidity, elevation=elevation
    )
    np.testing.assert_allclose(direct, theirs["dni"], rtol=1e-3)
    np.testing.assert_allclose(diffuse, theirs["dhi"], rtol=2e-3, atol=0.05)


def test_the_sun_outside_follows_its_distance():
    """Spencer's series, as pvlib has it: 3.5 % nearer in January."""
    days = np.arange(1, 366, 30)
    expected = pvlib.irradiance.get_extra_radiation(
        days, method="spencer", solar_constant=1.0
    )
    np.testing.assert_allclose(orbit_factor(days), expected, rtol=1e-6)


def test_nights_are_dark_and_noons_bright():
    year = clear_sky_weather(INNSBRUCK, step_minutes=30)
    hour = (year.times - year.times.astype("datetime64[D]")).astype(float) / 3600
    assert len(year) == 2 * 8760
    assert year.step_minutes == 30
    assert np.all(year.direct_normal[(hour < 3) | (hour > 22)] == 0)
    noon = np.abs(hour - 12.25) < 0.3
    assert np.all(year.direct_normal[noon] > 600)
    assert np.all(year.diffuse_horizontal[noon] > 30)


@pytest.mark.parametrize("wrong", [{"turbidity": 0.5}, {"step_minutes": 7}])
def test_numbers_out_of_range_are_reported(wrong):
    with pytest.raises(InputError, match="expected"):
        clear_sky_weather(INNSBRUCK, **wrong)
