"""Quasi-random draws of unknown quantities.

Scrambled Sobol' points give two independent sets of draws, A and B, and for each
quantity (or group of correlated quantities) a set that has its values from B and all
others from A, as required by the estimators of Sobol' indices. Correlated quantities
have correlated normal scores (Gaussian copula).

References: A. Saltelli et al., "Variance based sensitivity analysis of model output",
Computer Physics Communications 181 (2), 2010; R. B. Nelsen, An Introduction to
Copulas, 2006.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import distinct, positive, require, within
from clerestory.uncertainty.distributions import Distribution


@dataclass(frozen=True)
class Unknown:
    """A quantity that is not known exactly.

    Attributes
    ----------
    name : name of the quantity
    distribution : distribution of its values
    reference : value in the model
    unit : unit of the values
    """

    name: str
    distribution: Distribution
    reference: float = 1.0
    unit: str = ""


@dataclass(frozen=True)
class Correlated:
    """Names of quantities whose normal scores have one correlation with each other."""

    names: tuple[str, ...]
    correlation: float

    def __post_init__(self) -> None:
        require(len(self.names) > 1, "one correlated quantity; two or more expected")
        least = -1 / (len(self.names) - 1)
        what = f"correlation of {len(self.names)} quantities"
        within(self.correlation, what, least=least + 1e-9, most=1)


@dataclass(frozen=True, eq=False)
class Draws:
    """Draws of unknown quantities for propagation and for Sobol' indices.

    Attributes
    ----------
    names : names of the quantities
    groups : for each Sobol' index, the numbers of its quantities
    first, second : the independent sets A and B
    mixed : set A with the values of each group from B, for the first draws of A
    """

    names: tuple[str, ...]
    groups: tuple[tuple[int, ...], ...]
    first: Float[np.ndarray, "draw unknown"]
    second: Float[np.ndarray, "draw unknown"]
    mixed: Float[np.ndarray, "group few unknown"]

    __repr__ = brief

    @property
    def independent(self) -> Float[np.ndarray, "both unknown"]:
        """Draws of A and B."""
        return np.concatenate([self.first, self.second])

    @property
    def alternating(self) -> Float[np.ndarray, "both unknown"]:
        """Draws of A and B in turn."""
        both = np.stack([self.first, self.second], axis=1)
        return both.reshape(-1, len(self.names))

    @property
    def labels(self) -> tuple[str, ...]:
        """Name of each group."""
        return tuple(" + ".join(self.names[k] for k in own) for own in self.groups)


def draw(
    unknowns: Sequence[Unknown],
    count: int,
    *,
    correlated: Sequence[Correlated] = (),
    few: int = 256,
    seed: int = 0,
) -> Draws:
    """Return quasi-random draws of unknown quantities.

    Parameters
    ----------
    count : number of draws of A and B together, a power of two
    correlated : groups of correlated quantities; the others are independent
    few : largest number of draws of each mixed set
    seed : random seed of the scrambling

    Examples
    --------
    >>> from clerestory.uncertainty.distributions import uniform
    >>> found = draw([Unknown("floor", uniform(0.2, 0.4))], 256)
    >>> found.independent.shape, round(float(found.independent.mean()), 3)
    ((256, 1), 0.3)
    """
    require(unknowns, "no unknown quantity; one or more expected")
    distinct([unknown.name for unknown in unknowns], "unknown quantities")
    positive(count, "number of draws")
    power = round(np.log2(count))
    require(2**power == count >= 4, f"{count} draws; a power of two expected")
    half, size = count // 2, len(unknowns)
    sequence = scipy.stats.qmc.Sobol(2 * size, rng=np.random.default_rng(seed))
    points = sequence.random(half)
    # Quantiles of 0 and 1 would be infinite
    points = np.clip(points, 1e-9, 1 - 1e-9)
    groups = _groups([unknown.name for unknown in unknowns], correlated)
    scores = scipy.stats.norm.ppf(points)
    sets = [scores[:, :size].copy(), scores[:, size:].copy()]
    for one in sets:
        for own, factor in groups:
            one[:, own] = one[:, own] @ factor.T
    shares = [scipy.stats.norm.cdf(one) for one in sets]
    first, second = (
        np.stack(
            [u.distribution.quantiles(one[:, k]) for k, u in enumerate(unknowns)],
            axis=1,
        )
        for one in shares
    )
    mixed = np.repeat(first[None, : min(few, half)], len(groups), axis=0)
    for number, (own, _) in enumerate(groups):
        mixed[number][:, own] = second[: mixed.shape[1], own]
    names = tuple(unknown.name for unknown in unknowns)
    return Draws(names, tuple(tuple(own) for own, _ in groups), first, second, mixed)


def _groups(
    names: Sequence[str], correlated: Sequence[Correlated]
) -> list[tuple[list[int], np.ndarray]]:
    # Numbers of the quantities of each group, and factor of their correlation matrix
    distinct([name for one in correlated for name in one.names], "correlated names")
    found = []
    for one in correlated:
        missing = [name for name in one.names if name not in names]
        message = f'correlated "{"".join(missing[:1])}" is not an unknown quantity'
        require(not missing, f"{message}; one of {', '.join(names)} expected")
        size = len(one.names)
        matrix = np.full((size, size), one.correlation)
        np.fill_diagonal(matrix, 1.0)
        values, vectors = np.linalg.eigh(matrix)
        factor = vectors * np.sqrt(np.maximum(values, 0.0))
        found.append(([names.index(name) for name in one.names], factor))
    taken = {k for own, _ in found for k in own}
    single = [([k], np.eye(1)) for k in range(len(names)) if k not in taken]
    return sorted([*found, *single], key=lambda group: group[0][0])
