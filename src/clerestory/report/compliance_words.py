"""Verdicts, quantities and requirements of standards as text."""

from collections.abc import Iterator, Sequence

import numpy as np

from clerestory.metrics.compliance import Assessment, Quantity, Requirement, Verdict
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

    >>> verdict_words(Verdict("sDA", 1, ("none", "some", "much"), (), (1, 2)))
    'some, ± 0.5 levels: possibly much'
    """
    if not verdict.error:
        return verdict.words
    others = sorted({level for level in verdict.replicates if level != verdict.level})
    names = " or ".join(verdict.levels[level] for level in others)
    return f"{verdict.words}, ± {verdict.error:.1g} levels: possibly {names}"


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
