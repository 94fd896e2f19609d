"""Output of comparisons: notes of the report, CSV tables and JSON."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from clerestory.comparison.series import UNITS
from clerestory.comparison.series_comparison import Comparison, Offset
from clerestory.escaping import csv_line
from clerestory.files import write_text
from clerestory.metrics.agreement import LIMITS, Agreement

# Columns of the table that compares simulation and measurement
_STATISTICS: dict[str, Callable[[Agreement], str]] = {
    "measured mean": lambda found: f"{found.measured:.5g}",
    "simulated mean": lambda found: f"{found.simulated:.5g}",
    "MBE": lambda found: f"{found.mean_bias:.4g}",
    "MBE [%]": lambda found: f"{100 * found.relative_bias:.1f}",
    "RMSE": lambda found: f"{found.rmse:.4g}",
    "CV(RMSE) [%]": lambda found: f"{100 * found.variation:.1f}",
    "median deviation [%]": lambda found: f"{100 * found.median_deviation:.1f}",
    "correlation": lambda found: _known(found.correlation, ".4f"),
}

# Largest number of names listed in a note
_SHOWN = 8


def shares_table(comparisons: Sequence[Comparison]) -> list[list[str]]:
    """Return a table of the fractions of values with deviations below 5, 10 and 20 %.

    The first row is the header. Each further row is for one group (grid or view) and
    quantity, with columns for each simulation.
    """
    head = ["group", "quantity", "pairs"]
    for comparison in comparisons:
        head += [f"{comparison.name}: Δ < {100 * limit:g} %" for limit in LIMITS]
    tables = [comparison.table() for comparison in comparisons]
    rows = [head]
    for kind in dict.fromkeys(kind for table in tables for kind in table):
        found = [table.get(kind) for table in tables]
        count = max((each.count for each in found if each), default=0)
        row = [*kind, str(count)]
        for each in found:
            row += [""] * len(LIMITS) if each is None else _shares(each)
        rows.append(row)
    return rows


def statistics_table(comparisons: Sequence[Comparison]) -> list[list[str]]:
    """Return a table of statistics with one row per group, then one row per series."""
    counts = ["pairs", "gaps", "not simulated", "too dark"]
    within = [f"within {100 * limit:g} % [%]" for limit in LIMITS]
    rows = [["simulation", "series", "quantity", "unit"]]
    rows[0] += [*counts, *_STATISTICS, *within]
    for comparison in comparisons:
        for (group, quantity), found in comparison.table().items():
            rows.append([comparison.name, group, quantity, UNITS[quantity]])
            rows[-1] += [str(found.count), "", "", "", *_figures(found)]
        for name, found in comparison.series().items():
            excluded = map(str, comparison.excluded(name).values())
            rows.append([comparison.name, name, "", ""])
            rows[-1] += [str(found.count), *excluded, *_figures(found)]
    return rows


def write_tables(comparisons: Sequence[Comparison], folder: Path) -> None:
    """Write `shares.csv`, `statistics.csv`, `pairs.csv` and `comparison.json`."""
    _write_csv(folder / "shares.csv", shares_table(comparisons))
    _write_csv(folder / "statistics.csv", statistics_table(comparisons))
    _write_csv(folder / "pairs.csv", _pair_rows(comparisons))
    facts = [comparison_facts(comparison) for comparison in comparisons]
    text = json.dumps(facts, indent=2, ensure_ascii=False, allow_nan=False)
    write_text(folder / "comparison.json", text + "\n")


def comparison_facts(comparison: Comparison) -> dict[str, Any]:
    """Return the statistics of a comparison as a dict for JSON, without the values."""
    return {
        "simulation": comparison.name,
        "rules": asdict(comparison.rules),
        "limits": list(LIMITS),
        "deviation": "simulated minus measured, relative to measured",
        "years_ignored": comparison.years_ignored,
        "step_minutes": comparison.step_minutes,
        "unmatched": list(comparison.unmatched),
        "offset_not_applied": {k: asdict(o) for k, o in comparison.offset.items()},
        "groups": [
            {"group": group, "quantity": quantity, **_plain(found)}
            for (group, quantity), found in comparison.table().items()
        ],
        "series": [
            {"name": name, **_plain(found), **comparison.excluded(name)}
            for name, found in comparison.series().items()
        ],
    }


def _plain(found: Agreement) -> dict[str, Any]:
    # Replace NaN by None, since JSON has no NaN
    return {
        key: None if isinstance(value, float) and np.isnan(value) else value
        for key, value in asdict(found).items()
    }


def _shares(found: Agreement) -> list[str]:
    return [f"{100 * share:.1f}" for share in found.within]


def _figures(found: Agreement) -> list[str]:
    return [*(show(found) for show in _STATISTICS.values()), *_shares(found)]


def _pair_rows(comparisons: Sequence[Comparison]) -> list[list[str]]:
    rows = [["simulation", "series", "time", "measured", "simulated", "standard error"]]
    for comparison in comparisons:
        for name in comparison.series():
            one = comparison.pairs.of(name)
            values = zip(one.times, one.measured, one.simulated, one.error, strict=True)
            rows += [
                [
                    comparison.name,
                    name,
                    str(t),
                    f"{m:.6g}",
                    f"{s:.6g}",
                    _known(e, ".3g"),
                ]
                for t, m, s, e in values
            ]
    return rows


def _known(value: float, form: str) -> str:
    return "" if np.isnan(value) else f"{value:{form}}"


def _write_csv(path: Path, rows: list[list[str]]) -> None:
    write_text(path, "".join(f"{csv_line(row)}\n" for row in rows))


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
