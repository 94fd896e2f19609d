"""Quantities of the criteria of BREEAM Hea 01 of a space."""

from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr

from clerestory.metrics.breeam import (
    MEAN_FACTOR,
    UNIFORMITY,
    factors_pass,
    illuminance_criterion,
)
from clerestory.metrics.breeam_space_types import (
    OFFICE,
    IlluminanceLimits,
    space_type,
)
from clerestory.metrics.compliance import Quantity, Requirement
from clerestory.metrics.daylight_factor import DaylightFactors, room_factors
from clerestory.metrics.en17037_quantities import factor_components
from clerestory.metrics.procedure import requirement
from clerestory.metrics.replicates import hourly_replicates, replicates
from clerestory.metrics.space import Space


def type_of(space: Space) -> str:
    """Return the name of the space type: `breeam_type` of [[space]], or offices."""
    for table in space.study.get("space", ()):
        if table.get("name") == space.name:
            return str(table.get("breeam_type", OFFICE))
    return OFFICE


def illuminance(space: Space) -> Sequence[Quantity]:
    """Return the hours in which mean and lowest illuminance reach their limits."""
    limits = _limits(space)

    def hours(lux: xr.DataArray) -> tuple[float, float]:
        found = illuminance_criterion(
            lux,
            mean_lux=limits.mean_lux,
            worst_lux=limits.worst_lux,
            hours=limits.hours,
            step_hours=space.step_hours,
        )
        return found.mean_hours, found.worst_hours

    value = hours(space.data["illuminance"])
    varied = [hours(lux) for lux in hourly_replicates(space.data)]
    names = [f"mean illuminance of {limits.mean_lux:.0f} lux"]
    if limits.worst_lux:
        names.append(f"lowest illuminance of {limits.worst_lux:.0f} lux")
    expected = f"{limits.hours:.0f} h"
    return tuple(
        Quantity(name, value[k], "h", expected, tuple(v[k] for v in varied))
        for k, name in enumerate(names)
    )


def illuminance_level(values: Sequence[float], space: Space) -> int:
    """Level 1 if both illuminances reach their limits for enough hours, otherwise 0."""
    return int(min(values) >= _limits(space).hours)


def _limits(space: Space) -> IlluminanceLimits:
    # Limits of the fewest credits
    return space_type(type_of(space)).limits[-1]


def factors(space: Space) -> Sequence[Quantity]:
    """Return mean, uniformity and minimum of the daylight factor.

    The limits of other space types than offices are not known: no quantities.
    """
    if type_of(space) != OFFICE:
        return ()
    rows = (
        ("mean daylight factor", 100, "%", f"{100 * MEAN_FACTOR:g} %"),
        ("uniformity", 1, "", f"{UNIFORMITY:g}, or"),
        ("lowest daylight factor", 100, "%", f"{100 * UNIFORMITY * MEAN_FACTOR:g} %"),
    )
    if "daylight_factor" not in space.data:
        return tuple(Quantity(n, np.nan, unit, limit) for n, _, unit, limit in rows)
    value, *varied = _factors(space.data)
    return tuple(
        Quantity(n, scale * value[k], unit, limit, tuple(scale * v[k] for v in varied))
        for k, (n, scale, unit, limit) in enumerate(rows)
    )


def factor_level(values: Sequence[float], _: Space) -> int:
    """Level 1 if mean, and uniformity or minimum, reach their limits, otherwise 0."""
    mean, uniformity, lowest = values[0] / 100, values[1], values[2] / 100
    return int(factors_pass(DaylightFactors(mean, mean, lowest, uniformity)))


def inputs_of_criteria(space: Space) -> Iterator[Requirement]:
    """Check that the results contain daylight factors."""
    known = "daylight_factor" in space.data
    yield requirement(
        "Daylight factors",
        known,
        "daylight factors" if known else "no daylight factors",
        expected="daylight factors under the overcast sky",
        change='name "BREEAM" in standards of [compliance] and run the study again',
    )


def _factors(data: xr.Dataset) -> Iterator[tuple[float, float, float]]:
    # Mean, uniformity and minimum; of the estimate first, then of its replicates
    factor = data["daylight_factor"].expand_dims("time", axis=1)
    error = data["daylight_factor_error"].expand_dims("time", axis=1)
    each = replicates(factor, error, factor_components(data))
    for one in (factor, *each):
        room = room_factors(one.values[:, 0].astype(float))
        yield room.mean, room.uniformity, room.minimum
