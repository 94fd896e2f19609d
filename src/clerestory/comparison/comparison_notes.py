"""Notes on a comparison, as sentences of the report."""

import numpy as np

from clerestory.comparison.clock_offset import Offset
from clerestory.comparison.series_comparison import Comparison

_SHOWN = 8


def comparison_notes(comparison: Comparison) -> list[str]:
    """Return notes on included and excluded values and on time alignment."""
    rules = comparison.rules
    notes = [
        *_counted(comparison),
        f"Simulated steps of {comparison.step_minutes:g} min. Finer values are averaged"
        f" over coarser steps with a coverage of at least {100 * rules.coverage:g} %;"
        " for instantaneous measurements the simulation is interpolated between the"
        " centres of its steps.",
    ]
    if rules.shift_minutes:
        minutes = f"{rules.shift_minutes:+g} min"
        notes.append(f"Measured times were shifted by {minutes}, as requested.")
    if comparison.years_ignored:
        notes.append(
            "The weather and the measurement have no year in common: month, day and"
            " time of day were matched."
        )
    notes += [_clock(kind, offset) for kind, offset in comparison.offset.items()]
    if comparison.unmatched:
        more = len(comparison.unmatched) - _SHOWN
        shown = ", ".join(comparison.unmatched[:_SHOWN])
        shown += f" and {more} more" if more > 0 else ""
        notes.append(f"Measured but not simulated: {shown}.")
    return notes


def _counted(comparison: Comparison) -> list[str]:
    pairs = comparison.pairs
    notes = [
        f"{pairs.measured.size} pairs of measured values above"
        f" {comparison.rules.above_lux:g} lux (glare indices: above 0);"
        f" {int(comparison.below.sum())} smaller ones were excluded;"
        f" {int(pairs.gaps.sum())} measured values are missing;"
        f" {int(pairs.outside.sum())} are at times that were not simulated."
    ]
    known = ~np.isnan(pairs.error) & (pairs.simulated > 0)
    if np.any(known):
        share = float(np.mean(pairs.error[known] / pairs.simulated[known]))
        notes.append(
            f"Simulated values have a standard error of {100 * share:.2g} % on average."
        )
    return notes


def _clock(quantity: str, offset: Offset) -> str:
    note = (
        f"Clock check of {quantity}: CV(RMSE) is {100 * offset.rmse_unmoved:.1f} %, and"
        f" {100 * offset.rmse:.1f} % at best, with measured times shifted by"
        f" {offset.minutes:+d} min. This shift was not applied."
    )
    return note + (" It is large: is one clock wrong?" if offset.matters else "")
