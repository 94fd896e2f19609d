"""Product rule, labels and files of derivatives; their expansion in parameters."""

import numpy as np
import pytest

from clerestory.errors import ClerestoryError, InputError, MatrixError
from clerestory.matrix.axis import Axis
from clerestory.matrix.derivatives import Derivatives, Parameter, pair_indices
from clerestory.matrix.expansion import expanded, expanded_illuminance
from clerestory.matrix.netcdf import read_netcdf, write_netcdf
from clerestory.matrix.transfer_matrix import TransferMatrix

THETA = {"floor": 0.3, "wall": 0.5, "ground": 0.2}


def axis(size):
    """An axis without labels."""
    return Axis("unknown", size)


class Polynomial:
    """A matrix whose coefficients are polynomials of second order in parameters."""

    def __init__(self, rng, names, shape, batches=4):
        self.names, self.batches = names, batches
        pairs = len(pair_indices(len(names)))
        self.constant = rng.normal(size=(1 + batches, *shape))
        self.first = rng.normal(size=(1 + batches, len(names), *shape))
        self.second = rng.normal(size=(pairs, *shape))

    def at(self, theta):
        """Values, error components and gradients at parameters."""
        x = np.array([theta[name] for name in self.names])
        pairs = pair_indices(len(x))
        gradient = self.first.copy()
        value = self.constant + np.einsum("bp...,p->b...", self.first, x)
        for k, (i, j) in enumerate(pairs):
            half = 0.5 if i == j else 1.0
            value[0] += half * x[i] * x[j] * self.second[k]
            gradient[0, i] += x[j] * self.second[k]
            if i != j:
                gradient[0, j] += x[i] * self.second[k]
        return value, gradient

    def matrix(self, theta):
        """The matrix with its derivatives at parameters."""
        value, gradient = self.at(theta)
        parameters = tuple(
            Parameter(name, theta[name], "reflectance") for name in self.names
        )
        of = Derivatives(parameters, gradient[0], self.second, gradient[1:])
        axes = axis(value.shape[2]), axis(value.shape[3])
        return TransferMatrix(value[0], *axes, value[1:], derivatives=of)


def changed(name, step):
    return THETA | {name: THETA[name] + step}


@pytest.fixture
def factors():
    rng = np.random.default_rng(1)
    return (
        Polynomial(rng, ("floor", "wall"), (3, 2, 4)),
        Polynomial(rng, ("wall", "ground"), (1, 4, 5)),
    )


def compare(made, values_at):
    """Compare derivatives with differences of values and components."""
    h = 1e-3
    for name in made.derivatives.names:
        low, high = (values_at(changed(name, step)) for step in (-h, h))
        found = made.derivative(name)
        slope = (high.values - low.values) / (2 * h)
        assert np.allclose(found.values, slope, atol=1e-5)
        parts = (high.components - low.components) / (2 * h)
        assert np.allclose(found.components, parts, atol=1e-5)
    for one, other in made.derivatives.pairs:
        low, high = (values_at(changed(other, step)) for step in (-h, h))
        slope = (high.derivative(one).values - low.derivative(one).values) / (2 * h)
        assert np.allclose(made.second_derivative(one, other).values, slope, atol=1e-4)


def test_products_follow_the_product_rule(factors):
    """Differences of the products of changed matrices, and of their components."""

    def product(theta):
        return factors[0].matrix(theta) @ factors[1].matrix(theta)

    made = product(THETA)
    assert made.derivatives.names == ("floor", "wall", "ground")
    compare(made, product)


def test_products_with_matrices_without_derivatives(factors):
    rng = np.random.default_rng(2)
    plain = TransferMatrix(
        rng.normal(size=(3, 4, 4)), axis(4), axis(4), rng.normal(size=(2, 3, 4, 4))
    )
    compare(
        factors[0].matrix(THETA) @ plain @ factors[1].matrix(THETA),
        lambda theta: factors[0].matrix(theta) @ plain @ factors[1].matrix(theta),
    )


def test_sums_and_weighted_channels(factors):
    rng = np.random.default_rng(3)
    other = Polynomial(rng, ("ground",), (1, 2, 4))

    def total(theta):
        return (factors[0].matrix(theta) + other.matrix(theta)).weighted(
            np.array([1.0, 2.0, 3.0])
        )

    compare(total(THETA), total)
    rows = total(THETA).select_rows(slice(1, 2))
    whole = total(THETA).derivative("floor")
    assert np.array_equal(rows.derivative("floor").values, whole.values[:, 1:])


def test_matrices_of_different_scenes_are_refused(factors):
    other = factors[1].matrix(changed("wall", 0.1))
    with pytest.raises(MatrixError, match=r'by "wall" at 0\.5 and at 0\.6'):
        factors[0].matrix(THETA) @ other


def test_derivatives_of_another_shape_are_refused(factors):
    matrix = factors[0].matrix(THETA)
    of = matrix.derivatives
    with pytest.raises(MatrixError, match="expected"):
        Derivatives(of.parameters, of.first, of.second[:1])
    with pytest.raises(MatrixError, match="expected"):
        TransferMatrix(matrix.values[:1], axis(2), axis(4), derivatives=of)


def test_an_unknown_parameter_and_no_derivatives_are_named(factors):
    matrix = factors[0].matrix(THETA)
    with pytest.raises(InputError, match="door"):
        matrix.derivative("door")
    plain = TransferMatrix(matrix.values, axis(2), axis(4))
    with pytest.raises(MatrixError, match="without derivatives"):
        plain.derivative("wall")


def test_files_keep_derivatives(factors, tmp_path):
    matrix = factors[0].matrix(THETA)
    write_netcdf(tmp_path / "v.nc", matrix)
    found = read_netcdf(tmp_path / "v.nc").derivatives
    of = matrix.derivatives
    assert found.parameters == of.parameters
    for name in ("first", "second", "components"):
        assert np.array_equal(getattr(found, name), getattr(of, name))


def test_the_expansion_of_a_polynomial_of_second_order_is_exact():
    rng = np.random.default_rng(4)
    made = Polynomial(rng, tuple(THETA), (1, 3, 2))
    matrix = made.matrix(THETA)
    other = {"floor": 0.7, "wall": 0.1, "ground": 0.9}
    change = np.array([[other[n] - THETA[n] for n in THETA], [0, 0, 0]])
    of = matrix.derivatives
    found = expanded(matrix.values, of.first, of.second, change)
    assert np.allclose(found[0], made.matrix(other).values)
    assert np.allclose(found[1], matrix.values)


def test_illuminance_is_expanded_in_blocks_of_sensors(factors):
    matrix = factors[0].matrix(THETA)
    data = matrix.illuminance()
    draws = np.array([[0.3, 0.5], [0.4, 0.2]])
    blocks = list(expanded_illuminance(data, draws, least=None))
    found = np.concatenate([lux for _, lux in blocks], axis=1)
    assert np.allclose(found[0], data["illuminance"].values)
    expected = factors[0].matrix({"floor": 0.4, "wall": 0.2}).illuminance()
    assert np.allclose(found[1], expected["illuminance"].values)
    with pytest.raises(ClerestoryError, match="expected"):
        list(expanded_illuminance(data, draws[:, :1]))
    with pytest.raises(InputError, match="no derivatives"):
        list(expanded_illuminance(data[["illuminance"]], draws))
