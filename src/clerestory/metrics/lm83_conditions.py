"""Requirements of IES LM-83 that a simulation fulfils or does not fulfil.

sDA, ASE and the LEED points that follow from them are defined for a horizontal grid of
sensors at most 2 ft apart, 30 in above the floor, for 8 to 18 h on every day of a year
in steps of an hour or less, and for blinds that close whenever more than 2 % of the
sensors of a space receive 1000 lux or more of direct sunlight.

Reference: IES LM-83-12, Approved Method: spatial daylight autonomy and
annual sunlight exposure; USGBC, LEED v4 and v4.1, EQ credit Daylight.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from clerestory.metrics.compliance import Check, Requirement
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.metrics.procedure import (
    confirmed_by_hand,
    grid_facing_up,
    grid_height,
    grid_spacing_limit,
    requirement,
    typical_weather,
    whole_year,
)
from clerestory.metrics.space import Space
from clerestory.metrics.spatial_metrics import SUN_LUX

FROM_HOUR, TO_HOUR = 8.0, 18.0
MOST_SENSORS = 0.02

# Height [m] of the grid, 30 in; largest spacing [m], 2 ft with a tolerance for rounding
HEIGHT = 0.76
LARGEST_SPACING = 0.61


def departures(
    data: xr.Dataset, *, from_hour: float = FROM_HOUR, to_hour: float = TO_HOUR
) -> tuple[str, ...]:
    """Return the departures from LM-83 of the results of one grid, in words.

    `data` are results of a run, see `Results.data`, for the sensors of one grid.
    """
    equal = np.ones(data.sizes.get("sensor", 0))
    space = Space("", data, equal, from_hour, to_hour)
    found = [line for check in _MEASURED for line in check(space)]
    return tuple(line.departure for line in found if line.status == "not fulfilled")


def schedule(space: Space) -> Iterator[Requirement]:
    """Check that the evaluated hours are those of LM-83."""
    start, end = space.from_hour, space.to_hour
    yield requirement(
        "Hours of the day",
        (start, end) == (FROM_HOUR, TO_HOUR),
        f"hours from {start:g} to {end:g}",
        expected="8 to 18",
        change="evaluate the hours from 8 to 18",
    )


def blinds_of_lm83(space: Space) -> Iterator[Requirement]:
    """Check that blinds are operated by direct sunlight on the sensors of the space."""
    data, rules = space.data, _rules(space.data)
    change = 'give [window.control] rule = "LM-83", without when_empty and own limits'
    wrong = {
        window: rule for window, rule in rules.items() if rule not in ("", "LM-83")
    }
    for window, rule in wrong.items():
        yield requirement(
            "Operation of the blinds",
            False,
            f'shades of window "{window}" by rule "{rule}"',
            expected='rule "LM-83"',
            change=change,
        )
    if rules and not wrong and any(rules.values()):
        yield requirement(
            "Operation of the blinds",
            True,
            'shades by rule "LM-83"',
            expected='rule "LM-83"',
            change=change,
        )
    tables = _control_tables(space)
    for table in tables:
        limit = table.get("sun_lux", SUN_LUX), table.get("most_sensors", MOST_SENSORS)
        if limit != (SUN_LUX, MOST_SENSORS):
            yield requirement(
                "Limits of the blinds",
                False,
                f"blinds that close for more than {limit[1]:.3g} of the sensors above"
                f" {limit[0]:g} lux",
                expected="0.02 above 1000 lux",
                change="remove sun_lux and most_sensors from [window.control]",
            )
    if any(table.get("when_empty") is not None for table in tables):
        empty = int((space.hours & ~data["occupied"].values).sum())
        if empty:
            yield requirement(
                "Hours of the blinds",
                False,
                f'{empty} of the hours with "when_empty"',
                expected="none",
                change="remove when_empty from [window.control], or widen [schedule]",
            )
    yield from _own_sensors(space, tables)
    yield from _without_shades(space, rules)


def _own_sensors(space: Space, tables: list[dict[str, Any]]) -> Iterator[Requirement]:
    # Blinds of a space must be operated by the sensors of this space
    if "space" not in space.data or not tables:
        return
    own = set(space.data["grid"].values.astype(str))
    several = len(space.study.get("sensors", ())) > 1
    foreign = [t.get("grid") or "all" for t in tables]
    wrong = [grid for grid in foreign if several and {grid} != own]
    yield requirement(
        "Sensors of the blinds",
        not wrong,
        f"blinds by the sensors of {' and '.join(sorted(set(foreign)))}",
        expected=f"those of {' and '.join(sorted(own))}",
        change=f'name the grid of the space in [window.control]: grid = "{min(own)}"',
    )


def _without_shades(space: Space, rules: dict[str, str]) -> Iterator[Requirement]:
    # Without shades, no more than 2 % of the sensors may ever be in direct sunlight
    data = space.data
    if rules and not any(rules.values()) and "direct_open" in data:
        hours = occupied_hours(data["time"].values)
        sunny = (data["direct_open"].values >= SUN_LUX).mean(axis=0) > MOST_SENSORS
        count = int(np.sum(sunny & hours))
        yield requirement(
            "Blinds",
            not count,
            f"no shades in {count} hours with more than 2 % of the sensors in direct"
            " sunlight",
            expected="blinds",
            change="give the windows states of a blind, and [window.control] rule ="
            ' "LM-83"',
        )


def exact_sun(space: Space) -> Iterator[Requirement]:
    """Check that direct sunlight is known from exact positions of the sun."""
    known = space.sun is not None
    yield requirement(
        "Direct sunlight",
        known,
        "the sun at its position" if known else "no direct sun, or in sky patches",
        expected="the sun at its position",
        change='use method = "5-phase" or "6-phase", or "2-phase" with the exact sun',
    )


def _rules(data: xr.Dataset) -> dict[str, str]:
    # Control rule of each window with several states; "" without shades
    if "window" not in data:
        return {}
    names = data["window"].values.astype(str).tolist()
    if "control" not in data:
        return dict.fromkeys(names, "")
    several = (data["state_name"].values != "").sum(axis=1) > 1
    rules = np.where(several, data["control"].values, "").tolist()
    return dict(zip(names, map(str, rules), strict=True))


def _control_tables(space: Space) -> list[dict[str, Any]]:
    # Tables [window.control] of rule "LM-83" in the study, for windows of the space
    names = (
        set(space.data["window"].values.astype(str)) if "window" in space.data else ()
    )
    tables = []
    for window in space.study.get("window", ()):
        table = window.get("control") or {}
        owner = str(window.get("name") or Path(str(window.get("file", ""))).stem)
        known = any(n == owner or n.startswith(f"{owner}.") for n in names)
        if table.get("rule") == "LM-83" and (known or not owner):
            tables.append(table)
    return tables


_MEASURED: tuple[Check, ...] = (
    schedule,
    whole_year,
    grid_spacing_limit(LARGEST_SPACING, "0.6 m (2 ft)"),
    grid_facing_up,
    blinds_of_lm83,
)

CHECKS: tuple[Check, ...] = (
    *_MEASURED,
    grid_height(HEIGHT),
    exact_sun,
    typical_weather,
    confirmed_by_hand(
        "Furniture", expected="furniture and partitions in the model of the room"
    ),
)
