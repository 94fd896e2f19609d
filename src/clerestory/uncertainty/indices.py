"""Sobol' indices: shares of a variance that are due to each unknown quantity.

The first-order index is the share of the variance that would vanish if a quantity were
known; the total index is the share that remains if it alone were unknown, with all
effects in combination with others.

References: I. M. Sobol', "Global sensitivity indices for nonlinear mathematical models
and their Monte Carlo estimates", Mathematics and Computers in Simulation 55, 2001;
estimators of A. Saltelli et al., 2010, as in `scipy.stats.sobol_indices`.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy
from jaxtyping import Float

from clerestory.uncertainty.draws import Draws


class Indices(NamedTuple):
    """Sobol' indices over (figure, group), with their standard errors."""

    first: Float[np.ndarray, "figure group"]
    total: Float[np.ndarray, "figure group"]
    first_error: Float[np.ndarray, "figure group"]
    total_error: Float[np.ndarray, "figure group"]


def sobol_indices(
    draws: Draws,
    figures: Callable[[Float[np.ndarray, "draw unknown"]], np.ndarray],
    *,
    known: Float[np.ndarray, "figure both"] | None = None,
) -> Indices:
    """Return the Sobol' indices of figures of merit.

    Parameters
    ----------
    draws : draws of the unknown quantities
    figures : function of draws over (draw, unknown) that returns (figure, draw)
    known : figures of `draws.independent`, if they were computed before

    Figures that do not vary have indices of 0.
    """
    half, few = len(draws.first), draws.mixed.shape[1]
    if known is None:
        known = figures(draws.independent)
    a, b = known[:, :few], known[:, half : half + few]
    ab = np.stack([figures(own) for own in draws.mixed])
    varies = np.ptp(np.concatenate([a, b], axis=1), axis=1) > 0
    shape = len(known), len(draws.groups)
    found = [np.zeros(shape) for _ in range(4)]
    if varies.any():
        values = {"f_A": a[varies], "f_B": b[varies], "f_AB": ab[:, varies]}
        result = scipy.stats.sobol_indices(func=values, n=few)
        shares = result.first_order, result.total_order
        errors = _errors(*values.values())
        for place, own in enumerate((*shares, *errors)):
            found[place][varies] = np.reshape(own, (-1, shape[1]))
    return Indices(*found)


def _errors(a: np.ndarray, b: np.ndarray, ab: np.ndarray) -> tuple[np.ndarray, ...]:
    # The estimators are means of these terms; the error of the variance is neglected
    both = np.concatenate([a, b], axis=1)
    variance, mean = both.var(axis=1), both.mean(axis=1)[:, None]
    terms = (b - mean) * (ab - a), 0.5 * (ab - a) ** 2
    return tuple(
        (own.std(axis=-1) / np.sqrt(own.shape[-1]) / variance).T for own in terms
    )
