"""Measurements of known layers, fitted once for all tests."""

import pytest

from clerestory.gonio.fitted_measurement import fit_measurement
from goniometer import Goniophotometer, film, pane, rings


@pytest.fixture(scope="session")
def pane_measurement():
    """Isotropic rough pane, measured every 10°."""
    instrument = Goniophotometer(points=800)
    return instrument.measure(pane, rings(azimuths_deg=[0.0]))


@pytest.fixture(scope="session")
def pane_fit(pane_measurement):
    return fit_measurement(pane_measurement)


@pytest.fixture(scope="session")
def film_measurement():
    """Redirecting film with left and right alike: 16 directions of a half circle."""
    instrument = Goniophotometer(points=1000)
    directions = rings(azimuths_deg=[-90, -45, 0, 45, 90], step_deg=20.0, most_deg=60.0)
    return instrument.measure(film, directions)


@pytest.fixture(scope="session")
def film_fit(film_measurement):
    return fit_measurement(film_measurement)
