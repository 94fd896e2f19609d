"""Summary of sensor grids: statistics of each metric, and shares of sensors in ranges.

Files and columns are those that Ladybug Tools' postprocessing package writes.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Shaped
from pydantic import TypeAdapter, ValidationError

from clerestory.checks import require
from clerestory.documents import Item, Number
from clerestory.errors import InputError
from clerestory.escaping import csv_line
from clerestory.files import make_folder, read_text, write_text
from clerestory.metrics.honeybee_writer import GridRecord, write_grids_info

# Values of each sensor, by metric and grid
Metrics = Mapping[str, Mapping[str, Float[np.ndarray, " sensor"]]]


class Range(Item):
    """A range of values, or a combination of ranges."""

    minimum: Number | None = None
    maximum: Number | None = None
    exclusiveMinimum: Number | None = None
    exclusiveMaximum: Number | None = None
    allOf: "tuple[Range, ...]" = ()
    anyOf: "tuple[Range, ...]" = ()

    def holds(
        self, values: Float[np.ndarray, " sensor"]
    ) -> Bool[np.ndarray, " sensor"]:
        """Return which values are in the range."""
        found = np.ones(len(values), dtype=bool)
        for limit, compare in (
            (self.minimum, np.greater_equal),
            (self.maximum, np.less_equal),
            (self.exclusiveMinimum, np.greater),
            (self.exclusiveMaximum, np.less),
        ):
            if limit is not None:
                found &= compare(values, limit)
        for each in self.allOf:
            found &= each.holds(values)
        if self.anyOf:
            found &= np.any([each.holds(values) for each in self.anyOf], axis=0)
        return found

    @property
    def label(self) -> str:
        """Text of the range, such as ">80 and <90"."""
        least = self.minimum if self.minimum is not None else self.exclusiveMinimum
        most = self.maximum if self.maximum is not None else self.exclusiveMaximum
        words = [f">{least:g}"] if least is not None else []
        words += [f"<{most:g}"] if most is not None else []
        words += [each.label for each in self.allOf]
        words += [" or ".join(each.label for each in self.anyOf)] if self.anyOf else []
        return " and ".join(words)


def read_ranges(path: Path | None) -> tuple[Range, ...]:
    """Return the ranges of a file of custom grid metrics; none without a file."""
    if path is None:
        return ()
    try:
        found = TypeAdapter(tuple[Range, ...]).validate_json(read_text(path))
    except ValidationError as error:
        message = "no list of ranges; objects with minimum, maximum, allOf or anyOf"
        raise InputError(f"{message} expected", file=path) from error
    require(all(each.label for each in found), "a range has no limit", file=path)
    return found


def write_metrics(
    folder: Path, grids: Sequence[GridRecord], metrics: Metrics, *, units: str = "%"
) -> None:
    """Write a folder of values for each metric: a file for each grid, to 2 decimals.

    The suffix of the files is the first part of the name of the metric.
    """
    for metric, found in metrics.items():
        suffix = metric.partition("_")[0]
        write_values(folder / metric, grids, found, suffix=suffix)
        kind = {"name": metric, "data_type": "Fraction", "type": "DataType"}
        visible = {"type": "VisualizationMetaData", "data_type": kind, "unit": units}
        limits = {"type": "LegendParameters", "min": 0, "max": 100}
        text = json.dumps(visible | {"legend_parameters": limits}, indent=2)
        write_text(folder / metric / "vis_metadata.json", text)


def write_values(
    folder: Path,
    grids: Sequence[GridRecord],
    values: Mapping[str, Shaped[np.ndarray, " sensor"]],
    *,
    suffix: str,
    digits: int = 2,
) -> None:
    """Write one value a line for each sensor, a file for each grid."""
    write_grids_info(folder, grids)
    for grid in grids:
        lines = (f"{value:.{digits}f}\n" for value in values[grid.full_id])
        path = folder / f"{grid.full_id}.{suffix}"
        make_folder(path.parent)
        write_text(path, "".join(lines))


def write_summary(
    path: Path,
    grids: Sequence[GridRecord],
    metrics: Metrics,
    ranges: Sequence[Range] = (),
) -> None:
    """Write mean, minimum, maximum and uniformity (minimum over mean) of each metric.

    For each range there is the share of the sensors in it [%].
    """
    names = ("Mean", "Minimum", "Maximum", "Uniformity Ratio")
    labels = (*names, *(each.label for each in ranges))
    head = [f"{metric.upper()}-{label}" for metric in metrics for label in labels]
    lines = [csv_line(["Sensor Grid", "Sensor Grid ID", *head])]
    for grid in grids:
        row = []
        for found in metrics.values():
            values = found[grid.full_id]
            mean, least, most = values.mean(), values.min(), values.max()
            row += [mean, least, most, 100 * least / mean if mean > 0 else 0.0]
            row += [100 * each.holds(values).mean() for each in ranges]
        numbers = [f"{value:.2f}" for value in row]
        lines.append(csv_line([grid.name, grid.full_id, *numbers]))
    write_text(path, "\n".join([*lines, ""]))
