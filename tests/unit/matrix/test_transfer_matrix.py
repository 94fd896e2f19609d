"""Products of labelled matrices: values, refusals, and the errors they carry."""

import numpy as np
import pytest

from clerestory.bands import Bands
from clerestory.errors import MatrixError
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import (
    sensor_axis,
    sky_axis,
    time_axis,
    unknown_axis,
    window_axis,
)
from clerestory.matrix.transfer_matrix import TransferMatrix

RNG = np.random.default_rng(4)
KLEMS = klems("quarter")
INSIDE, OUTSIDE = (window_axis(side, KLEMS) for side in ("interior", "exterior"))
SENSORS, SKY = sensor_axis(3), sky_axis(reinhart(1))


def matrix(rows, columns, *, channels=3, components=0):
    shape = (channels, rows.size, columns.size)
    spread = RNG.normal(size=(components, *shape)) * 0.01 if components else None
    return TransferMatrix(RNG.random(shape), rows, columns, spread)


def test_products_are_numpys():
    """(V T D) by channel, a grey factor serving all three."""
    view, middle, sky = (
        matrix(SENSORS, INSIDE),
        matrix(INSIDE, OUTSIDE, channels=1),
        matrix(OUTSIDE, SKY),
    )
    product = view @ middle @ sky
    expected = np.einsum("cij,jk,ckl->cil", view.values, middle.values[0], sky.values)
    assert product.values == pytest.approx(expected)
    assert product.rows is SENSORS
    assert product.columns.kind == "sky"


def test_order_of_brackets_does_not_matter():
    """(V T) D = V (T D), values and errors."""
    view = matrix(SENSORS, INSIDE, components=4)
    middle = matrix(INSIDE, OUTSIDE)
    sky = matrix(OUTSIDE, SKY, components=3)
    left, right = (view @ middle) @ sky, view @ (middle @ sky)
    assert left.values == pytest.approx(right.values)
    assert left.standard_error == pytest.approx(right.standard_error)


def test_errors_of_a_product_are_those_of_repeated_trials():
    """Two noisy factors, multiplied 4000 times: the spread is the stated error."""
    a = matrix(sensor_axis(2), unknown_axis(5), channels=1, components=6)
    b = matrix(unknown_axis(5), unknown_axis(3), channels=1, components=6)
    stated = (a @ b).standard_error[0]
    trials = []
    for _ in range(4000):
        # Components are deviations of independent batches: sum them with random signs
        noise = [
            np.tensordot(RNG.normal(size=6), m.components[:, 0], axes=1) for m in (a, b)
        ]
        trials.append((a.values[0] + noise[0]) @ (b.values[0] + noise[1]))
    assert np.std(trials, axis=0) == pytest.approx(stated, rel=0.06)


def test_a_missing_bsdf_is_named():
    """V·D without a transmission matrix between them."""
    with pytest.raises(MatrixError, match=r"put the transmission matrix of a BSDF"):
        matrix(SENSORS, INSIDE) @ matrix(OUTSIDE, SKY)


@pytest.mark.parametrize(
    ("left", "right"),
    [
        (window_axis("interior", klems("full")), INSIDE),
        (
            window_axis("interior", KLEMS, "south"),
            window_axis("interior", KLEMS, "east"),
        ),
        (sky_axis(reinhart(2)), SKY),
        (SKY, time_axis(np.arange(146))),
        (unknown_axis(40), INSIDE),
    ],
)
def test_axes_that_differ_are_refused(left, right):
    """The message says what was found on either side."""
    with pytest.raises(MatrixError) as caught:
        matrix(SENSORS, left) @ matrix(right, unknown_axis(2))
    assert left.describe() in str(caught.value)
    assert right.describe() in str(caught.value)


def test_files_without_labels_fit_by_size():
    """A matrix file does not say what it holds."""
    product = matrix(SENSORS, unknown_axis(41)) @ matrix(OUTSIDE, SKY)
    assert product.values.shape == (3, 3, 146)


def test_windows_keep_their_name_through_a_bsdf():
    """A transmission matrix belongs to no window until it meets one."""
    view = matrix(SENSORS, window_axis("interior", KLEMS, "south"))
    through = view @ matrix(INSIDE, OUTSIDE)
    assert through.columns.window == "south"
    with pytest.raises(MatrixError, match="'east'"):
        through @ matrix(window_axis("exterior", KLEMS, "east"), SKY)


def test_illuminance_weighs_channels_as_radiance_does():
    """179 lm/W times 0.265, 0.670, 0.065."""
    times = time_axis(np.arange(2))
    values = np.array([[[1.0, 0]], [[0, 1]], [[2, 0]]])
    lux = TransferMatrix(values, sensor_axis(1), times).illuminance()
    assert lux["illuminance"].values == pytest.approx(
        np.array([[179 * (0.265 + 2 * 0.065), 179 * 0.670]])
    )


NINE = Bands(tuple(f"band {k}" for k in range(9)), tuple(np.arange(9.0)))


def in_nine(rows, columns):
    shape = (9, rows.size, columns.size)
    return TransferMatrix(RNG.random(shape), rows, columns, bands=NINE)


def test_products_in_nine_bands():
    """Each band is a product of its own; a grey factor serves all nine."""
    view, middle, sky = (
        in_nine(SENSORS, INSIDE),
        matrix(INSIDE, OUTSIDE, channels=1),
        in_nine(OUTSIDE, time_axis(np.arange(2))),
    )
    product = view @ middle @ sky
    expected = np.einsum("cij,jk,ckl->cil", view.values, middle.values[0], sky.values)
    assert product.values == pytest.approx(expected)
    assert product.bands == NINE
    lux = product.illuminance()["illuminance"].values
    assert lux == pytest.approx(np.tensordot(np.arange(9.0), expected, axes=1))


def test_other_bands_do_not_fit():
    """Nine bands times three are refused, and their sum."""
    with pytest.raises(MatrixError, match="red, green, blue"):
        in_nine(SENSORS, INSIDE) @ matrix(INSIDE, OUTSIDE)
    with pytest.raises(MatrixError, match="red, green, blue"):
        matrix(SENSORS, SKY) + in_nine(SENSORS, SKY)
    with pytest.raises(MatrixError, match="1 or 9 channels"):
        TransferMatrix(np.ones((3, 3, 146)), SENSORS, SKY, bands=NINE)


def test_sums_add_errors_of_independent_matrices():
    """Variances add."""
    a, b = (matrix(SENSORS, SKY, components=5) for _ in range(2))
    total = a + b
    assert total.values == pytest.approx(a.values + b.values)
    expected = np.hypot(a.standard_error, b.standard_error)
    assert total.standard_error == pytest.approx(expected)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_values_that_are_no_numbers_are_refused(bad):
    """One NaN would spread over a year of results."""
    values = np.ones((1, 3, 146))
    values[0, 1, 7] = bad
    with pytest.raises(MatrixError, match="not finite"):
        TransferMatrix(values, SENSORS, SKY)


def test_shapes_must_match_their_axes():
    """Rows and columns are counted on creation."""
    with pytest.raises(MatrixError, match="3 sensors by 146 sky patches"):
        TransferMatrix(np.ones((1, 4, 146)), SENSORS, SKY)
