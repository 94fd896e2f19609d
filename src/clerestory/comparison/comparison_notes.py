"""What a reader must know about how a comparison was made, in sentences."""

import numpy as np

from clerestory.comparison.clock_offset import Offset
from clerestory.comparison.series_comparison import Comparison

_SHOWN = 8


def comparison_notes(comparison: Comparison) -> list[str]:
    """Return what counted, what was left out, what was done to the times."""
    rules = comparison.rules
    notes = [
        *_counted(comparison),
        f"Simulated steps of {comparison.step_minutes:g} min. Finer values are averaged"
        f" over coarser steps that are filled to {100 * rules.coverage:g} %; the"
        " simulation is interpolated to moments between the middles of its steps.",
    ]
    if rules.shift_minutes:
        minutes = f"{rules.shift_minutes:+g} min"
        notes.append(f"Measured times were moved by {minutes}, as asked.")
    if comparison.years_ignored:
        notes.append(
            "The weather has no year in common with the measurement: month, day and"
            " time of day were matched."
        )
    notes += [_clock(kind, offset) for kind, offset in comparison.offset.items()]
    if comparison.unmatched:
        more = len(comparison.unmatched) - _SHOWN
        shown = ", ".join(comparison.unmatched[:_SHOWN])
        shown += f" and {more} more" if more > 0 else ""
        notes.append(f"Measured, but not simulated: {shown}.")
    return notes


def _counted(comparison: Comparison) -> list[str]:
    pairs = comparison.pairs
    notes = [
        f"{pairs.measured.size} pairs of measured values above"
        f" {comparison.rules.above_lux:g} lux (glare indices: above 0);"
        f" {int(comparison.below.sum())} darker ones left out;"
        f" {int(pairs.gaps.sum())} gaps in what was measured;"
        f" {int(pairs.outside.sum())} values at times that were not simulated."
    ]
    known = ~np.isnan(pairs.error) & (pairs.simulated > 0)
    if np.any(known):
        share = float(np.mean(pairs.error[known] / pairs.simulated[known]))
        notes.append(
            f"Simulated values have a standard error of {100 * share:.2g} % on average."
        )
    return notes


def _clock(quantity: str, offset: Offset) -> str:
    told = (
        f"Clock check of {quantity}: CV(RMSE) {100 * offset.rmse_unmoved:.1f} % as it"
        f" stands; least, {100 * offset.rmse:.1f} %, with measured times moved by"
        f" {offset.minutes:+d} min. Nothing was moved."
    )
    return told + (" That is much: is one clock wrong?" if offset.matters else "")
