"""Standards of daylight as tables: LM-83, LEED, EN 17037 and BREEAM.

Each entry of `STANDARDS` is a standard with its criteria and the requirements of its
procedure. The formulas are those of the modules on each standard.
"""

from collections.abc import Sequence
from functools import partial

from clerestory.checks import one_of
from clerestory.metrics import breeam_quantities, en17037, en17037_quantities
from clerestory.metrics.compliance import (
    Check,
    Criterion,
    Quantity,
    Standard,
    levels_reached,
)
from clerestory.metrics.en17037 import LEVELS, sunlight_level
from clerestory.metrics.leed import Version, simulated_daylight
from clerestory.metrics.lm83_conditions import CHECKS as LM83_CHECKS
from clerestory.metrics.lm83_quantities import (
    autonomy,
    exposure,
    glare_statement,
    lowest_autonomy,
)
from clerestory.metrics.procedure import (
    confirmed_by_hand,
    grid_facing_up,
    grid_height,
    grid_spacing_en17037,
    typical_weather,
    whole_year,
)
from clerestory.metrics.space import Space

# Areas with sufficient daylight and with too much sunlight in LM-83-12 [%]
_AUTONOMY = (55.0, 75.0)
_EXPOSURE = (10.0, 7.0, 3.0)

_LM83 = (
    Criterion(
        "Spatial daylight autonomy",
        ("not accepted", "nominally accepted", "preferred"),
        lambda space: autonomy(space, "55 % nominally accepted, 75 % preferred"),
        lambda values, _: sum(values[0] >= limit - 1e-9 for limit in _AUTONOMY),
    ),
    Criterion(
        "Annual sunlight exposure",
        (
            "unsatisfactory visual comfort",
            "below the limit",
            "nominally acceptable",
            "clearly acceptable",
        ),
        lambda space: exposure(space, "at most 10 %; 7 % nominally, 3 % clearly"),
        lambda values, _: sum(values[0] <= limit + 1e-9 for limit in _EXPOSURE),
    ),
)


def _leed(version: Version) -> Standard:
    def quantities(space: Space) -> Sequence[Quantity]:
        steps = "40, 55, 75 %" if version == "v4.1" else "55, 75 %"
        limit = "statement on glare" if version == "v4.1" else "no points"
        shares = (
            *autonomy(space, f"points at {steps}")[:1],
            *exposure(space, f"above 10 %: {limit}")[:1],
        )
        return (*shares, lowest_autonomy(space)) if version == "v4.1" else shares

    def points(values: Sequence[float], _: Space) -> int:
        autonomous, exposed, *lowest = (value / 100 for value in values)
        return simulated_daylight(
            autonomous, exposed, version=version, lowest=min(lowest, default=0.0)
        ).points

    names = ("0 points", "1 point", "2 points", "3 points", "3 points, exemplary")
    criterion = Criterion(
        "Option 1, simulation of daylight autonomy and sunlight exposure",
        names if version == "v4.1" else names[:-1],
        quantities,
        points,
        of_the_whole=True,
    )
    occupied = confirmed_by_hand(
        "Spaces", expected="all regularly occupied spaces, and no others"
    )
    checks: tuple[Check, ...] = (
        *LM83_CHECKS,
        occupied,
        partial(glare_statement, version=version),
    )
    title = f"LEED {version} BD+C, EQ credit Daylight, option 1"
    return Standard(f"LEED {version}", title, (criterion,), checks)


_EN17037 = Standard(
    "EN 17037",
    "EN 17037:2018, Daylight in buildings",
    (
        Criterion(
            "Daylight provision by illuminance (method 2)",
            LEVELS,
            en17037_quantities.provision,
            en17037_quantities.provision_level,
            "lowest space",
        ),
        Criterion(
            "Daylight provision by daylight factor (method 1)",
            LEVELS,
            en17037_quantities.provision_by_factor,
            en17037_quantities.provision_level,
            "lowest space",
        ),
        Criterion(
            "View out",
            LEVELS,
            en17037_quantities.view,
            lambda values, _: levels_reached(values[:3], [75.0] * 3),
            "lowest space",
        ),
        Criterion(
            "Exposure to sunlight",
            LEVELS,
            en17037_quantities.sunlight,
            lambda values, _: sunlight_level(values[0]),
            "lowest space",
        ),
        Criterion(
            "Protection from glare",
            LEVELS,
            en17037_quantities.glare,
            lambda values, _: sum(
                values[0] <= limit + 1e-9 for limit in en17037.GLARE_LIMITS
            ),
            "lowest space",
        ),
    ),
    (
        whole_year,
        typical_weather,
        grid_spacing_en17037,
        grid_height(0.85),
        grid_facing_up,
        en17037_quantities.inputs_of_criteria,
        confirmed_by_hand(
            "Edge of the grid", expected="no sensors within 0.5 m of the walls"
        ),
        confirmed_by_hand(
            "Surroundings", expected="buildings opposite in the model, for the view"
        ),
        confirmed_by_hand(
            "Glazing", expected="clear, undistorted and neutral glazing, for the view"
        ),
    ),
)

_BREEAM = Standard(
    "BREEAM",
    "BREEAM UK New Construction 2018, Hea 01, daylighting",
    (
        Criterion(
            "Illuminance",
            ("not met", "met"),
            breeam_quantities.illuminance,
            breeam_quantities.illuminance_level,
            "lowest space",
        ),
        Criterion(
            "Daylight factor",
            ("not met", "met"),
            breeam_quantities.factors,
            breeam_quantities.factor_level,
            "lowest space",
        ),
    ),
    (
        whole_year,
        typical_weather,
        grid_height(0.70),
        grid_facing_up,
        breeam_quantities.inputs_of_criteria,
        confirmed_by_hand(
            "Spaces", expected="80 % of the floor area of relevant spaces"
        ),
    ),
)

# LM-83-23 is ANSI/IES LM-83-22, published in 2023
STANDARDS = {
    standard.name: standard
    for standard in (
        Standard(
            "LM-83-12",
            "IES LM-83-12, spatial daylight autonomy and annual sunlight exposure",
            _LM83,
            LM83_CHECKS,
        ),
        Standard(
            "LM-83-23",
            "ANSI/IES LM-83-22 (2023), spatial daylight autonomy and annual sunlight"
            " exposure",
            _LM83,
            (
                *LM83_CHECKS,
                confirmed_by_hand(
                    "Edition",
                    expected="the limits and conditions of the edition of 2023, for"
                    " which those of 2012 are used here,",
                ),
            ),
        ),
        _leed("v4"),
        _leed("v4.1"),
        _EN17037,
        _BREEAM,
    )
}

# Short names of standards
ALIASES = {"LM-83": "LM-83-12", "LM-83-22": "LM-83-23"}


def standards_named(names: Sequence[str]) -> tuple[Standard, ...]:
    """Return the standards of the given names, each once.

    >>> [standard.name for standard in standards_named(["LM-83", "LEED v4.1"])]
    ['LM-83-12', 'LEED v4.1']
    """
    chosen = [ALIASES.get(name, name) for name in names]
    for name in chosen:
        one_of(name, "standard", choices=[*STANDARDS, *ALIASES])
    return tuple(STANDARDS[name] for name in dict.fromkeys(chosen))
