"""Product rule for derivatives of matrices, and their errors.

    C = A·B   →   C_i = A_i·B + A·B_i
                  C_ij = A_ij·B + A_i·B_j + A_j·B_i + A·B_ij

Error components are multiplied like coefficients: those of C_i are, for each batch of
A, the deviation of A_i times B plus the deviation of A times B_i, and likewise for B.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.errors import MatrixError
from clerestory.matrix.derivatives import Derivatives, Parameter, pair_indices


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
        found: np.ndarray = of.second[of.pair(names[i], names[j])]
        return found

    def deviations(self, names: Sequence[str], i: int) -> np.ndarray | None:
        """Return the error components of a derivative; None if there are none."""
        of = self.derivatives
        if of is None or of.components is None or names[i] not in of.names:
            return None
        found: np.ndarray = of.components[:, of.number(names[i])]
        return found


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
    A, B = left.values, right.values
    of_left = [
        part @ matrix.astype(part.dtype)
        for part, matrix in (
            (left.deviations(names, i), B),
            (left.components, right.first(names, i)),
        )
        if part is not None and matrix is not None
    ]
    of_right = [
        matrix.astype(part.dtype) @ part
        for part, matrix in (
            (right.deviations(names, i), A),
            (right.components, left.first(names, i)),
        )
        if part is not None and matrix is not None
    ]
    if left.components is not None and not of_left:
        of_left = [np.zeros_like(left.components @ B.astype(left.components.dtype))]
    if right.components is not None and not of_right:
        of_right = [np.zeros_like(A.astype(right.components.dtype) @ right.components)]
    found = [sum(parts[1:], parts[0]) for parts in (of_left, of_right) if parts]
    return np.concatenate(found) if found else None


def sum_derivatives(
    one: Factor, other: Factor, shape: tuple[int, ...]
) -> Derivatives | None:
    """Return the derivatives of the sum of two independent matrices."""
    parameters = common_parameters([one.derivatives, other.derivatives])
    if not parameters:
        return None
    first: np.ndarray = np.zeros(())
    second, components = first, []
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
