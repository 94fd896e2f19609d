"""The equation I = V T D S on matrices whose product is known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csc_array

from clerestory.errors import MatrixError
from clerestory.matrix.axis import sensor_axis, sky_axis, window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases import blockwise_product
from clerestory.phases.blockwise_product import BlockwiseProduct
from clerestory.phases.column_light import sky_product
from clerestory.phases.illuminance import illuminance
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    WindowMatrices,
    window_chain,
)
from clerestory.phases.methods import METHODS, THREE_PHASE, three_phase
from clerestory.phases.receivers import sky_coefficients
from phase_matrices import (
    KLEMS,
    LUX,
    SENSORS,
    SKY,
    daylight,
    transmission,
    uniform_sky,
    view,
    window_matrices,
)


def test_a_clear_window_under_a_uniform_sky_gives_pi_times_its_transmittance():
    result = three_phase(
        [window_matrices(view("w"), transmission(0.5), daylight("w"))], uniform_sky()
    )
    expected = np.pi * 0.5 * LUX * np.array([1, 2, 0])
    assert result["illuminance"].dtype == np.float32
    np.testing.assert_allclose(
        result["illuminance"], np.tile(expected, (SENSORS, 1)), rtol=5e-6
    )
    assert np.all(result["standard_error"] == 0)


def test_windows_add_up():
    windows = [
        window_matrices(view(name, share=share), transmission(tau), daylight(name))
        for name, share, tau in (("a", 0.25, 0.8), ("b", 0.5, 0.1))
    ]
    result = three_phase(windows, uniform_sky())
    expected = np.pi * LUX * (0.25 * 0.8 + 0.5 * 0.1)
    np.testing.assert_allclose(result["illuminance"][:, 0], expected, rtol=5e-6)


def test_errors_of_views_traced_together_add_before_they_are_squared():
    """Two windows with opposite errors in every batch cancel exactly."""
    rng = np.random.default_rng(3)
    one = view("a", rng=rng, count=5)
    mirrored = TransferMatrix(
        one.values, one.rows, window_axis("interior", KLEMS, "b"), -one.components
    )
    pairs = ((one, "a"), (mirrored, "b"))
    windows = [window_matrices(v, transmission(1.0), daylight(n)) for v, n in pairs]
    result = three_phase(windows, uniform_sky())
    np.testing.assert_allclose(result["standard_error"], 0, atol=1e-4)

    doubled = [
        window_matrices(one, transmission(1.0), daylight("a")),
        window_matrices(
            TransferMatrix(one.values, one.rows, mirrored.columns, one.components),
            transmission(1.0),
            daylight("b"),
        ),
    ]
    single = three_phase(
        [window_matrices(one, transmission(1.0), daylight("a"))], uniform_sky()
    )
    np.testing.assert_allclose(
        three_phase(doubled, uniform_sky())["standard_error"],
        2 * single["standard_error"],
        rtol=1e-5,
    )


def test_errors_of_daylight_matrices_are_independent():
    """Two windows alike: their errors add in squares, so √2 times one window's."""
    rng = np.random.default_rng(4)
    bright = daylight("a", rng=rng, count=6)
    windows = [
        window_matrices(
            view(name),
            transmission(1.0),
            TransferMatrix(
                bright.values,
                window_axis("exterior", KLEMS, name),
                bright.columns,
                bright.components,
            ),
        )
        for name in ("a", "b")
    ]
    one = three_phase(windows[:1], uniform_sky())["standard_error"]
    both = three_phase(windows, uniform_sky())["standard_error"]
    np.testing.assert_allclose(both, np.sqrt(2) * one, rtol=1e-5)


def test_blocks_of_sensors_give_what_the_whole_gives():
    rng = np.random.default_rng(5)
    seen = view("w", rng=rng, count=3)
    window = window_matrices(seen, transmission(0.7), daylight("w", rng=rng, count=4))
    whole = sky_coefficients([window.whole], slice(0, SENSORS))
    result = three_phase([window], uniform_sky())
    expected = (whole @ uniform_sky()).illuminance()
    np.testing.assert_allclose(
        result["illuminance"], expected["illuminance"], rtol=5e-6
    )
    np.testing.assert_allclose(
        result["standard_error"], expected["standard_error"], rtol=1e-5
    )
    assert whole.components.shape[0] == 7


def test_two_phase_is_the_plain_product():
    values = np.full((3, SENSORS, len(SKY)), np.pi / len(SKY))
    coefficients = TransferMatrix(values, sensor_axis(SENSORS), sky_axis(SKY))
    windows = [WindowMatrices(MatrixChain((coefficients,)))]
    terms = METHODS["2-phase"].terms(corrected=False)
    result = illuminance(windows, terms, Skies(uniform_sky()))
    np.testing.assert_allclose(result["illuminance"][:, 1], 2 * np.pi * LUX, rtol=5e-6)


def test_matrices_of_different_windows_are_refused():
    with pytest.raises(MatrixError, match="window 'b'"):
        window_matrices(view("a"), transmission(1.0), daylight("b"))


def test_a_bsdf_that_is_not_given_is_named():
    with pytest.raises(MatrixError, match="transmission matrix of a BSDF"):
        _ = view("a") @ daylight("a")


def test_views_of_different_sensors_are_refused():
    short = view("b").select_rows(slice(0, 3))
    windows = [
        window_matrices(view("a"), transmission(1.0), daylight("a")),
        window_matrices(short, transmission(1.0), daylight("b")),
    ]
    with pytest.raises(MatrixError, match="same sensors expected"):
        three_phase(windows, uniform_sky())


def test_no_window_at_all_is_refused():
    with pytest.raises(MatrixError, match="no window"):
        three_phase([], uniform_sky())


@pytest.mark.parametrize("moving", [False, True], ids=["fixed", "moving"])
def test_the_error_of_a_mean_comes_from_its_components(moving):
    """Error components of the sum of two steps, of radiance 1 and 2.

    All steps share V and D, so that errors add with their signs: the error of the sum
    is the sum of the errors, to the 8 bits of the components.
    """
    rng = np.random.default_rng(6)
    seen, bright = view("w", rng=rng, count=3), daylight("w", rng=rng, count=4)
    T = [transmission(0.7)] * 2
    window = WindowMatrices(window_chain(seen, T, bright))
    states = [np.array([0, 1, 1]) if moving else np.zeros(3, int)]
    skies = Skies(uniform_sky())
    found = illuminance([window], THREE_PHASE, skies, states)
    product = (seen @ T[0] @ bright).weighted(seen.bands.weights)
    one = np.linalg.norm(product.components[:, 0].sum(axis=-1), axis=0)
    np.testing.assert_allclose(found["standard_error"][:, 0], one, rtol=1e-4)
    parts = found["standard_error"] * found["error_components"] / 127
    error = np.sqrt((parts[{"time": slice(2)}].sum("time") ** 2).sum("component"))
    np.testing.assert_allclose(error, 3 * one, rtol=0.01)
    hourly = found["standard_error"].values
    np.testing.assert_allclose(hourly[:, 1], 2 * hourly[:, 0], rtol=1e-4)


def test_windows_that_no_sensor_sees_change_nothing():
    """Only the first of three windows is seen; D of all of them has errors."""
    rng = np.random.default_rng(5)
    windows = [
        window_matrices(
            view(name, rng=rng, count=5 if share else 0, share=share),
            transmission(0.5),
            daylight(name, rng=rng, count=4),
        )
        for name, share in (("a", 0.3), ("b", 0.0), ("c", 0.0))
    ]
    alone, all_of_them = (three_phase(w, uniform_sky()) for w in (windows[:1], windows))
    assert np.all(alone["standard_error"][:, :2] > 0)
    for name in ("illuminance", "standard_error"):
        np.testing.assert_allclose(all_of_them[name], alone[name], rtol=1e-5)


def test_a_grey_matrix_under_a_coloured_sky_equals_one_of_three_equal_channels():
    random = np.random.default_rng(6)
    sun = np.zeros((len(SKY), 3), np.float32)
    sun[[20, 31], [0, 2]] = 500.0, 300.0
    sky = replace(
        uniform_sky(),
        colour=random.random((3, len(SKY))),
        sun=csc_array(sun),
        sun_colour=np.array([1.2, 1.0, 0.5]),
    )
    grey = random.random((2, 1, 5, len(SKY)), dtype=np.float32)
    coloured = np.repeat(grey, 3, axis=1)
    weights = np.array([47.4, 119.9, 11.6])
    np.testing.assert_allclose(
        sky_product(grey, sky, weights), sky_product(coloured, sky, weights), rtol=1e-5
    )


def test_moving_shades_give_the_same_in_both_orders_of_multiplication(monkeypatch):
    """V (T D S), and (V T D) S for each combination of the states of two windows.

    Deviations of V and D are the same in all states, so that they add over time.
    """
    rng = np.random.default_rng(8)
    windows = [
        window_matrices(
            view(name, rng=rng, count=3),
            [transmission(tau) for tau in taus],
            daylight(name, rng=rng, count=4),
        )
        for name, taus in (("a", (0.7, 0.2)), ("b", (0.5, 0.1)))
    ]
    states = [np.array([0, 1, 1]), np.array([1, 0, 1])]
    skies = Skies(uniform_sky((1.0, 2.0, 3.0)))

    def found(short):
        monkeypatch.setattr(
            blockwise_product, "coefficients_cost_less", lambda *_, **__: short
        )
        product = BlockwiseProduct(
            windows, THREE_PHASE, skies, states, LUX * np.eye(3), SENSORS
        )
        (block,) = product.blocks()
        parts = np.concatenate([part.values for part in block.components])
        return block.terms, np.sort(parts.sum(axis=-1), axis=0), product

    short, in_time, product = found(True)
    assert len(product._chains(THREE_PHASE[0])) == 1
    long, expected, _ = found(False)
    np.testing.assert_allclose(short, long, rtol=1e-5)
    assert in_time.shape == expected.shape == (3 + 4 + 4, 3, SENSORS)
    np.testing.assert_allclose(in_time, expected, rtol=1e-4, atol=1e-4)
    shares = np.array([0.7 + 0.1, 0.2 + 0.5, 0.2 + 0.1])
    bright = np.pi * LUX * np.array([1, 2, 3]) * shares
    np.testing.assert_allclose(short[0, 0, 0], bright, rtol=1e-5)
