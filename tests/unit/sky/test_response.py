"""Products with the sky against the dense product in double precision."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory.bands import GREY, RGB, Bands
from clerestory.errors import MatrixError
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import sensor_axis, sky_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.sky import sky_product
from clerestory.sky.sky_matrix import sky_matrix

LUX = RGB.weights


def transfer(channels=3, rows=7, layers=4, subdivision=1, bands=RGB):
    random = np.random.default_rng(3)
    sky = sky_axis(reinhart(subdivision))
    shape = (channels, rows, sky.size)
    return TransferMatrix(
        random.random(shape),
        sensor_axis(rows),
        sky,
        0.01 * random.normal(size=(layers, *shape)) if layers else None,
        bands,
    )


@pytest.fixture
def sky(spring_day):
    return sky_matrix(spring_day, subdivision=1, ground_reflectance=(0.1, 0.2, 0.3))


@pytest.mark.parametrize("channels", [1, 3])
def test_illuminance_equals_the_dense_product(sky, channels):
    left = transfer(channels)
    values = np.broadcast_to(left.values, (3, *left.values.shape[1:]))
    expected = np.einsum("c,crp,cpt->rt", LUX, values, sky.values.astype(float))
    result = (left @ sky).illuminance()
    np.testing.assert_allclose(result["illuminance"], expected, rtol=1e-6)
    np.testing.assert_array_equal(result["time"], sky.times)


def test_the_standard_error_equals_the_dense_one(sky):
    left = transfer()
    spread = np.einsum(
        "c,kcrp,cpt->krt", LUX, left.components, sky.values.astype(float)
    )
    expected = np.sqrt(np.sum(spread**2, axis=0))
    result = (left @ sky).illuminance()
    np.testing.assert_allclose(result["standard_error"], expected, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("bands", [1, 9])
@pytest.mark.parametrize("channels", [1, 9])
def test_skies_of_other_bands_equal_the_dense_product(sky, bands, channels):
    """A sky or a transfer matrix of one channel is the same in all nine bands."""
    nine = Bands(tuple(f"band {k}" for k in range(9)), tuple(np.arange(9.0)))
    colour = np.random.default_rng(8).random((bands, len(sky.partition)))
    own = nine if bands == 9 else GREY
    sky = replace(sky, colour=colour, sun_colour=colour[:, 3], bands=own)
    left = transfer(channels, bands=nine)
    dense = left @ sky.to_transfer_matrix()
    lazy = (left @ sky).rgb()
    assert lazy.bands == dense.bands
    np.testing.assert_allclose(lazy.values, dense.values, rtol=1e-6)
    for name, lux in (left @ sky).illuminance().items():
        np.testing.assert_allclose(lux, dense.illuminance()[name], rtol=1e-5)


def test_small_blocks_give_the_same(sky, monkeypatch):
    left = transfer()
    whole = (left @ sky).illuminance()
    monkeypatch.setattr(sky_product, "_BLOCK", 1500)
    parts = (left @ sky).illuminance()
    for name in whole:
        np.testing.assert_allclose(whole[name], parts[name], rtol=1e-6)


def test_rgb_equals_the_product_of_plain_matrices(sky):
    left = transfer()
    dense = left @ sky.to_transfer_matrix()
    lazy = (left @ sky).rgb()
    np.testing.assert_allclose(lazy.values, dense.values, rtol=1e-6)
    np.testing.assert_allclose(lazy.standard_error, dense.standard_error, rtol=1e-5)
    np.testing.assert_allclose(
        dense.illuminance()["illuminance"],
        (left @ sky).illuminance()["illuminance"],
        rtol=1e-6,
    )


def test_a_matrix_without_error_gives_none(sky):
    result = (transfer(layers=0) @ sky).illuminance()
    assert not result["standard_error"].any()


def test_an_open_sensor_reads_the_weather(spring_day):
    """Transfer of an unobstructed level sensor is the projected solid angle."""
    grey = sky_matrix(spring_day, subdivision=4, sky_colour=(1, 1, 1), include="sky")
    projected = np.append(0, grey.partition.dome.projected_solid_angles())
    left = TransferMatrix(
        np.broadcast_to(projected, (3, 1, len(projected))), sensor_axis(1), grey.rows
    )
    lux = (left @ grey).illuminance()["illuminance"].to_numpy()[0]
    radiation = sky_matrix(
        spring_day, subdivision=4, sky_colour=(1, 1, 1), include="sky", spectrum="solar"
    )
    watts = projected @ radiation.diffuse
    efficacy = lux[watts > 20] / watts[watts > 20]
    np.testing.assert_allclose(watts, spring_day.diffuse_horizontal, rtol=1e-5)
    assert np.all((efficacy > 90) & (efficacy < 180))


def test_a_sky_that_does_not_fit_is_refused(sky):
    with pytest.raises(MatrixError, match="MF:2"):
        transfer(subdivision=2) @ sky
    with pytest.raises(TypeError):
        np.zeros((2, 146)) @ sky
