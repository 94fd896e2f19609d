"""Derivatives of illuminance with respect to parameters of materials, over time.

The matrix equation is linear in each matrix. A derivative of V T D S is therefore the
same product with V replaced by its derivative, plus the product with D replaced by its
derivative (product rule). Derivatives of V are further receivers of one product.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.checks import one_of
from clerestory.errors import MatrixError
from clerestory.matrix.axis import sensor_axis
from clerestory.matrix.derivatives import (
    Parameter,
    pair_indices,
)
from clerestory.matrix.error_components import UNIT, compressed
from clerestory.matrix.expansion import labelled_derivatives
from clerestory.matrix.product_rule import common_parameters
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.illuminance import PARTS, illuminance
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Receiving,
    Skies,
    States,
    Term,
    WindowMatrices,
    chains,
)
from clerestory.phases.recent_values import RecentValues

# Derivative to take of a matrix: none, by one parameter, or by two
_Order = tuple[str, ...]


def parameters_of(
    windows: Sequence[WindowMatrices], terms: Sequence[Term]
) -> tuple[Parameter, ...]:
    """Return the parameters by which some matrix of the terms is differentiated."""
    return common_parameters(
        [
            matrix.derivatives
            for term in terms
            for chain in chains(windows, term.part)
            for matrix in (*chain.receiving, *(m for f in chain.factors for m in f))
            if isinstance(matrix, TransferMatrix)
        ]
    )


def illuminance_derivatives(
    windows: Sequence[WindowMatrices],
    terms: Sequence[Term],
    skies: Skies,
    states: States | None = None,
    *,
    weights: Float[np.ndarray, " band"] | None = None,
    second: Literal["all", "own", "none"] = "all",
) -> xr.Dataset:
    """Derivatives of the illuminance of sensors by parameters of materials.

    The shade states are held constant.

    Parameters
    ----------
    second : second derivatives to compute: by all pairs of parameters, or by each
        parameter alone

    Returns
    -------
    `illuminance_derivative` and `illuminance_derivative_error` [lux per unit of the
    parameter] over (parameter, sensor, time); `derivative_components`, the error
    components in units of the error / 127, over (parameter, sensor, component, time);
    `illuminance_second_derivative` over (pair, sensor, time); `parameter_value`

    Raises
    ------
    MatrixError : no matrix has derivatives
    """
    one_of(second, "second derivatives", choices=("all", "own", "none"))
    parameters = parameters_of(windows, terms)
    if not parameters:
        message = "no matrix has derivatives; matrices traced with `derivatives`"
        raise MatrixError(f"{message} expected")
    names = [parameter.name for parameter in parameters]
    product = _Products(windows, terms, skies, states, weights, RecentValues())

    # Receivers that are derivatives, each with the undifferentiated factors
    total = product.of([(name,) for name in names], ())
    for number, name in enumerate(names):
        if product.varies((name,)):
            total.add(number, product.of([()], (name,)), 0)
    pairs = {"all": pair_indices(len(names)), "none": []}.get(
        second, [(i, i) for i in range(len(names))]
    )
    parts = [compressed(each.transpose(1, 0, 2)) for each in total.parts]
    return labelled_derivatives(
        parameters,
        total.values,
        total.error,
        product.of_pairs([(names[i], names[j]) for i, j in pairs]) if pairs else None,
        times=skies.times,
        parts=np.stack(parts),
        pairs=pairs,
    )


@dataclass(eq=False)
class _Sum:
    # Illuminance (order, sensor, time), its variance, and its eight error components
    values: np.ndarray
    error: np.ndarray
    parts: np.ndarray

    def add(self, number: int, other: "_Sum", at: int) -> None:
        """Add an entry of another sum, from the same batches."""
        self.values[number] += other.values[at]
        self.parts[number] += other.parts[at]
        self.error[number] = np.sqrt(np.square(self.parts[number]).sum(axis=1))


@dataclass(frozen=True, eq=False)
class _Products:
    windows: Sequence[WindowMatrices]
    terms: Sequence[Term]
    skies: Skies
    states: States | None
    weights: Float[np.ndarray, " band"] | None
    recent: RecentValues

    def of_pairs(
        self, pairs: Sequence[tuple[str, str]]
    ) -> Float[np.ndarray, "pair sensor time"]:
        """Return the second derivatives by pairs of parameters."""
        found = self.of(pairs, (), errors=False).values
        for number, pair in enumerate(pairs):
            for own, other in (pair, pair[::-1]):
                if self.varies((own,)):
                    found[number] += self.of([(other,)], (own,), errors=False).values[0]
            if self.varies(pair):
                found[number] += self.of([()], pair, errors=False).values[0]
        return found

    def varies(self, order: _Order) -> bool:
        """Whether a derivative of T, F or D is not zero."""
        return any(
            _derivative(matrix, order) is not None
            for term in self.terms
            for chain in chains(self.windows, term.part)
            for factors in chain.factors
            for matrix in factors
        )

    def of(
        self, receiving: Sequence[_Order], factors: _Order, *, errors: bool = True
    ) -> _Sum:
        """Return the products of derivatives of receivers and of other factors."""
        terms = [term for term in self.terms if self._differs(term, receiving, factors)]
        axis = chains(self.windows, self.terms[0].part)[0].receivers
        assert axis is not None
        shape = len(receiving), axis.size, len(self.skies.times)
        if not terms:
            zero = np.zeros(shape, np.float32)
            return _Sum(zero, zero.copy(), np.zeros((*shape[:2], 8, shape[2]), "f4"))
        windows = [self._window(w, terms, receiving, factors) for w in self.windows]
        found = illuminance(
            windows, terms, self.skies, self.states, weights=self.weights,
            recent=self.recent, errors=errors,
        )  # fmt: skip
        lux = found["illuminance"].values.reshape(shape)
        error = found["standard_error"].values.reshape(shape)
        parts = found[PARTS].values.reshape(*shape[:2], -1, shape[2])
        return _Sum(lux, error, parts * (error[:, :, None] / np.float32(UNIT)))

    def _differs(
        self, term: Term, receiving: Sequence[_Order], factors: _Order
    ) -> bool:
        # Whether the derivative of a term is not zero
        return any(
            _derivative(matrix, order) is not None
            for order in receiving
            for chain in chains(self.windows, term.part)
            for matrix in chain.receiving
        ) and (not factors or self.varies(factors))

    def _window(
        self,
        window: WindowMatrices,
        terms: Sequence[Term],
        receiving: Sequence[_Order],
        factors: _Order,
    ) -> WindowMatrices:
        parts = {
            term.part: _chain(getattr(window, term.part), receiving, factors)
            for term in terms
        }
        return WindowMatrices(**{"whole": None, **parts})


def _chain(
    chain: MatrixChain, receiving: Sequence[_Order], factors: _Order
) -> MatrixChain:
    # Matrices of which the receivers, and one factor after the other, are derivatives
    seen = tuple(_stacked(matrix, receiving) for matrix in chain.receiving)

    def state(matrices: tuple[TransferMatrix, ...]) -> tuple[TransferMatrix, ...]:
        if not factors:
            return tuple(replace(m, derivatives=None) for m in matrices)
        # T has no derivatives: the last factor is D, or F D
        *first, last = (replace(m, derivatives=None) for m in matrices)
        found = _derivative(matrices[-1], factors)
        return (*first, found if found is not None else _zero(last))

    return MatrixChain(seen, tuple(state(each) for each in chain.factors))


def _stacked(matrix: Receiving, orders: Sequence[_Order]) -> TransferMatrix:
    # Derivatives of a receiving matrix, one below the other
    assert isinstance(matrix, TransferMatrix)
    found = [_derivative(matrix, order) or _zero(matrix) for order in orders]
    values = np.concatenate([each.values for each in found], axis=1)
    parts = [
        np.zeros((1, *each.values.shape), np.float32)
        if each.components is None
        else each.components
        for each in found
    ]
    most = max(map(len, parts))
    parts = [_padded(part, most) for part in parts]
    return replace(
        matrix,
        values=values,
        rows=sensor_axis(values.shape[1]),
        components=np.concatenate(parts, axis=2),
        derivatives=None,
    )


def _padded(components: np.ndarray, count: int) -> np.ndarray:
    missing = count - len(components)
    return np.pad(components, [(0, missing), *[(0, 0)] * 3])


def _derivative(matrix: Receiving, order: _Order) -> TransferMatrix | None:
    # A matrix or its derivative; None if the derivative is zero
    if not isinstance(matrix, TransferMatrix):
        return None
    if not order:
        return replace(matrix, derivatives=None)
    known = matrix.derivatives
    if known is None or not set(order) <= set(known.names):
        return None
    found = (
        matrix.derivative(*order)
        if len(order) == 1
        else matrix.second_derivative(*order)
    )
    return found if np.any(found.values) else None


def _zero(matrix: TransferMatrix) -> TransferMatrix:
    return replace(
        matrix, values=np.zeros_like(matrix.values), components=None, derivatives=None
    )
