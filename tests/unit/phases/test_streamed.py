"""Streamed products are those of matrices in memory."""

import h5py
import numpy as np
import pytest

from clerestory.errors import MatrixError
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import sensor_axis, sky_axis, unknown_axis, window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.illuminance import illuminance
from clerestory.phases.matrix_equation import Skies, Term, WindowMatrices, window_chain
from clerestory.phases.matrix_store import MatrixStore
from clerestory.phases.methods import three_phase
from clerestory.phases.stored_views import StoredColumns, StoredViews, pooled
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.weather_formats import read_weather
from clerestory.study.new_study import write_demo

BASIS = klems("quarter")
SENSORS = 70


@pytest.fixture(scope="module")
def sky(tmp_path_factory):
    """Two days of a year, with sun."""
    folder = tmp_path_factory.mktemp("demo")
    write_demo(folder)
    year = sky_matrix(read_weather(folder / "723170TYA.CSV"), subdivision=1)
    return year.select(np.arange(4000, 4048))


def matrix(rng, rows, columns, channels, components):
    shape = channels, rows.size, columns.size
    noise = rng.normal(size=(components, *shape)).astype(np.float32) * 0.01
    return TransferMatrix(
        rng.uniform(size=shape), rows, columns, noise if components else None
    )


def shaded(rng, channels, states, view=4, daylight=4):
    inner, outer = (window_axis(side, BASIS, "w") for side in ("interior", "exterior"))
    return WindowMatrices(
        window_chain(
            matrix(rng, sensor_axis(SENSORS), inner, channels, view),
            [matrix(rng, inner, outer, 1, 0) for _ in range(states)],
            matrix(rng, outer, sky_axis(reinhart(1)), channels, daylight),
        )
    )


def stored(folder, windows):
    """The views of some windows in two files."""
    views = [w.whole.receiving[0] for w in windows]
    parts = [np.concatenate([view.values for view in views], axis=-1)]
    nothing = np.zeros((4, *views[0].values.shape))
    found = [view.components for view in views]
    parts.append(
        np.concatenate([nothing if part is None else part for part in found], axis=-1)
    )
    values, components = (part.astype(np.float32) for part in parts)

    def make(rows):
        columns = unknown_axis(values.shape[-1])
        axis = sensor_axis(rows.stop - rows.start)
        return TransferMatrix(values[:, rows], axis, columns, components[:, :, rows])

    blocks = (slice(0, 50), slice(50, SENSORS))
    return StoredViews(MatrixStore(folder).blocks("views", "0", blocks, make), blocks)


def in_files(folder, windows):
    """The same windows with their view matrices in files."""
    views, first, found = stored(folder, windows), 0, []
    for window in windows:
        columns = window.whole.receiving[0].columns
        view = StoredColumns(views, columns, first)
        T, D = zip(*window.whole.factors, strict=True)
        found.append(WindowMatrices(window_chain(view, T, D)))
        first += columns.size
    return found


def streamed(tmp_path, windows, sky, states):
    stored_windows = in_files(tmp_path / "views", windows)
    terms, file = (Term("three_phase", "whole"),), tmp_path / "lux.nc"
    illuminance(stored_windows, terms, Skies(sky), states, file=file).close()
    with h5py.File(file) as made:
        return made["illuminance"][...], made["standard_error"][...]


@pytest.mark.parametrize("channels", [1, 3])
@pytest.mark.parametrize(("view", "daylight"), [(4, 0), (0, 4)])
def test_one_window_streams_to_the_same_light_and_error(
    tmp_path, sky, channels, view, daylight
):
    """What only V or only D is uncertain about is known alike in both."""
    rng = np.random.default_rng(3)
    windows = [shaded(rng, channels, 2, view, daylight)]
    states = [np.arange(48) % 2]
    lux, error = streamed(tmp_path, windows, sky, states)
    whole = three_phase(windows, sky, states)
    scale = whole["illuminance"].values.max()
    assert np.allclose(lux, whole["illuminance"], rtol=1e-4, atol=1e-5 * scale)
    assert np.allclose(error, whole["standard_error"], rtol=1e-2, atol=1e-5 * scale)


def test_the_light_of_several_windows_adds_up(tmp_path, sky):
    """Errors of V and D are taken together: alike in the mean over sensors."""
    rng = np.random.default_rng(4)
    windows = [shaded(rng, 1, 3) for _ in range(3)]
    states = [(np.arange(48) + n) % 3 for n in range(3)]
    lux, error = streamed(tmp_path, windows, sky, states)
    whole = three_phase(windows, sky, states)
    scale = whole["illuminance"].values.max()
    assert np.allclose(lux, whole["illuminance"], rtol=1e-4, atol=1e-5 * scale)
    lit = whole["standard_error"].values > 0
    ratio = np.mean(error[lit] ** 2) / np.mean(whole["standard_error"].values[lit] ** 2)
    assert 0.5 < ratio < 2


def test_pooled_batches_keep_the_variance():
    """The mean of batches is a batch: the expected variance of the mean is the same."""
    rng = np.random.default_rng(5)
    batches = rng.normal(size=(16, 1, 1, 20000))
    spread = (batches - batches.mean(axis=0)) / np.sqrt(16 * 15)
    variance = np.square(pooled(spread, 4)).sum(axis=0).mean()
    assert variance == pytest.approx(1 / 16, rel=0.05)
    with pytest.raises(MatrixError, match="16 error components; a multiple of 5"):
        pooled(spread, 5)


def test_coefficients_of_some_sensors_come_from_their_blocks(tmp_path):
    window = shaded(np.random.default_rng(7), 3, 1)
    chosen = np.array([0, 7, 49, 50, 69])
    found = stored(tmp_path, [window]).of(chosen, slice(None))
    expected = window.whole.receiving[0].values[:, chosen]
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_views_of_other_windows_do_not_fit(tmp_path):
    window = shaded(np.random.default_rng(8), 1, 1)
    half = window_axis("interior", klems("half"), "w")
    view = StoredColumns(stored(tmp_path, [window]), half, 0)
    with pytest.raises(MatrixError, match="77 window patches"):
        window_chain(view, *zip(*window.whole.factors, strict=True))


def test_states_that_do_not_exist_are_refused(tmp_path, sky):
    windows = [shaded(np.random.default_rng(6), 1, 2)]
    with pytest.raises(MatrixError, match=r"shade states \[2\]; 0 to 1 expected"):
        streamed(tmp_path, windows, sky, [np.full(48, 2)])
