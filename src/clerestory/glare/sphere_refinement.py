"""Adaptive sampling of the sphere around a view point for glare.

A cell is split if the luminance of the cells next to it differs so much that the DGP of
a view would be uncertain. The standard deviation of the luminance of a cell is taken as
the largest difference Δ to an adjacent cell divided by √12: that of a uniform
distribution, for a gradient as for an edge anywhere in the cell. It is propagated
through the DGP equation, to first order and for all views and time steps: by the
vertical illuminance, with ΔL, and by the glare sources, with Δ(L²), L = 0 below the
threshold. The sum of the variances of all cells gives the standard error of DGP.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from clerestory.array_types import Directions
from clerestory.checks import positive, require
from clerestory.glare.dgp_error import DgpModel, DgpTerms, Light
from clerestory.glare.eye_directions import SunDisc
from clerestory.glare.index_settings import EVALGLARE, DgpCoefficients
from clerestory.glare.sphere_samples import FINEST, SphereSamples, regular_samples
from clerestory.scene.view import View

# Luminance [cd/m²] of samples, at each time step or for each of a few of them
LuminanceOf = Callable[[SphereSamples], Float[np.ndarray, "direction step"]]

# Time steps that are evaluated at once
_STEPS = 256


@dataclass(frozen=True, kw_only=True)
class Refinement:
    """How finely the sphere is sampled.

    Attributes
    ----------
    tolerance : standard error of DGP that is aimed at, in every view and time step
    most : largest number of directions
    rounds : number of times that cells are split
    first, finest : level of the cells of the first round, and of the smallest cells; a
        cell of level n has the solid angle 4π/4ⁿ
    threshold : luminance above which directions are glare sources [cd/m²]
    coefficients : coefficients of DGP
    """

    tolerance: float = 0.002
    most: int = 6000
    rounds: int = 5
    first: int = 5
    finest: int = 9
    threshold: float = 2000.0
    coefficients: DgpCoefficients = EVALGLARE

    def __post_init__(self) -> None:
        positive(self.tolerance, "tolerance of DGP")
        positive(self.threshold, "threshold", unit="cd/m2")
        require(
            1 <= self.first <= self.finest <= FINEST,
            f"levels of the cells are {self.first} to {self.finest}; growing numbers"
            f" from 1 to {FINEST} expected",
        )
        require(
            self.most >= 4**self.first,
            f"largest number of directions is {self.most}; at least the"
            f" {4**self.first} of level {self.first} expected",
        )


def sample_sphere(
    luminance: LuminanceOf,
    views: Sequence[View],
    *,
    refinement: Refinement | None = None,
    details: Directions | None = None,
    seed: int = 1,
) -> SphereSamples:
    """Return directions that sample the sphere finely where DGP depends on it.

    In each round, the cells are split that have more than their share (one by the
    number of cells) of the variance of DGP, in a view and time step whose standard
    error is above the tolerance; at most half of the remaining number are spent before
    the last round.

    Parameters
    ----------
    luminance : function that returns the luminance of samples [cd/m²] at each time
        step, without the sun's disc: that of their directions, or the means over their
        cells; called once with all new samples of a round. The steps may be a selection
        of the year, with all its kinds of sky, position of the sun and state of the
        shading
    views : view directions that share the samples
    details : directions of things that the first round could miss, such as points of
        small windows and luminaires; their cells are split down to the finest level
        before the first round

    >>> eye = View(kind="angular", horizontal=180, vertical=180)
    >>> def window(samples):
    ...     return np.where(samples.direction[:, 1:2] > 0.9, [5000.0, 0.0], 100.0)
    >>> samples = sample_sphere(window, [eye])
    >>> ahead = samples.direction[:, 1] > 0
    >>> bool(samples.level[ahead].max() > samples.level[~ahead].max())
    True
    """
    how = refinement or Refinement()
    random = np.random.default_rng([seed, 1])
    samples = regular_samples(how.first, seed=seed)
    if details is not None:
        for _ in range(how.finest - how.first):
            which = np.zeros(samples.count, dtype=bool)
            which[samples.containing(details)] = True
            samples = samples.split(which & (samples.level < how.finest), random)
    values = luminance(samples)
    for left in reversed(range(how.rounds)):
        which = _to_split(samples, values, views, how, last=not left)
        if not which.any():
            break
        samples = samples.split(which, random)
        new = samples.select(slice(np.count_nonzero(~which), None))
        values = np.concatenate([values[~which], luminance(new)])
    return samples


def _to_split(
    samples: SphereSamples,
    luminance: Float[np.ndarray, "direction step"],
    views: Sequence[View],
    how: Refinement,
    *,
    last: bool,
) -> Bool[np.ndarray, " cell"]:
    coarse = samples.level < how.finest
    share, worst = np.zeros(samples.count), np.zeros(samples.count)
    model = DgpModel(samples, views, how.threshold, how.coefficients)
    one, other = (weight[:, coarse, None] for weight in model.weights)
    for _, of_level, of_glare, _, terms in _deviations(model, luminance):
        level, glare = of_level[coarse], of_glare[coarse]
        for view in range(len(views)):
            square = np.square(
                terms.by_glare[view] * other[view] * glare
                + np.abs(terms.by_level[view]) * one[view] * level
            )
            variance = square.sum(axis=0)
            square = square[:, variance > how.tolerance**2]
            if square.size:
                variance = variance[variance > how.tolerance**2]
                part = (square / variance).max(axis=1)
                share[coarse] = np.maximum(share[coarse], part)
                worst[coarse] = np.maximum(worst[coarse], square.max(axis=1))
    wanted = np.flatnonzero(share * samples.count > 1)
    budget = (how.most - samples.count) // 3
    if not last:
        budget = (budget + 1) // 2
    which = np.zeros(samples.count, dtype=bool)
    which[wanted[np.argsort(-worst[wanted], kind="stable")[: max(budget, 0)]]] = True
    return which


def sampling_error(
    samples: SphereSamples,
    luminance: Float[np.ndarray, "direction step"],
    views: Sequence[View],
    *,
    refinement: Refinement | None = None,
    sun: SunDisc | None = None,
    means: bool = False,
) -> Float[np.ndarray, "view step"]:
    """Standard error of DGP from the finite number of directions, to first order.

    Small things that no direction hits are not in the error. `sun` is the sun's disc at
    each step. If the luminances are `means` over the cells, the illuminance has no
    error. A cell at the edge of a glare source widens the source and dims it, or is
    below the threshold: both lower DGP, by sums over all such cells.
    """
    error = np.zeros((len(views), luminance.shape[1]))
    how = refinement or Refinement()
    model = DgpModel(samples, views, how.threshold, how.coefficients)
    for steps, of_level, of_glare, edge, terms in _deviations(model, luminance, sun):
        by_level = 0 * terms.by_level if means else np.abs(terms.by_level)
        terms = terms._replace(by_level=by_level)
        variance = model.variance(terms, of_level, of_glare)
        if means:
            # A share p of a cell above the threshold, at an edge of height Δ: Δ²(1 − p)
            # is lost if the mean of the cell is above the threshold, else Δ²p
            lost = 12 * np.square(of_level) * edge
            variance += np.square(terms.by_glare * (model.weights[1] @ lost))
        error[:, steps] = np.sqrt(variance)
    return error


def _deviations(
    model: DgpModel,
    luminance: Float[np.ndarray, "direction step"],
    sun: SunDisc | None = None,
) -> Iterator[tuple[slice, Light, Light, Light, DgpTerms]]:
    # Standard deviations of the luminance of each cell, and of its power in the sum
    # over sources, and the share of this power that cells at the edge of a source lose
    # on average, by blocks of time steps
    own, other = model.samples.adjacent.T
    first = np.searchsorted(own, np.arange(model.samples.count))
    spread = np.float32(1 / np.sqrt(12))
    for begin in range(0, luminance.shape[1], _STEPS):
        steps = slice(begin, begin + _STEPS)
        level = luminance[:, steps]
        beside = level[other]
        most, least = (one.reduceat(beside, first) for one in (np.maximum, np.minimum))
        glare, high, low = (model.glare(x) for x in (level, most, least))
        of_level = spread * np.maximum(most - level, level - least)
        of_glare = spread * np.maximum(high - glare, glare - low)
        disc = None if sun is None else sun.select(steps)
        terms = model.terms(level, disc)
        yield steps, of_level, of_glare, _edge_loss(model, level, most, least), terms


def _edge_loss(model: DgpModel, level: Light, most: Light, least: Light) -> Light:
    # Mean over p from 0 to 1 of what a source loses by a cell that straddles its edge
    high, low = np.maximum(level, most), np.minimum(level, least)
    limit = np.float32(model.threshold)
    crosses = (high > limit) & (low <= limit)
    least_share = np.where(crosses, limit / np.maximum(high, limit), 0)
    loss = (np.square(least_share) + np.square(1 - least_share)) / 2
    return np.where(crosses, loss, np.float32(0))
