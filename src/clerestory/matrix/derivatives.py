"""Derivatives of transfer matrices with respect to parameters of materials.

A parameter scales the colour of a material; its value is the photometric mean of the
colour.
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
