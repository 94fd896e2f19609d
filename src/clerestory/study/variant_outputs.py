"""Tables of the figures of merit of several runs: variants.csv and variants.nc."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from clerestory.escaping import csv_line
from clerestory.files import replace_file, write_text
from clerestory.study.results import storable
from clerestory.study.variant_figures import RunFigures, common_keys, figure_rows

TABLE_FILE, DATA_FILE = "variants.csv", "variants.nc"


def write_variants(runs: Sequence[RunFigures], folder: Path) -> None:
    """Write the figures of several runs as a table and as NetCDF."""
    write_text(folder / TABLE_FILE, figures_table(runs))
    content = storable(figures_dataset(runs)).to_netcdf(engine="h5netcdf")
    with replace_file(folder / DATA_FILE) as stream:
        stream.write(content)


def figures_table(runs: Sequence[RunFigures]) -> str:
    """Return a CSV table: a line for each run and figure."""
    axes = list(dict.fromkeys(axis for run in runs for axis in run.settings))
    head = csv_line(["variant", *axes])
    head += ",figure,place,unit,value,standard error,difference,its standard error"
    lines = [head]
    for key in common_keys(runs):
        for run, (own, change) in zip(runs, figure_rows(runs, key), strict=True):
            words = [run.name, *(run.settings.get(axis, "") for axis in axes)]
            numbers = (own.value, own.error, change.value, change.error)
            shown = ",".join(f"{number:.6g}" for number in numbers)
            lines.append(f"{csv_line([*words, *key, own.unit])},{shown}")
    return "\n".join(lines) + "\n"


def figures_dataset(runs: Sequence[RunFigures]) -> xr.Dataset:
    """Return the figures of all runs, over (variant, figure), with their components."""
    keys = common_keys(runs)
    rows = [figure_rows(runs, key) for key in keys]
    count = max(
        (
            len(own.components)
            for row in rows
            for own, _ in row
            if own.components is not None
        ),
        default=0,
    )
    parts = np.full((len(runs), len(keys), count), np.nan)
    table = np.empty((4, len(runs), len(keys)))
    for column, row in enumerate(rows):
        for number, (own, change) in enumerate(row):
            table[:, number, column] = own.value, own.error, change.value, change.error
            if own.components is not None and len(own.components) == count:
                parts[number, column] = own.components
    axes, firsts = ("variant", "figure"), [row[0][0] for row in rows]
    names = ("value", "error", "difference", "difference_error")
    settings = list(dict.fromkeys(axis for run in runs for axis in run.settings))
    chosen = [[run.settings.get(axis, "") for axis in settings] for run in runs]
    return xr.Dataset(
        {name: (axes, values) for name, values in zip(names, table, strict=True)}
        | {"components": ((*axes, "replicate"), parts)},
        coords={
            "variant": np.array([run.name for run in runs], dtype=str),
            "figure": np.array([name for name, _ in keys], dtype=str),
            "place": ("figure", np.array([place for _, place in keys], dtype=str)),
            "unit": ("figure", np.array([own.unit for own in firsts], dtype=str)),
            "axis": np.array(settings, dtype=str),
            "setting": (
                ("variant", "axis"),
                np.array(chosen, dtype=str).reshape(len(runs), len(settings)),
            ),
        },
    )
