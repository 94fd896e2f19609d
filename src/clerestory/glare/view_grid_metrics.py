"""Annual glare of a view grid: figures of each view, and shares of views and positions.

The hourly errors of the DGP of a view come from the same samples and matrices; they are
taken as fully correlated, which gives upper limits of the errors of its annual figures.
Different positions are sampled independently. The shares of views and positions take
each as disturbed with the probability of a normal distribution.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int
from scipy.special import ndtr

from clerestory.array_types import Values
from clerestory.brief_repr import brief
from clerestory.checks import require, same_length
from clerestory.glare.comfort_classes import LIMITS, exceeded_dgp

# DGP above which glare is disturbing
DISTURBING = LIMITS[1]


class Uncertain(NamedTuple):
    """A number and its standard error."""

    value: float
    error: float


@dataclass(frozen=True, eq=False)
class ViewFigures:
    """Annual glare of views, each with its standard error.

    Attributes
    ----------
    exceeded : DGP that is exceeded in at most 5 % of the occupied time
    share : share of the occupied time in which DGP is above each of `LIMITS`
    """

    exceeded: Float[np.ndarray, " view"]
    exceeded_error: Float[np.ndarray, " view"]
    share: Float[np.ndarray, "view limit"]
    share_error: Float[np.ndarray, "view limit"]

    __repr__ = brief


def view_figures(
    dgp: Float[np.ndarray, "view time"],
    error: Float[np.ndarray, "view time"] | None = None,
) -> ViewFigures:
    """Return the annual glare of views from DGP in the occupied time.

    DGP is NaN in the dark, which counts as no glare.

    >>> year = np.array([[0.2] * 90 + [0.42] * 10])
    >>> figures = view_figures(year, 0.01 + 0 * year)
    >>> figures.exceeded.tolist(), figures.share.tolist()
    ([0.42], [[0.1, 0.1, 0.0]])
    >>> figures.exceeded_error.round(3).tolist()
    [0.01]
    """
    require(dgp.shape[-1], "no occupied steps; at least one expected")
    value = np.nan_to_num(dgp, nan=0.0)
    spread = 0 * value if error is None else np.nan_to_num(error, nan=0.0)
    exceeded, share = _figures(value)
    low, high = (_figures(value + sign * spread) for sign in (-1, 1))
    return ViewFigures(
        exceeded,
        np.abs(high[0] - low[0]) / 2,
        share,
        np.abs(high[1] - low[1]) / 2,
    )


def _figures(
    dgp: Float[np.ndarray, "view time"],
) -> tuple[Float[np.ndarray, " view"], Float[np.ndarray, "view limit"]]:
    above = [(dgp > limit).mean(axis=1) for limit in LIMITS]
    return exceeded_dgp(dgp).astype(float), np.stack(above, axis=1)


def disturbed_views(
    exceeded: Values, error: Values, *, position: Int[np.ndarray, " view"]
) -> Uncertain:
    """Return the share of views with disturbing glare in more than 5 % of the time.

    Parameters
    ----------
    exceeded, error : DGP exceeded in 5 % of the occupied time, and its standard error
    position : index of the position of each view

    >>> disturbed_views(np.array([0.5, 0.3]), np.zeros(2), position=np.array([0, 0]))
    Uncertain(value=0.5, error=0.0)
    """
    same_length(position, exceeded, "positions", "views")
    chance = _probability(exceeded, error)
    deviation = np.sqrt(chance * (1 - chance))
    # The views of a position share their samples: their deviations are added
    summed = np.bincount(position, deviation)
    share = float((exceeded > DISTURBING).mean())
    return Uncertain(share, float(np.linalg.norm(summed) / len(exceeded)))


def disturbed_positions(
    exceeded: Values, error: Values, *, position: Int[np.ndarray, " view"]
) -> Uncertain:
    """Return the share of positions where a view has disturbing glare in more than 5 %.

    >>> place = np.array([0, 0, 1, 1])
    >>> dgp = np.array([0.5, 0.3, 0.2, 0.3])
    >>> disturbed_positions(dgp, np.zeros(4), position=place).value
    0.5
    """
    same_length(position, exceeded, "positions", "views")
    worst = [
        np.flatnonzero(position == place)[np.argmax(exceeded[position == place])]
        for place in np.unique(position)
    ]
    chance = _probability(exceeded[worst], error[worst])
    share = float((exceeded[worst] > DISTURBING).mean())
    spread = float(np.sqrt((chance * (1 - chance)).sum()) / len(worst))
    return Uncertain(share, spread)


def _probability(exceeded: Values, error: Values) -> Values:
    # Probability that the DGP exceeded in 5 % of the time is disturbing
    certain = (exceeded > DISTURBING).astype(float)
    with np.errstate(divide="ignore", invalid="ignore"):
        likely = ndtr((exceeded - DISTURBING) / error)
    return np.where(error > 0, likely, certain)
