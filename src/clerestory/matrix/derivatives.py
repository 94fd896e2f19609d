"""Derivatives of transfer matrices with respect to parameters of materials.

A parameter scales the colour of a material; its value is the photometric mean of the
colour. Derivatives pass through products and sums of matrices by the product rule:

    C = A·B   →   C_i = A_i·B + A·B_i
                  C_ij = A_ij·B + A_i·B_j + A_j·B_i + A·B_ij
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np
from jaxtyping import Float

from clerestory.argument_types import checked_fields
from clerestory.bands import weighted_sum
from clerestory.brief_repr import brief
from clerestory.checks import distinct, has_shape, one_of
from clerestory.errors import MatrixError

Quantity = Literal["reflectance", "transmissivity", "scale"]


@checked_fields
@dataclass(frozen=True)
class Parameter:
    """A number that a scene depends on: the colour of a material, scaled.

    Attributes
    ----------
    name : name of the material
    value : photometric mean of the colour of the material, at which derivatives are
        taken; 1 if the parameter is a scale of all that the material scatters
    quantity : what the value is
    """

    name: str
    value: float
    quantity: Quantity


@checked_fields
@dataclass(frozen=True, eq=False)
class Derivatives:
    """First and second derivatives of a transfer matrix, by parameter.

    Attributes
    ----------
    parameters : parameters, in the order of `first`
    first : derivatives per unit of each parameter
    second : derivatives for each pair of parameters, in the order of `pairs`
    components : error components of `first`, from the same batches as those of the
        matrix; None without statistical error
    """

    parameters: tuple[Parameter, ...]
    first: Float[np.ndarray, "parameter channel row column"]
    second: Float[np.ndarray, "pair channel row column"]
    components: Float[np.ndarray, "component parameter channel row column"] | None = (
        None
    )

    __repr__ = brief

    def __post_init__(self) -> None:
        distinct(self.names, "parameters")
        count, shape = len(self.parameters), self.first.shape[1:]
        check = partial(has_shape, error=MatrixError)
        check(self.first, (count, *shape), "array of derivatives")
        pairs = len(pair_indices(count))
        check(self.second, (pairs, *shape), "array of second derivatives")
        if self.components is not None:
            expected = len(self.components), count, *shape
            check(self.components, expected, "array of error components")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Names of the parameters of each second derivative."""
        names = self.names
        return tuple((names[i], names[j]) for i, j in pair_indices(len(names)))

    def number(self, name: str) -> int:
        """Return the index of a parameter."""
        one_of(name, "parameter", choices=list(self.names))
        return self.names.index(name)

    def pair(self, one: str, other: str) -> int:
        """Return the index of a pair of parameters in `second`."""
        i, j = sorted((self.number(one), self.number(other)))
        return pair_indices(len(self.parameters)).index((i, j))

    def with_parameters(self, parameters: Sequence[Parameter]) -> "Derivatives":
        """Return the derivatives for other parameters; those not known are zero."""
        if tuple(parameters) == self.parameters:
            return self
        names, shape = [each.name for each in parameters], self.first.shape[1:]
        first = np.zeros((len(names), *shape), self.first.dtype)
        pairs = pair_indices(len(names))
        second = np.zeros((len(pairs), *shape), self.second.dtype)
        components = self.components
        if components is not None:
            empty = len(components), len(names), *shape
            components = np.zeros(empty, components.dtype)
        for i, name in enumerate(names):
            if name not in self.names:
                continue
            first[i] = self.first[self.number(name)]
            if components is not None and self.components is not None:
                components[:, i] = self.components[:, self.number(name)]
        for k, (i, j) in enumerate(pairs):
            if {names[i], names[j]} <= set(self.names):
                second[k] = self.second[self.pair(names[i], names[j])]
        return Derivatives(tuple(parameters), first, second, components)

    def rows(self, rows: slice) -> "Derivatives":
        """Return the derivatives of a range of rows."""
        parts = self.components
        return replace(
            self,
            first=self.first[:, :, rows],
            second=self.second[:, :, rows],
            components=None if parts is None else parts[:, :, :, rows],
        )

    def columns(self, columns: slice) -> "Derivatives":
        """Return the derivatives of a range of columns."""
        parts = self.components
        return replace(
            self,
            first=self.first[..., columns],
            second=self.second[..., columns],
            components=None if parts is None else parts[..., columns],
        )

    def weighted(self, weights: Float[np.ndarray, " band"]) -> "Derivatives":
        """Return the derivatives of a weighted sum of the channels."""
        parts = self.components
        if parts is not None:
            parts = weighted_sum(parts, weights, axis=2)[:, :, None]
        return replace(
            self,
            first=weighted_sum(self.first, weights, axis=1)[:, None],
            second=weighted_sum(self.second, weights, axis=1)[:, None],
            components=parts,
        )


def pair_indices(count: int) -> list[tuple[int, int]]:
    """Return the pairs (i, j) with i ≤ j of parameters, in the order of storage.

    >>> pair_indices(2)
    [(0, 0), (0, 1), (1, 1)]
    """
    return [(i, j) for i in range(count) for j in range(i, count)]


@dataclass(frozen=True, eq=False)
class Factor:
    """Arrays of a matrix: coefficients, error components and derivatives."""

    values: Float[np.ndarray, "channel row column"]
    components: Float[np.ndarray, "component channel row column"] | None
    derivatives: Derivatives | None

    def first(self, names: Sequence[str], i: int) -> np.ndarray | None:
        """Return the derivative by parameter i of a list; None if it is zero."""
        of = self.derivatives
        return of.first[of.number(names[i])] if of and names[i] in of.names else None

    def second(self, names: Sequence[str], i: int, j: int) -> np.ndarray | None:
        """Return a second derivative; None if it is zero."""
        of = self.derivatives
        if of is None or not {names[i], names[j]} <= set(of.names):
            return None
        return of.second[of.pair(names[i], names[j])]

    def deviations(self, names: Sequence[str], i: int) -> np.ndarray | None:
        """Return the error components of a derivative; None if there are none."""
        of = self.derivatives
        if of is None or of.components is None or names[i] not in of.names:
            return None
        return of.components[:, of.number(names[i])]


def product_derivatives(left: Factor, right: Factor) -> Derivatives | None:
    """Return the derivatives of a matrix product, by the product rule."""
    parameters = common_parameters([left.derivatives, right.derivatives])
    if not parameters:
        return None
    names = [each.name for each in parameters]
    A, B = left.values, right.values
    shape = np.broadcast_shapes((*A.shape[:2], 1), (B.shape[0], 1, B.shape[2]))

    def total(*terms: tuple[np.ndarray | None, np.ndarray | None]) -> np.ndarray:
        found = [a @ b for a, b in terms if a is not None and b is not None]
        return sum(found[1:], found[0]) if found else np.zeros(shape)

    first = [
        total((left.first(names, i), B), (A, right.first(names, i)))
        for i in range(len(names))
    ]
    second = [
        total(
            (left.second(names, i, j), B),
            (A, right.second(names, i, j)),
            (left.first(names, i), right.first(names, j)),
            (left.first(names, j), right.first(names, i)),
        )
        for i, j in pair_indices(len(names))
    ]
    parts = [_components(left, right, names, i) for i in range(len(names))]
    components = None if parts[0] is None else np.stack(parts, axis=1)  # type: ignore[arg-type]
    return Derivatives(parameters, np.stack(first), np.stack(second), components)


def _components(
    left: Factor, right: Factor, names: Sequence[str], i: int
) -> np.ndarray | None:
    # Error components of a derivative of a product, in the order of those of the
    # product: deviations of the left matrix, then of the right matrix
    found = []
    of_left = (left.deviations(names, i), right.values), (
        left.components,
        right.first(names, i),
    )
    of_right = (right.deviations(names, i), left.values), (
        right.components,
        left.first(names, i),
    )
    for terms, order in ((of_left, 1), (of_right, -1)):
        parts = [
            np.matmul(*(deviation, matrix.astype(deviation.dtype))[::order])
            for deviation, matrix in terms
            if deviation is not None and matrix is not None
        ]
        own = (left if order == 1 else right).components
        if parts:
            found.append(sum(parts[1:], parts[0]))
        elif own is not None:
            shape = np.matmul(*(own[:1], (right, left)[order < 0].values)[::order])
            found.append(np.zeros((len(own), *shape.shape[1:]), own.dtype))
    return np.concatenate(found) if found else None


def sum_derivatives(
    one: Factor, other: Factor, shape: tuple[int, ...]
) -> Derivatives | None:
    """Return the derivatives of the sum of two independent matrices."""
    parameters = common_parameters([one.derivatives, other.derivatives])
    if not parameters:
        return None
    first, second, components = 0.0, 0.0, []
    for part in (one, other):
        own, parts = part.derivatives, part.components
        if own is not None:
            own = own.with_parameters(parameters)
            first, second = first + own.first, second + own.second
        if own is not None and own.components is not None:
            components.append(own.components)
        elif parts is not None:
            empty = len(parts), len(parameters), *parts.shape[1:]
            components.append(np.zeros(empty, parts.dtype))
    whole = len(parameters), *shape
    pieces = [np.broadcast_to(part, (len(part), *whole)) for part in components]
    return Derivatives(
        parameters,
        np.broadcast_to(first, whole),
        np.broadcast_to(second, (len(pair_indices(len(parameters))), *shape)),
        np.concatenate(pieces) if pieces else None,
    )


def common_parameters(
    found: Sequence[Derivatives | None],
) -> tuple[Parameter, ...]:
    """Return all parameters of several matrices, each once."""
    every: dict[str, Parameter] = {}
    for derivatives in found:
        for parameter in derivatives.parameters if derivatives else ():
            known = every.setdefault(parameter.name, parameter)
            if known != parameter:
                raise MatrixError(
                    f'derivatives by "{known.name}" at {known.value:g} and at'
                    f" {parameter.value:g}; derivatives of the same scene expected"
                )
    return tuple(every.values())
