"""Range of the fixed-point sums, and probabilities of zero."""

import numpy as np
import pytest

from clerestory.engine.device import load


@pytest.fixture
def sinks():
    return load("cpu", "sinks")


@pytest.mark.parametrize("value", [-1e-3, -1.0, -1e9, 3000.0, np.nan, np.inf])
def test_weights_out_of_range_are_counted_and_not_added(sinks, value):
    import drjit as dr
    import mitsuba as mi

    sink = sinks.MatrixSink(dr.zeros(mi.UInt64, 3), 2, 1, mi.UInt32(0))
    sink.add(None, mi.UInt32(1), mi.Color3f(value), mi.Bool(True))
    assert sink.sums.numpy().tolist() == [1, 0, 0]


def test_weights_in_range_are_added(sinks):
    import drjit as dr
    import mitsuba as mi

    sink = sinks.MatrixSink(dr.zeros(mi.UInt64, 3), 2, 1, mi.UInt32(0))
    for value in (0.0, 0.7, 1e-6):
        sink.add(None, mi.UInt32(1), mi.Color3f(value), mi.Bool(True))
    heavy, first, second = sink.sums.numpy().tolist()
    assert (heavy, first) == (0, 0)
    assert second / sinks.FIXED_POINT == pytest.approx(0.700001, rel=1e-7)


@pytest.mark.parametrize("channels", [1, 3, 7, 8, 9, 20, 81])
def test_sums_of_many_paths_are_exact(sinks, channels):
    """Single sums, and packets of eight, of which some are unused."""
    import mitsuba as mi

    random = np.random.default_rng(channels)
    paths, columns, places = 5000, 7, 21
    slot, column = random.integers(0, 3, paths), random.integers(0, columns, paths)
    weight = random.integers(0, 1 << 20, (channels, paths)) / (1 << 20)
    kept = random.random(paths) < 0.8
    weight[0, :10], kept[:10] = 5000.0, True  # out of range
    sums = sinks.empty_sums(places, channels)
    sink = sinks.MatrixSink(sums, columns, channels, mi.UInt32(slot))
    value = [mi.Float(one.astype(np.float32)) for one in weight]
    sink.add(None, mi.UInt32(column), value, mi.Bool(kept))
    found = sink.sums.numpy()
    assert found[0] == 10
    kept[:10] = False
    expected = np.zeros((places, channels))
    np.add.at(expected, (slot * columns + column)[kept], weight.T[kept])
    sums = sinks.by_place(found, places, channels) / sinks.FIXED_POINT
    np.testing.assert_array_equal(sums, expected)


def test_a_cell_without_probabilities_samples_no_portal():
    """Its density is zero for every direction: no direction may be drawn from it."""
    portals = load("cpu", "portals")
    cells = load("cpu", "guiding_cells").GuidingCells.around(np.zeros((0, 3)))
    import mitsuba as mi

    one = portals.Rectangles(
        np.array([[-1.0, -1, 2]]), np.array([[2.0, 0, 0]]), np.array([[0, 2.0, 0]])
    )
    shares = np.ones((cells.count, 1))
    made = portals.Portals.of(one, cells, shares, 0 * shares, np.full(cells.count, 0.3))
    origin, cell, u = mi.Point3f(0), mi.UInt32(0), mi.Float([0.1, 0.6, 0.9])
    for table, expected in ((made.share, True), (made.sunlit, False)):
        direction, valid = made.sample(table, origin, cell, u, u)
        onward, sunlit = made.pdf(origin, cell, direction, mi.Bool(True))
        assert (valid & mi.Bool([True] * 3)).numpy().tolist() == [expected] * 3
        density = (onward if expected else sunlit).numpy()
        assert bool(np.all(density > 0)) == expected
