"""Windows whose shades move, on matrices whose product is known."""

import numpy as np
import pytest
from scipy.sparse import csc_array

from clerestory.errors import MatrixError
from clerestory.matrix.axis import sensor_axis, sun_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.illuminance import illuminance
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    Term,
    WindowMatrices,
    window_chain,
)
from clerestory.phases.methods import five_phase, three_phase
from clerestory.sky.sun_matrix import SunMatrix
from phase_matrices import (
    KLEMS,
    LUX,
    SENSORS,
    SKY,
    daylight,
    transmission,
    uniform_sky,
    view,
)

TAUS = (0.8, 0.3, 0.1)


def shaded(name, *, share=1.0, rng=None, count=0):
    """A window with three states that differ in their transmittance alone."""
    return WindowMatrices(
        window_chain(
            view(name, share=share, rng=rng, count=count),
            [transmission(tau) for tau in TAUS],
            daylight(name, rng=rng, count=count),
        )
    )


def suns():
    """Two suns of 800 W/m², in the first and the last of three steps."""
    normal = csc_array(np.array([[800.0, 0, 0], [0, 0, 800.0]]))
    directions = np.array([[0.0, -1, 0], [0, -0.8, 0.6]])
    return SunMatrix(directions, uniform_sky().times, normal, {})


def sun_matrix(value, error=0.0):
    """Coefficients that are the same for every sensor and sun."""
    values = np.full((3, SENSORS, 2), value)
    parts = np.full((1, *values.shape), error)
    return TransferMatrix(values, sensor_axis(SENSORS), sun_axis(2), parts)


def test_each_step_has_the_light_of_the_states_that_act():
    """E = π L Σ share·τ(state), for a uniform sky of radiance 1, 2 and 0."""
    windows = [shaded("a", share=0.25), shaded("b", share=0.5)]
    states = [np.array([0, 2, 1]), np.array([1, 0, 0])]
    result = three_phase(windows, uniform_sky(), states)
    passed = 0.25 * np.take(TAUS, states[0]) + 0.5 * np.take(TAUS, states[1])
    expected = np.pi * LUX * passed * [1, 2, 0]
    np.testing.assert_allclose(
        result["illuminance"], np.tile(expected, (SENSORS, 1)), rtol=5e-6
    )
    assert result["illuminance"].dtype == np.float32


def test_a_state_that_never_changes_is_the_three_phase_method():
    """Values and errors, those shared by views traced together included."""
    rng = np.random.default_rng(1)
    windows = [shaded(name, rng=rng, count=5, share=0.5) for name in ("a", "b")]
    states = [np.full(3, 1), np.full(3, 2)]
    ours = three_phase(windows, uniform_sky(), states)
    theirs = three_phase(
        [
            WindowMatrices(window.whole.at(state[0]))
            for window, state in zip(windows, states, strict=True)
        ],
        uniform_sky(),
    )
    for name in ("illuminance", "standard_error"):
        np.testing.assert_allclose(ours[name], theirs[name], rtol=2e-5)


def test_direct_sun_is_that_of_the_state_that_acts():
    """A coefficient c gives 179 c lux per W/m² of the sun."""
    states = [np.array([0, 0, 1]), np.array([1, 0, 0])]
    coefficients = [
        (sun_matrix(0.4, 0.01), sun_matrix(0.1, 0.02)),
        (sun_matrix(0.2), sun_matrix(0.05)),
    ]
    windows = [
        WindowMatrices(chain, sun=chain) for chain in map(MatrixChain, coefficients)
    ]
    skies = Skies(uniform_sky(), suns=suns())
    result = illuminance(windows, (Term("sun", "sun"),), skies, states)
    expected = LUX * 800 * np.array([0.4 + 0.05, 0, 0.1 + 0.2])
    np.testing.assert_allclose(result["illuminance"][0], expected, rtol=1e-6)
    errors = LUX * 800 * np.array([0.01, 0, 0.02])
    np.testing.assert_allclose(result["standard_error"][0], errors, rtol=1e-5)


def test_states_that_never_change_are_the_five_phase_method():
    rng = np.random.default_rng(2)
    whole = [shaded(name, rng=rng, count=4, share=0.5) for name in ("a", "b")]
    direct = [shaded(name, rng=rng, count=4, share=0.1) for name in ("a", "b")]
    sun = MatrixChain(tuple(sun_matrix(c) for c in (0.4, 0.2, 0.1)))
    sky, states = uniform_sky(), [np.full(3, 0), np.full(3, 2)]
    windows = [
        WindowMatrices(w.whole, d.whole, sun)
        for w, d in zip(whole, direct, strict=True)
    ]
    ours = five_phase(windows, sky, sky, suns(), states)
    parts = [
        WindowMatrices(w.whole.at(s[0]), w.direct.at(s[0]), w.sun.at(s[0]))
        for w, s in zip(windows, states, strict=True)
    ]
    theirs = five_phase(parts, sky, sky, suns())
    assert set(ours) == set(theirs)
    for name in ours:
        np.testing.assert_allclose(ours[name], theirs[name], rtol=2e-5, atol=1e-2)


@pytest.mark.parametrize("states", [[0, 1, 3], [0, -1, 0], [0, 1]])
def test_states_that_do_not_exist_are_refused(states):
    with pytest.raises(MatrixError, match="shade states"):
        three_phase([shaded("a")], uniform_sky(), [np.array(states)])


def test_a_state_over_other_patches_is_refused():
    seen = view("a")
    odd = TransferMatrix(np.eye(3)[None], sensor_axis(3), sensor_axis(3))
    with pytest.raises(MatrixError, match=f"{len(KLEMS)} window patches"):
        window_chain(seen, odd, daylight("a"))
    assert len(SKY) == 146
