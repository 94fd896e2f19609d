"""Quantised hourly values: error, exact limits, and the way through compression."""

import numpy as np
import pytest

from clerestory.report.hourly_codes import (
    DARK,
    STEP,
    decoded_illuminance,
    decompressed,
    hourly_dgp,
    hourly_illuminance,
)

LIMITS = (100.0, 300.0, 432.1, 3000.0)


@pytest.fixture(scope="module")
def lux():
    """Illuminance of 9 decades, and values next to the limits."""
    rng = np.random.default_rng(3)
    beside = np.outer(LIMITS, 1 + np.linspace(-0.01, 0.01, 51)).ravel()
    values = np.concatenate([[0.0], np.geomspace(1e-4, 1.9e5, 20_000), beside])
    return rng.permutation(values)[:20_100].reshape(300, 67).astype(np.float32)


def test_the_error_is_at_most_half_a_per_cent(lux):
    found = decoded_illuminance(hourly_illuminance(lux, LIMITS).codes).T
    assert STEP <= 0.005
    assert np.max(np.abs(found - lux) / (1 + lux)) <= 0.005 * (1 + 1e-3)


@pytest.mark.parametrize("limit", LIMITS)
def test_limits_are_exact(lux, limit):
    """Decoded in single precision, as in the page, values reach the same limits."""
    codes = hourly_illuminance(lux, LIMITS).codes
    found = decoded_illuminance(codes).astype(np.float32).T
    assert np.array_equal(found >= limit, lux >= np.float32(limit))


def test_negative_and_unknown_illuminance_is_zero():
    codes = hourly_illuminance(np.array([[-3.0, np.nan, 0.0]]), LIMITS).codes
    assert codes.tolist() == [[0], [0], [0]]


def test_codes_survive_compression(lux):
    coded = hourly_illuminance(lux, LIMITS)
    assert np.array_equal(decompressed(coded.compressed(), places=300), coded.codes)


def test_smooth_hours_take_less_than_half_a_byte():
    """Sensors times hours, of which one is nearly a multiple of the other."""
    row = np.geomspace(200, 3000, 200)[:, None] * np.abs(np.sin(np.arange(900) / 50))
    coded = hourly_illuminance(row, LIMITS)
    assert len(coded.compressed()) < 0.5 * row.size


def test_dgp_keeps_its_categories():
    dgp = np.array([[0.3999, 0.4001, 0.40, 0.3504, np.nan, 1.2, 0.25049]])
    codes = hourly_dgp(dgp).codes[:, 0].tolist()
    assert codes == [400, 401, 400, 351, DARK, 1000, 250]
