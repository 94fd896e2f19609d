"""Output of comparisons as CSV tables and JSON."""

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from clerestory.comparison.agreement import LIMITS, Agreement
from clerestory.comparison.series import UNITS
from clerestory.comparison.series_comparison import Comparison
from clerestory.files import write_text

_STATISTICS = (
    "pairs",
    "gaps",
    "not simulated",
    "too dark",
    "measured mean",
    "simulated mean",
    "MBE",
    "MBE [%]",
    "RMSE",
    "CV(RMSE) [%]",
    "median deviation [%]",
    "correlation",
    *(f"within {100 * limit:g} % [%]" for limit in LIMITS),
)


def shares_table(comparisons: Sequence[Comparison]) -> list[list[str]]:
    """Return a table of the fractions of pairs with deviations within the limits.

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
    """Return a table of all statistics, first of the groups, then of the series."""
    rows = [["simulation", "series", "quantity", "unit", *_STATISTICS]]
    for comparison in comparisons:
        for (group, quantity), found in comparison.table().items():
            rows.append([comparison.name, group, quantity, UNITS[quantity]])
            rows[-1] += _figures(found, ("", "", ""))
        pairs = comparison.pairs
        for name, found in comparison.series().items():
            number = pairs.names.index(name)
            counted = pairs.gaps, pairs.outside, comparison.below
            gaps, outside, below = (str(int(each[number])) for each in counted)
            rows.append([comparison.name, name, "", ""])
            rows[-1] += _figures(found, (gaps, outside, below))
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
    """Return the results of a comparison, without pairs, as a JSON-compatible dict."""
    pairs = comparison.pairs
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
            {
                "name": name,
                **_plain(found),
                "gaps": int(pairs.gaps[pairs.names.index(name)]),
                "not_simulated": int(pairs.outside[pairs.names.index(name)]),
                "too_dark": int(comparison.below[pairs.names.index(name)]),
            }
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


def _figures(found: Agreement, counted: tuple[str, str, str]) -> list[str]:
    means = (found.measured, found.simulated)
    return [
        str(found.count),
        *counted,
        *(f"{value:.5g}" for value in means),
        f"{found.mean_bias:.4g}",
        f"{100 * found.relative_bias:.1f}",
        f"{found.rmse:.4g}",
        f"{100 * found.variation:.1f}",
        f"{100 * found.median_deviation:.1f}",
        "" if np.isnan(found.correlation) else f"{found.correlation:.4f}",
        *_shares(found),
    ]


def _pair_rows(comparisons: Sequence[Comparison]) -> list[list[str]]:
    rows = [["simulation", "series", "time", "measured", "simulated", "standard error"]]
    for comparison in comparisons:
        for name in comparison.series():
            one = comparison.pairs.of(name)
            values = zip(one.times, one.measured, one.simulated, one.error, strict=True)
            rows += [
                [comparison.name, name, str(time), f"{m:.6g}", f"{s:.6g}", _known(e)]
                for time, m, s, e in values
            ]
    return rows


def _known(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.3g}"


def _write_csv(path: Path, rows: list[list[str]]) -> None:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    write_text(path, text.getvalue())
