"""Tables are interpolated as Radiance interpolates them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clerestory.errors import InputError
from clerestory.radiance.data_array import DataArray, read_data_array


def test_two_axes_are_bilinear(tmp_path):
    """f = 2x + 3y + xy is its own bilinear interpolation."""
    (tmp_path / "t.dat").write_text(
        "2\n0 4 5\n0 0 3\n1 2 5\n"
        + " ".join(str(2 * x + 3 * y + x * y) for x in range(5) for y in (1, 2, 5))
    )
    table = read_data_array(tmp_path / "t.dat")
    at = np.array([[0.5, 1.5], [3.25, 4.0], [0.0, 1.0], [4.0, 5.0]])
    expected = 2 * at[:, 0] + 3 * at[:, 1] + at[:, 0] * at[:, 1]
    np.testing.assert_allclose(table.value(at), expected)


def test_falling_axes_are_read():
    table = DataArray((np.array([3.0, 2.0, 0.0]),), np.array([30.0, 20.0, 0.0]))
    np.testing.assert_allclose(table.value(np.array([[2.5], [1.0]])), [25, 10])


def test_beyond_the_ends_values_go_on_and_fall_off():
    """One interval straight, then over the distance (Radiance, data.c)."""
    table = DataArray((np.array([0.0, 1.0]),), np.array([1.0, 2.0]))
    at = np.array([[-0.5], [1.5], [-3.0], [4.0]])
    np.testing.assert_allclose(table.value(at), [0.5, 2.5, 0.0 / 3, 3.0 / 5])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file ends after 0 of 1 number of axes"),
        ("9", "number of axes is 9"),
        ("1 0 1 3 1 2", "ends after 2 of 3 values"),
        ("1 0 0 3 1 2 2 1 2 3", "out of order"),
        ("1 0 1 two", "not a data file"),
        ("2 0 1 99999999 0 1 99999999", "number of positions on an axis is 1e\\+08"),
        ("1 0 1 2 1 nan", "is nan"),
    ],
)
def test_broken_tables_are_refused(tmp_path, text, message):
    (tmp_path / "t.dat").write_text(text)
    with pytest.raises(InputError, match=message):
        read_data_array(tmp_path / "t.dat")


@settings(max_examples=100, deadline=None)
@given(st.lists(st.sampled_from(["0", "1", "2", "-3", "1e9", "x", "nan", "."])))
def test_any_words_are_read_or_refused(tmp_path_factory, words):
    file = tmp_path_factory.getbasetemp() / "any.dat"
    file.write_text(" ".join(words))
    try:
        table = read_data_array(file)
        table.value(np.zeros((2, len(table.axes))))
    except InputError as error:
        message = str(error)
    else:
        message = ""
    assert "\n" not in message
