"""Comparison of measured and simulated series.

The clock offset between measurement and simulation is the time shift with the smallest
CV(RMSE). The clock offset is reported but not applied.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar, final

import numpy as np

from clerestory.brief_repr import brief
from clerestory.checks import not_negative, require
from clerestory.comparison.series import ILLUMINANCE, Series, group_of, quantity_of
from clerestory.comparison.time_alignment import (
    COVERAGE,
    Pairs,
    join_pairs,
    pair_series,
)
from clerestory.errors import InputError
from clerestory.metrics.agreement import Agreement, agreement

ABOVE_LUX = 100.0

# Largest time shift and increment in the search for the clock offset [min]
_LARGEST, _STEP = 120, 5

# Smallest number of distinct times required for the search for the clock offset
_FEWEST = 8

Label = TypeVar("Label", str, tuple[str, str])


@final
@dataclass(frozen=True)
class Rules:
    """Settings of a comparison: selection of values and alignment of times.

    Attributes
    ----------
    above_lux : limit up to which measured illuminances are excluded [lux]
    shift_minutes : time shift added to the measured times [min]
    coverage : fraction, 0…1, of a time step that values of shorter steps must cover
    """

    above_lux: float = ABOVE_LUX
    shift_minutes: float = 0.0
    coverage: float = COVERAGE

    def __post_init__(self) -> None:
        not_negative(self.above_lux, "limit of illuminance", unit="lux")
        expected = "a number above 0, at most 1, expected"
        require(0 < self.coverage <= 1, f"coverage is {self.coverage}; {expected}")


@final
@dataclass(frozen=True)
class Offset:
    """Shift [min] of the measured times with the best agreement, and its CV(RMSE)."""

    minutes: int
    rmse: float
    rmse_unmoved: float

    @property
    def matters(self) -> bool:
        """Whether the time shift reduces CV(RMSE) by more than a tenth."""
        return self.minutes != 0 and self.rmse < 0.9 * self.rmse_unmoved


@final
@dataclass(frozen=True, eq=False)
class Comparison:
    """Result of a comparison.

    Attributes
    ----------
    name : name of the simulation
    below : number of values of each series excluded by the limit `above_lux`
    offset : best time shift for each quantity; reported but not applied to the values
    unmatched : names of measured series that were not simulated
    years_ignored : whether times were matched by month, day and time of day only
    """

    name: str
    pairs: Pairs
    below: np.ndarray
    rules: Rules
    offset: dict[str, Offset]
    unmatched: tuple[str, ...]
    years_ignored: bool
    step_minutes: float

    __repr__ = brief

    def table(self) -> dict[tuple[str, str], Agreement]:
        """Return the agreement of each group (grid or view) and quantity."""
        kinds = [(group_of(n), quantity_of(n)) for n in self.pairs.names]
        return self._agreements(kinds)

    def series(self) -> dict[str, Agreement]:
        """Return the agreement of each series with values to compare."""
        return self._agreements(list(self.pairs.names))

    def excluded(self, name: str) -> dict[str, int]:
        """Return the numbers of excluded values of a series, by reason."""
        row, pairs = self.pairs.names.index(name), self.pairs
        return {
            "gaps": int(pairs.gaps[row]),
            "not_simulated": int(pairs.outside[row]),
            "too_dark": int(self.below[row]),
        }

    def _agreements(self, labels: list[Label]) -> dict[Label, Agreement]:
        # Agreement of all series with the same label; `labels` has one label per series
        found = {}
        for label in dict.fromkeys(labels):
            rows = [i for i, each in enumerate(labels) if each == label]
            part = self.pairs.where(np.isin(self.pairs.series, rows))
            if part.measured.size:
                found[label] = agreement(part.measured, part.simulated)
        return found


def compare_series(
    measured: Sequence[Series],
    simulated: Series,
    *,
    name: str = "simulated",
    rules: Rules | None = None,
) -> Comparison:
    """Return the agreement of a simulation with measurements.

    Parameters
    ----------
    measured : series from `read_measured_series`, with the UTC offset of the simulation
    simulated : series from `simulated_series`, or another measurement
    name : name of the simulation
    rules : settings of the comparison

    Raises
    ------
    InputError : no series or times are in common, or no measured value is above the
        limit

    Examples
    --------
    >>> noon = np.array(["2024-06-26T12:00", "2024-06-26T13:00"], "datetime64[s]")
    >>> lux = Series(("desk",), noon, np.array([[500.0, 400.0]]), 60.0, 0.0)
    >>> ours = Series(("desk",), noon, np.array([[520.0, 450.0]]), 60.0, 0.0)
    >>> found = compare_series([lux], ours).series()["desk"]
    >>> found.within, found.mean_bias
    ((0.5, 0.5, 1.0), 35.0)
    """
    rules = rules or Rules()
    moved, ignored = matched_series(measured, simulated)
    pairs = value_pairs(moved, simulated, rules, rules.shift_minutes)
    counts = counted(pairs, rules)
    below = np.bincount(pairs.series[~counts], minlength=len(pairs.names))
    chosen = pairs.where(counts)
    if not chosen.measured.size:
        raise InputError(_nothing(pairs, rules, simulated))
    names = {name for series in measured for name in series.names}
    return Comparison(
        name,
        chosen,
        below,
        rules,
        _offsets(moved, simulated, rules),
        tuple(sorted(names - set(simulated.names))),
        ignored,
        simulated.step_minutes,
    )


def matched_series(
    measured: Sequence[Series], simulated: Series
) -> tuple[list[Series], bool]:
    """Return the measured series that were simulated, in the years of the simulation.

    The second value tells whether the years were ignored.
    """
    known = _selected(measured, simulated.names)
    example = f'names such as "{simulated.names[0]}" expected'
    require(known, f"no measured series has the name of a simulated one; {example}")
    return _in_the_same_years(known, simulated)


def _selected(measured: Sequence[Series], names: Sequence[str]) -> list[Series]:
    # Measured series with the given names
    found = [
        series.select([n for n in series.names if n in names]) for series in measured
    ]
    return [series for series in found if series.names]


def value_pairs(
    measured: Sequence[Series], simulated: Series, rules: Rules, minutes: float
) -> Pairs:
    """Return pairs of all values, with minutes added to the measured times."""
    shifted = [series.shifted(minutes) for series in measured]
    same = [simulated.select(list(series.names)) for series in measured]
    pair = partial(pair_series, coverage=rules.coverage)
    return join_pairs(list(map(pair, shifted, same)))


def counted(pairs: Pairs, rules: Rules) -> np.ndarray:
    """Return which pairs count: illuminances above the limit, glare indices above 0."""
    lux = np.array([quantity_of(name) == ILLUMINANCE for name in pairs.names])
    limit = np.where(lux[pairs.series], rules.above_lux, 0.0)
    return np.asarray(pairs.measured > limit)


def _nothing(pairs: Pairs, rules: Rules, simulated: Series) -> str:
    if pairs.measured.size:
        return f"no measurement above {rules.above_lux:g} lux; a lower limit expected"
    first, last = simulated.times[0], simulated.times[-1]
    return f"no time in common; measured times from {first} to {last} expected"


def _offsets(
    measured: Sequence[Series], simulated: Series, rules: Rules
) -> dict[str, Offset]:
    found = {}
    names = [name for series in measured for name in series.names]
    for kind in dict.fromkeys(map(quantity_of, names)):
        parts = _selected(measured, [n for n in names if quantity_of(n) == kind])

        def at(minutes: int, parts: Sequence[Series] = parts) -> Pairs:
            pairs = value_pairs(parts, simulated, rules, rules.shift_minutes + minutes)
            return pairs.where(counted(pairs, rules))

        best = _search_offset(at)
        if best is not None:
            found[kind] = best
    return found


def _search_offset(pairs_at: Callable[[int], Pairs]) -> Offset | None:
    # Best time shift up to two hours; None if there are too few pairs
    unmoved = pairs_at(0)
    if len(np.unique(unmoved.times)) < _FEWEST:
        return None
    found = {0: _variation(unmoved)}
    for minutes in range(-_LARGEST, _LARGEST + 1, _STEP):
        pairs = pairs_at(minutes)
        if pairs.measured.size >= 0.8 * unmoved.measured.size:
            found[minutes] = _variation(pairs)
    # Among time shifts of equal CV(RMSE), choose the smallest
    best = min(found, key=lambda minutes: (found[minutes], abs(minutes)))
    return Offset(best, found[best], found[0])


def _variation(pairs: Pairs) -> float:
    return agreement(pairs.measured, pairs.simulated).variation


def _in_the_same_years(
    measured: Sequence[Series], simulated: Series
) -> tuple[list[Series], bool]:
    # The year of a typical year is arbitrary, so match month, day and time of day
    ours, theirs = (
        set(np.concatenate(times).astype("datetime64[Y]").astype(int).tolist())
        for times in ([simulated.times], [series.times for series in measured])
    )
    if ours & theirs or len(ours) > 1 or not theirs:
        return list(measured), False
    (year,) = ours
    return [_in_year(series, year) for series in measured], True


def _in_year(series: Series, year: int) -> Series:
    # Move the times of the first year to the given year; drop times of later years and,
    # if the given year is not a leap year, of 29 February
    months = series.times.astype("datetime64[M]")
    day = (series.times.astype("datetime64[D]") - months).astype(int)
    rest = series.times - series.times.astype("datetime64[D]")
    own = np.datetime64(f"{year + 1970}-01", "M") + months.astype(int) % 12
    date = own.astype("datetime64[D]") + day
    times = date.astype("datetime64[s]") + rest
    kept = date.astype("datetime64[M]") == own
    kept &= months.astype("datetime64[Y]") == months[0].astype("datetime64[Y]")
    return replace(
        series,
        times=times[kept],
        values=series.values[:, kept],
        error=None if series.error is None else series.error[:, kept],
    )
