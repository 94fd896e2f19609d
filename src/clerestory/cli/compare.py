"""`clerestory compare`: measured against simulated."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from clerestory.cli.options import Quiet
from clerestory.comparison.comparison_notes import comparison_notes
from clerestory.comparison.comparison_tables import shares_table, write_tables
from clerestory.comparison.logger_files import read_plain
from clerestory.comparison.mapping import (
    read_mapping,
    read_measured_series,
    write_layout_sensors,
)
from clerestory.comparison.series import Series
from clerestory.comparison.series_comparison import (
    ABOVE_LUX,
    Comparison,
    Rules,
    compare_series,
)
from clerestory.comparison.simulated_series import simulated_series
from clerestory.comparison.time_alignment import COVERAGE
from clerestory.errors import InputError
from clerestory.files import make_folder
from clerestory.report.comparison_page import write_comparison
from clerestory.study.results import read_results


def compare(
    measured: Annotated[
        Path,
        typer.Argument(
            metavar="MEASURED",
            help="CSV with a column of times and one for each sensor; or a mapping"
            " (.toml) that says which file and column belongs to which sensor.",
        ),
    ],
    simulated: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="SIMULATED…",
            help="Folders of runs (results.nc), or CSV files; several side by side.",
        ),
    ] = None,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", help="Folder for the page, tables, pictures."),
    ] = Path("comparison"),
    name: Annotated[
        list[str] | None,
        typer.Option("--name", help="What a simulation is called; one each."),
    ] = None,
    above: Annotated[
        float, typer.Option("--above", help="Darker values do not count [lux].", min=0)
    ] = ABOVE_LUX,
    shift: Annotated[
        float, typer.Option("--shift", help="Move the measured times by [min].")
    ] = 0.0,
    coverage: Annotated[
        float,
        typer.Option("--coverage", help="How far a step must be filled.", min=0, max=1),
    ] = COVERAGE,
    sensors: Annotated[
        Path | None,
        typer.Option(
            "--sensors", help="Write the sensors of a mapping's scans here; then stop."
        ),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Tell how well a study agrees with measurements: shares within 5, 10, 20 %, bias.

    A shift of the clock that would fit better is told, never applied.
    """
    if sensors is not None:
        count = write_layout_sensors(sensors, read_mapping(measured))
        if not quiet:
            typer.echo(f"sensors: {sensors} ({count})")
        return
    if not simulated:
        raise InputError("nothing to compare with; SIMULATED expected")
    if name and len(name) != len(simulated):
        raise InputError(
            f"{len(name)} names for {len(simulated)} simulations; one each expected"
        )
    rules = Rules(above, shift, coverage)
    found: list[Comparison] = []
    places: dict[str, np.ndarray] = {}
    for number, path in enumerate(simulated):
        ours = _simulated(path)
        theirs = read_measured_series(measured, near=ours)
        label = name[number] if name else _label(path, simulated)
        found.append(compare_series(theirs, ours, name=label, rules=rules))
        if ours.position is not None:
            places |= dict(zip(ours.names, ours.position, strict=True))
    write_tables(found, make_folder(output))
    page = write_comparison(output, found, title=_title(measured), places=places)
    if not quiet:
        _tell(found)
        typer.echo(f"page: {page.resolve().as_uri()}")


def _title(measured: Path) -> str:
    given = read_mapping(measured).title if measured.suffix == ".toml" else ""
    return given or f"{measured.stem}, measured and simulated"


def _simulated(path: Path) -> Series:
    if path.suffix.lower() == ".csv":
        return read_plain(path, utc_offset_hours=0.0)
    return simulated_series(path)


def _label(path: Path, all_paths: list[Path]) -> str:
    # The method tells runs of one room apart; else the name of the folder
    if path.suffix.lower() == ".csv":
        return path.stem
    methods = [
        str(read_results(each).data.attrs.get("method", ""))
        for each in all_paths
        if each.suffix.lower() != ".csv"
    ]
    own = str(read_results(path).data.attrs.get("method", ""))
    folder = path.parent.name if path.suffix == ".nc" else path.name
    return own if own and methods.count(own) == 1 else folder


def _tell(found: list[Comparison]) -> None:
    rows = shares_table(found)
    table = Table(title="Share of values within [%]", title_justify="left")
    for number, heading in enumerate(rows[0]):
        table.add_column(heading, justify="left" if number < 2 else "right")
    for row in rows[1:]:
        table.add_row(*row)
    Console().print(table)
    for comparison in found:
        for (group, quantity), one in comparison.table().items():
            correlation = (
                "" if np.isnan(one.correlation) else f", r {one.correlation:.3f}"
            )
            typer.echo(
                f"{comparison.name}, {group} {quantity}: bias"
                f" {100 * one.relative_bias:+.1f} %, CV(RMSE)"
                f" {100 * one.variation:.1f} %{correlation}, {one.count} pairs"
            )
        for note in comparison_notes(comparison):
            typer.echo(f"  {note}")
