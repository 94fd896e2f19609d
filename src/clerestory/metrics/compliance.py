"""Compliance with standards: verdicts with their errors, and requirements.

A standard is a table: criteria, each with the quantities that it limits and a level
that follows from them, and requirements of the procedure. The standard error of a level
is its standard deviation over the replicates of the quantities (`metrics.replicates`).
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np
import xarray as xr

from clerestory.metrics.replicates import metric_error
from clerestory.metrics.space import WHOLE, Space, spaces_of, whole_of
from clerestory.metrics.spatial_metrics import RoomShare

Status = Literal["fulfilled", "not fulfilled", "not known"]

# How the verdict on all spaces follows: from all sensors weighted by floor area, or
# from the space with the lowest level
Combination = Literal["by area", "lowest space"]

UNKNOWN = -1


class Quantity(NamedTuple):
    """Quantity that a criterion limits: value, replicates, and the limits as text.

    The value is NaN if it is not known.
    """

    name: str
    value: float
    unit: str
    limits: str
    replicates: tuple[float, ...] = ()

    @property
    def error(self) -> float:
        """Standard error; 0 if unknown."""
        return metric_error(self.replicates)


def share(name: str, found: RoomShare | None, limits: str) -> Quantity:
    """Return a fraction of the area as a quantity in %; None is not known."""
    if found is None:
        return Quantity(name, np.nan, "%", limits)
    varied = tuple(100 * value for value in found.replicates)
    return Quantity(name, 100 * found.value, "%", limits, varied)


class Requirement(NamedTuple):
    """A requirement of a procedure: found, expected, and what to change."""

    name: str
    status: Status
    found: str
    expected: str
    change: str = ""

    @property
    def departure(self) -> str:
        """What was found and what was expected, in one line."""
        return f"{self.found}; {self.expected} expected"


Check = Callable[[Space], Iterable[Requirement]]


class Criterion(NamedTuple):
    """A criterion: quantities, and the level that follows from their values.

    `levels` are the names of the levels from 0 on. A criterion of the whole building
    gives no level to one of several spaces.
    """

    name: str
    levels: tuple[str, ...]
    quantities: Callable[[Space], Sequence[Quantity]]
    level: Callable[[Sequence[float], Space], int]
    combination: Combination = "by area"
    of_the_whole: bool = False


class Standard(NamedTuple):
    """A standard: title, criteria and requirements of its procedure."""

    name: str
    title: str
    criteria: tuple[Criterion, ...]
    checks: tuple[Check, ...]


@dataclass(frozen=True)
class Verdict:
    """Level that a space reaches in a criterion; −1 if it is not known.

    `replicates` are the levels for all replicates of the quantities.
    """

    criterion: str
    level: int
    levels: tuple[str, ...]
    quantities: tuple[Quantity, ...] = ()
    replicates: tuple[int, ...] = ()

    @property
    def error(self) -> float:
        """Standard error of the level; 0 if unknown."""
        return metric_error(self.replicates)

    @property
    def words(self) -> str:
        """Name of the level; empty for a part of what the criterion is about."""
        if not self.levels:
            return ""
        return "not known" if self.level == UNKNOWN else self.levels[self.level]


@dataclass(frozen=True)
class Assessment:
    """Verdicts and requirements of one standard for one space, or for all spaces."""

    standard: str
    space: str
    area: float
    verdicts: tuple[Verdict, ...]
    requirements: tuple[Requirement, ...] = ()


def assess(data: xr.Dataset, standards: Sequence[Standard]) -> tuple[Assessment, ...]:
    """Return the assessments of all spaces, then of all together, for each standard.

    `data` are the results of a run, see `Results.data`.
    """
    spaces = spaces_of(data)
    whole = whole_of(data, spaces)
    found: list[Assessment] = []
    for standard in standards:
        each = [_of_space(standard, space, alone=len(spaces) == 1) for space in spaces]
        found += each
        if len(spaces) > 1:
            found.append(_of_all(standard, whole, each))
    return tuple(found)


def _of_space(standard: Standard, space: Space, *, alone: bool) -> Assessment:
    verdicts = tuple(
        replace(verdict(one, space), level=UNKNOWN, levels=(), replicates=())
        if one.of_the_whole and not alone
        else verdict(one, space)
        for one in standard.criteria
    )
    found = [line for check in standard.checks for line in check(space)]
    area = float(space.area.sum())
    return Assessment(standard.name, space.name, area, verdicts, tuple(found))


def _of_all(standard: Standard, whole: Space, each: Sequence[Assessment]) -> Assessment:
    verdicts = []
    for number, criterion in enumerate(standard.criteria):
        if criterion.combination == "by area":
            verdicts.append(verdict(criterion, whole))
        else:
            verdicts.append(_lowest([one.verdicts[number] for one in each]))
    area = float(whole.area.sum())
    return Assessment(standard.name, WHOLE, area, tuple(verdicts))


def verdict(criterion: Criterion, space: Space) -> Verdict:
    """Return the level of a space in one criterion."""
    quantities = tuple(criterion.quantities(space))
    values = [quantity.value for quantity in quantities]
    if not quantities or np.isnan(values).any():
        return Verdict(criterion.name, UNKNOWN, criterion.levels, quantities)
    counts = [len(q.replicates) for q in quantities if q.replicates]
    varied = [
        criterion.level([_varied(q, k) for q in quantities], space)
        for k in range(min(counts, default=0))
    ]
    level = criterion.level(values, space)
    return Verdict(criterion.name, level, criterion.levels, quantities, tuple(varied))


def _varied(quantity: Quantity, number: int) -> float:
    # Value of a replicate; quantities without replicates have no error
    return quantity.replicates[number] if quantity.replicates else quantity.value


def _lowest(verdicts: Sequence[Verdict]) -> Verdict:
    # Verdict of the lowest space, in the estimate and in every replicate
    first = verdicts[0]
    level = min(one.level for one in verdicts)
    counts = [len(one.replicates) for one in verdicts if one.replicates]
    varied = [
        min(one.replicates[k] if one.replicates else one.level for one in verdicts)
        for k in range(min(counts, default=0))
    ]
    return Verdict(
        first.criterion, level, first.levels, (), tuple(varied if level >= 0 else ())
    )


def levels_reached(values: Sequence[float], limits: Sequence[float]) -> int:
    """Return how many limits are reached one after the other.

    >>> levels_reached([80.0, 60.0, 20.0], [50.0, 50.0, 50.0])
    2
    """
    pairs = zip(values, limits, strict=True)
    reached = [value >= limit - 1e-9 for value, limit in pairs]
    return [*reached, False].index(False)
