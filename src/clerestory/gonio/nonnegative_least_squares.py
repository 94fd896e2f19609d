"""Non-negative least squares from normal equations, by block principal pivoting.

All unknowns that violate the optimality conditions are exchanged together between the
free and the zero set. Without progress they are exchanged one at a time, which
guarantees termination. As most lobe fluxes are positive, a few linear solves suffice;
an active-set method that starts from zero would need one solve per lobe.

Reference: L. F. Portugal, J. J. Júdice, L. N. Vicente, "A comparison of block pivoting
and interior-point algorithms for linear least squares problems with nonnegative
variables", Mathematics of Computation 63, 1994.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy import linalg

# Number of block exchanges without progress before single exchanges.
_PATIENCE = 3

# Tolerance for negative values, relative to the largest absolute value of `target`.
_NEGATIVE = 1e-12


def non_negative(
    gram: Float[np.ndarray, "unknowns unknowns"], target: Float[np.ndarray, " unknowns"]
) -> Float[np.ndarray, " unknowns"]:
    """Return x ≥ 0 that minimizes xᵀ·gram·x/2 − targetᵀ·x.

    `gram`: symmetric and positive definite.

    >>> gram = np.array([[2.0, 1.0], [1.0, 2.0]])
    >>> non_negative(gram, np.array([2.0, -1.0])).round(9).tolist()
    [1.0, 0.0]
    """
    # Scale the unknowns so that the diagonal of the matrix is 1
    scale = 1 / np.sqrt(np.diag(gram))
    gram, target = gram * np.outer(scale, scale), target * scale
    least = _NEGATIVE * float(np.abs(target).max(initial=0))
    free = np.ones(len(target), dtype=bool)
    fewest, patience = len(target) + 1, _PATIENCE
    while True:
        found, pull = _solved(gram, target, free)
        wrong = np.where(free, found < -least, pull > least)
        count = int(wrong.sum())
        if not count:
            return np.asarray(np.maximum(found, 0) * scale)
        if count < fewest:
            fewest, patience = count, _PATIENCE
        elif patience:
            patience -= 1
        else:
            wrong[: np.flatnonzero(wrong)[-1]] = False
        free ^= wrong


def _solved(
    gram: Float[np.ndarray, "unknowns unknowns"],
    target: Float[np.ndarray, " unknowns"],
    free: Bool[np.ndarray, " unknowns"],
) -> tuple[Float[np.ndarray, " unknowns"], Float[np.ndarray, " unknowns"]]:
    # Solution for the free unknowns, and negative gradient with respect to all unknowns
    found = np.zeros(len(target))
    if np.any(free):
        factor = linalg.cho_factor(gram[np.ix_(free, free)], check_finite=False)
        found[free] = linalg.cho_solve(factor, target[free], check_finite=False)
    return found, target - gram[:, free] @ found[free]
