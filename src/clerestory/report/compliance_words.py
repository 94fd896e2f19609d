"""Verdicts, quantities and requirements of standards as text."""

from collections.abc import Iterator, Sequence

import numpy as np

from clerestory.metrics.compliance import Assessment, Quantity, Requirement, Verdict
from clerestory.metrics.en17037 import (
    LEVELS,
    MINIMUM_AREA,
    MINIMUM_LUX,
    TARGET_AREA,
    TARGET_LUX,
    DaylightProvision,
)
from clerestory.report.uncertain_value import Figure

# Distances of the view above which it is unobstructed [m]
_FAR = 1e5


def quantity_words(quantity: Quantity) -> str:
    """Return the value of a quantity with its standard error and unit.

    >>> quantity_words(Quantity("sDA", 61.7, "%", "55 %", (60.7, 62.7)))
    '62 ± 1 %'
    """
    if np.isnan(quantity.value):
        return "not known"
    if quantity.unit == "m" and quantity.value > _FAR:
        return "unobstructed"
    shown = str(Figure(quantity.value, quantity.error, quantity.unit)).strip()
    return shown.replace(" °", "°")


def verdict_words(verdict: Verdict) -> str:
    """Return a verdict with the standard error of its level, if it has one.

    >>> verdict_words(Verdict("sDA", 1, ("little", "some", "much"), (), (1, 2)))
    'some, ± 0.5 levels: possibly much'
    >>> verdict_words(Verdict("view out", 0, ("none", "minimum")))
    'no level reached'
    """
    words = _level_name(verdict.words)
    if not verdict.error:
        return words
    others = sorted({level for level in verdict.replicates if level != verdict.level})
    names = " or ".join(_level_name(verdict.levels[level]) for level in others)
    return f"{words}, ± {verdict.error:.1g} levels: possibly {names}"


def _level_name(name: str) -> str:
    # "Protection from glare: none" would also mean that there is no glare
    return "no level reached" if name == LEVELS[0] else name


def level_words(level: int) -> str:
    """Return a level 0…3 of EN 17037 in words.

    >>> level_words(0), level_words(2)
    ('no level', 'level medium')
    """
    return f"level {LEVELS[level]}" if level else "no level"


def provision_words(provision: DaylightProvision) -> str:
    """Return the daylight provision by EN 17037: its level, and areas of the next one.

    >>> from clerestory.metrics.spatial_metrics import RoomShare
    >>> target, least = (tuple(map(RoomShare, x)) for x in ((0.3, 0, 0), (1, 0.9, 0)))
    >>> words = provision_words(DaylightProvision(target, least, 0, 1))
    >>> words[:73]
    'no level; level minimum needs 300 lux on 50 % of the area (found: 30 %) a'
    """
    level = provision.level
    wanted = min(level + 1, len(LEVELS) - 1)
    target, minimum = (
        f"{lux[wanted - 1]:.0f} lux on {100 * least:.0f} % of the area"
        f" (found: {100 * share[wanted - 1].value:.0f} %)"
        for lux, least, share in (
            (TARGET_LUX, TARGET_AREA, provision.target),
            (MINIMUM_LUX, MINIMUM_AREA, provision.minimum),
        )
    )
    which = level_words(wanted) if level < wanted else "it"
    return f"{level_words(level)}; {which} needs {target} and {minimum}"


def assessment_lines(assessments: Sequence[Assessment]) -> Iterator[str]:
    """Yield lines of text on assessments, with requirements that are not fulfilled."""
    for one in assessments:
        yield f"{one.standard}, {one.space} ({one.area:.1f} m²)"
        for verdict in one.verdicts:
            yield f"  {verdict.criterion}: {verdict_words(verdict)}".rstrip(": ")
            for quantity in verdict.quantities:
                limits = f" ({quantity.limits})" if quantity.limits else ""
                yield f"    {quantity.name}: {quantity_words(quantity)}{limits}"
        for line in one.requirements:
            if line.status == "not fulfilled":
                yield f"  not fulfilled: {line.departure}; to do: {line.change}"


def grouped_requirements(
    assessments: Sequence[Assessment],
) -> list[tuple[Requirement, list[str]]]:
    """Return each requirement with its spaces; those not fulfilled come first."""
    order = ("not fulfilled", "not known", "fulfilled")
    spaces: dict[Requirement, list[str]] = {}
    for one in assessments:
        for line in one.requirements:
            spaces.setdefault(line, []).append(one.space)
    return sorted(spaces.items(), key=lambda item: order.index(item[0].status))
