"""Files of fits give the same function again, and damage is seen."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.fit_storage import read_fits, write_fits
from clerestory.gonio.fitted_measurement import Fitted


@pytest.fixture(scope="module")
def written(tmp_path_factory, pane_fit, film_fit):
    path = tmp_path_factory.mktemp("fits") / "layer.nc"
    other = Fitted(
        pane_fit.interpolant, "reflection_front", "cie-x", "glass", pane_fit.options
    )
    write_fits(path, [film_fit, other])
    return path


def test_a_file_gives_the_same_values(written, film_fit, pane_fit):
    fits = {fit.function: fit for fit in read_fits(written)}
    source = from_degrees(np.array([12.0, 33]), np.array([10.0, 200])) * [1, 1, -1]
    exits = from_degrees(np.array([12.0, 33]), np.array([190.0, 20]))
    for fit, function in (
        (film_fit, "transmission_front"),
        (pane_fit, "reflection_front"),
    ):
        assert np.array_equal(
            fits[function].interpolant.evaluate(source, exits),
            fit.interpolant.evaluate(source, exits),
        )
    other = fits["reflection_front"]
    assert (other.name, other.channel, other.options) == (
        "glass",
        "cie-x",
        pane_fit.options,
    )


@pytest.mark.parametrize("where", [0.1, 0.5, 0.9])
def test_a_flipped_bit_is_seen(written, tmp_path, where):
    data = bytearray(written.read_bytes())
    data[int(where * len(data))] ^= 1
    path = tmp_path / "damaged.nc"
    path.write_bytes(data)
    with pytest.raises(InputError, match="damaged") as error:
        read_fits(path)
    assert str(error.value).startswith(str(path))


def test_half_a_file_is_refused(written, tmp_path):
    path = tmp_path / "half.nc"
    path.write_bytes(written.read_bytes()[:1000])
    with pytest.raises(InputError, match="damaged"):
        read_fits(path)
