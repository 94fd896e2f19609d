"""Assessments of standards as variables of the results, and read from them again.

Verdicts, quantities and requirements are the rows of three tables with the axes
`verdict`, `quantity` and `requirement`.
"""

from collections.abc import Sequence
from typing import Any, get_args

import numpy as np
import xarray as xr

from clerestory.metrics.compliance import (
    Assessment,
    Quantity,
    Requirement,
    Status,
    Verdict,
)

_BETWEEN = "; "


def compliance_table(assessments: Sequence[Assessment]) -> xr.Dataset:
    """Return assessments as labelled variables; empty without assessments."""
    if not assessments:
        return xr.Dataset()
    verdicts, quantities, lines = [], [], []
    for one in assessments:
        place = (one.standard, one.space)
        for verdict in one.verdicts:
            verdicts.append((*place, one.area, verdict))
            quantities += [(*place, verdict.criterion, q) for q in verdict.quantities]
        lines += [(*place, line) for line in one.requirements]
    widest = max((len(q[3].replicates) for q in quantities), default=0)
    table: dict[str, Any] = {}

    def add(axis: str, name: str, values: list[Any], kind: type) -> None:
        table[f"{axis}_{name}"] = (axis, np.array(values, dtype=kind))

    for axis, rows in (
        ("verdict", verdicts),
        ("quantity", quantities),
        ("requirement", lines),
    ):
        add(axis, "standard", [row[0] for row in rows], str)
        add(axis, "space", [row[1] for row in rows], str)
    add("verdict", "area", [row[2] for row in verdicts], float)
    add("verdict", "criterion", [row[3].criterion for row in verdicts], str)
    add("verdict", "words", [row[3].words for row in verdicts], str)
    add("verdict", "level", [row[3].level for row in verdicts], int)
    add("verdict", "levels", [_BETWEEN.join(row[3].levels) for row in verdicts], str)
    add("verdict", "error", [row[3].error for row in verdicts], float)
    add("quantity", "criterion", [row[2] for row in quantities], str)
    for name, kind in (("name", str), ("unit", str), ("limits", str)):
        add("quantity", name, [getattr(row[3], name) for row in quantities], kind)
    for name in ("value", "error"):
        add("quantity", name, [getattr(row[3], name) for row in quantities], float)
    for name in Requirement._fields:
        add("requirement", name, [getattr(row[2], name) for row in lines], str)
    for axis, rows in (("verdict", verdicts), ("quantity", quantities)):
        values = [_filled(row[3].replicates, widest) for row in rows]
        shape = (f"{axis}", "varied")
        table[f"{axis}_replicates"] = (shape, np.reshape(values, (len(rows), widest)))
    return xr.Dataset(table)


def assessments_of(data: xr.Dataset) -> tuple[Assessment, ...]:
    """Return the assessments in the results of a run; empty without [compliance]."""
    if "verdict_standard" not in data:
        return ()
    names = _texts(data, "verdict_standard"), _texts(data, "verdict_space")
    places = zip(*names, strict=True)
    return tuple(_assessment(data, *place) for place in dict.fromkeys(places))


def _assessment(data: xr.Dataset, standard: str, space: str) -> Assessment:
    rows = _rows(data, "verdict", standard, space)
    lines = _rows(data, "requirement", standard, space)
    fields = {name: _texts(data, f"requirement_{name}") for name in Requirement._fields}
    statuses = get_args(Status)
    return Assessment(
        standard,
        space,
        float(data["verdict_area"].values[rows[0]]),
        tuple(_verdict(data, standard, space, row) for row in rows),
        tuple(
            Requirement(**{name: texts[row] for name, texts in fields.items()})  # type: ignore[arg-type]
            for row in lines
            if fields["status"][row] in statuses
        ),
    )


def _verdict(data: xr.Dataset, standard: str, space: str, row: int) -> Verdict:
    criterion = _texts(data, "verdict_criterion")[row]
    levels = _texts(data, "verdict_levels")[row]
    names = tuple(levels.split(_BETWEEN)) if levels else ()
    level = int(data["verdict_level"].values[row])
    of = _texts(data, "quantity_criterion")
    return Verdict(
        criterion,
        level if -1 <= level < max(len(names), 1) else -1,
        names,
        tuple(
            _quantity(data, k)
            for k in _rows(data, "quantity", standard, space)
            if of[k] == criterion
        ),
        tuple(map(int, _known(data["verdict_replicates"].values[row]))),
    )


def _quantity(data: xr.Dataset, row: int) -> Quantity:
    name, unit, limits = (
        _texts(data, f"quantity_{part}")[row] for part in ("name", "unit", "limits")
    )
    value = float(data["quantity_value"].values[row])
    return Quantity(
        name,
        value,
        unit,
        limits,
        tuple(map(float, _known(data["quantity_replicates"].values[row]))),
    )


def _rows(data: xr.Dataset, axis: str, standard: str, space: str) -> list[int]:
    names = _texts(data, f"{axis}_standard"), _texts(data, f"{axis}_space")
    pairs = zip(*names, strict=True)
    return [row for row, pair in enumerate(pairs) if pair == (standard, space)]


def _texts(data: xr.Dataset, name: str) -> list[str]:
    return [str(text) for text in data[name].values]


def _filled(values: Sequence[float], count: int) -> np.ndarray:
    # Values followed by NaN
    return np.append(
        np.array(values, dtype=float), np.full(count - len(values), np.nan)
    )


def _known(values: np.ndarray) -> np.ndarray:
    return np.asarray(values[~np.isnan(values)])
