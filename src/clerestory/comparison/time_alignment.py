"""Time alignment of measured and simulated series.

The series with shorter time steps is averaged over the steps of the other series; steps
with too few values are left out. If both series have steps of the same length, or
measurements are instantaneous, simulated values are interpolated between the centres of
the steps. Clock offsets are not corrected.
"""

from dataclasses import dataclass, replace
from typing import final

import numpy as np
from jaxtyping import Float, Int

from clerestory.comparison.series import Series

COVERAGE = 0.75
_SAME = 1.0  # largest difference of step lengths regarded as equal [s]


# Attributes of `Pairs` with one entry per measured value
_OF_PAIRS = ("series", "times", "measured", "simulated", "error")


@final
@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of measured and simulated values at the same times.

    Attributes
    ----------
    series : index of the series to which each value pair belongs
    times : local standard time at the centre of the time step of each value pair
    error : standard error of the simulated value; NaN if unknown
    gaps : number of missing measured values of each series
    outside : number of measured values of each series at times without simulation
    """

    names: tuple[str, ...]
    series: Int[np.ndarray, " pair"]
    times: np.ndarray
    measured: Float[np.ndarray, " pair"]
    simulated: Float[np.ndarray, " pair"]
    error: Float[np.ndarray, " pair"]
    gaps: Int[np.ndarray, " series"]
    outside: Int[np.ndarray, " series"]

    def where(self, chosen: np.ndarray) -> "Pairs":
        """Return the value pairs selected by mask or indices; `names` are unchanged."""
        return replace(self, **{n: getattr(self, n)[chosen] for n in _OF_PAIRS})

    def of(self, name: str) -> "Pairs":
        """Return the value pairs of one series, ordered by time."""
        one = self.where(self.series == self.names.index(name))
        return one.where(np.argsort(one.times, kind="stable"))


def pair_series(
    measured: Series, simulated: Series, *, coverage: float = COVERAGE
) -> Pairs:
    """Return measured and simulated values at the same times.

    Both arguments have equal names in equal order, and the same UTC offset. `coverage`
    is the fraction of a time step that values of shorter steps must cover.
    """
    coarse = (measured.step_minutes - simulated.step_minutes) * 60
    if measured.step_minutes > 0 and coarse < -_SAME:
        measured_at, gaps = _averaged(measured, simulated, coverage, measured.values)
        steps = simulated.times
        simulated_at, error = simulated.values, simulated.error
    else:
        steps, measured_at = measured.times, measured.values
        gaps = np.isnan(measured.values).sum(axis=1)
        if coarse > _SAME and measured.step_minutes > 0:
            simulated_at, _ = _averaged(simulated, measured, coverage, simulated.values)
            # Average the standard errors: errors of all time steps are correlated
            error = simulated.error
            if error is not None:
                error, _ = _averaged(simulated, measured, coverage, error)
        else:
            simulated_at, error = _interpolated(simulated, steps)
    known, computed = ~np.isnan(measured_at), ~np.isnan(simulated_at)
    row, column = np.nonzero(known & computed)
    errors = np.full(measured_at.shape, np.nan) if error is None else error
    return Pairs(
        measured.names,
        row,
        steps[column],
        measured_at[row, column],
        simulated_at[row, column],
        errors[row, column],
        gaps,
        (known & ~computed).sum(axis=1),
    )


def join_pairs(parts: list[Pairs]) -> Pairs:
    """Join the value pairs of several files; series of equal name are combined."""
    names = tuple(dict.fromkeys(name for part in parts for name in part.names))
    place = {name: number for number, name in enumerate(names)}
    gaps, outside = np.zeros(len(names), int), np.zeros(len(names), int)
    moved = []
    for part in parts:
        to = np.array([place[name] for name in part.names], dtype=int)
        np.add.at(gaps, to, part.gaps)
        np.add.at(outside, to, part.outside)
        moved.append(replace(part, series=to[part.series]))
    joined = {n: np.concatenate([getattr(p, n) for p in moved]) for n in _OF_PAIRS}
    return Pairs(names, **joined, gaps=gaps, outside=outside)


def _seconds(times: np.ndarray) -> np.ndarray:
    return times.astype("datetime64[s]").astype(np.int64).astype(float)


def _averaged(
    fine: Series, coarse: Series, coverage: float, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    # Means over longer time steps (NaN below `coverage`), and number of missing values
    # of each series. A shorter step belongs to the longer step that contains its centre
    moments, middles = _seconds(fine.times), _seconds(coarse.times)
    half = coarse.step_minutes * 30
    bin_of = np.searchsorted(middles - half, moments, side="right") - 1
    inside = (bin_of >= 0) & (moments < middles[np.maximum(bin_of, 0)] + half)
    chosen = values[:, inside]
    there = ~np.isnan(chosen)
    total, count = (
        np.array([np.bincount(bin_of[inside], row, len(middles)) for row in part])
        for part in (np.where(there, chosen, 0), there)
    )
    enough = count >= coverage * coarse.step_minutes / fine.step_minutes - 1e-9
    means = np.full(total.shape, np.nan)
    np.divide(total, count, out=means, where=(count > 0) & enough)
    return means, (~there).sum(axis=1)


def _interpolated(
    series: Series, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray | None]:
    # Linear interpolation between the centres of consecutive steps; constant up to half
    # a step beyond the ends
    moments, middles = _seconds(times), _seconds(series.times)
    step = max(series.step_minutes * 60, 1.0)
    after = np.clip(np.searchsorted(middles, moments), 0, len(middles) - 1)
    before = np.maximum(after - 1, 0)
    gap = middles[after] - middles[before]
    weight = np.divide(
        moments - middles[before], gap, out=np.ones(len(moments)), where=gap > 0
    )
    # Do not interpolate a single step, across a gap or beyond the ends
    alone = (gap > 1.5 * step) | (weight > 1) | (weight < 0) | (gap == 0)
    near = np.abs(moments - middles[before]) < np.abs(moments - middles[after])
    nearest = np.where(near, before, after)
    beyond = np.abs(moments - middles[nearest]) > step / 2 + _SAME
    weight = np.where(alone, 1.0, weight)
    after = np.where(alone, nearest, after)

    def at(values: np.ndarray) -> np.ndarray:
        low = np.where(weight < 1, values[:, before], 0.0)
        mixed = (1 - weight) * low + weight * values[:, after]
        return np.where(alone & beyond, np.nan, mixed)

    return at(series.values), None if series.error is None else at(series.error)
