"""`clerestory compare`: simulations compared with measurements or with each other."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from clerestory.checks import distinct, require, same_length
from clerestory.cli.progress import say
from clerestory.cli.requests.study import Compare
from clerestory.cli.variants import compare_runs
from clerestory.comparison import comparison_output, mapping
from clerestory.comparison.logger_files import read_plain
from clerestory.comparison.series import Series, simulated_series
from clerestory.comparison.series_comparison import Comparison, Rules, compare_series
from clerestory.files import make_folder
from clerestory.report.comparison_page import write_comparison
from clerestory.study.results import RESULTS_FILE, read_results


def compare(request: Compare) -> None:
    """Compare simulations with measurements, or runs; write tables and an HTML page."""
    measured, sensors, quiet = request.measured, request.sensors, request.quiet
    if sensors is not None:
        count = mapping.write_layout_sensors(sensors, mapping.read_mapping(measured))
        say(f"sensors: {sensors} ({count})", quiet=quiet)
        return
    simulated = request.simulated or []
    if is_run(measured):
        runs = [measured, *simulated]
        own = request.name or run_names(runs)
        same_length(own, runs, "names", "runs")
        distinct(own, "runs")
        compare_runs(runs, own, request.output, quiet=quiet)
        return
    names = request.name or [_label(path, simulated) for path in simulated]
    require(simulated, "no simulation is given; results or CSV files expected")
    same_length(names, simulated, "names", "simulations")
    rules = Rules(request.above, request.shift, request.coverage)
    found: list[Comparison] = []
    places: dict[str, np.ndarray] = {}
    for path, name in zip(simulated, names, strict=True):
        ours = _simulated(path)
        theirs = mapping.read_measured_series(measured, near=ours)
        found.append(compare_series(theirs, ours, name=name, rules=rules))
        if ours.position is not None:
            places |= dict(zip(ours.names, ours.position, strict=True))
    output = make_folder(request.output)
    comparison_output.write_tables(found, output)
    page = write_comparison(output, found, title=_title(measured), places=places)
    if not quiet:
        _tell(found)
        say(f"page: {page.resolve().as_uri()}")


def is_run(path: Path) -> bool:
    """Whether a path is the results folder of a run, or its results.nc."""
    return path.suffix == ".nc" or (path / RESULTS_FILE).is_file()


def run_names(paths: Sequence[Path]) -> list[str]:
    """Return the names of runs: of their folders, or of the folders around these.

    >>> run_names([Path("anna/results"), Path("ben/results/results.nc")])
    ['anna', 'ben']
    """
    folders = [(p.parent if p.suffix == ".nc" else p).resolve() for p in paths]
    names = [folder.name for folder in folders]
    parents = [folder.parent.name for folder in folders]
    if len(set(names)) == len(names):
        return names
    if len(set(names)) == 1 and len(set(parents)) == len(parents):
        return parents
    return [f"{around}/{name}" for around, name in zip(parents, names, strict=True)]


def _title(measured: Path) -> str:
    given = mapping.read_mapping(measured).title if measured.suffix == ".toml" else ""
    return given or f"{measured.stem}, measured and simulated"


def _simulated(path: Path) -> Series:
    if path.suffix.lower() == ".csv":
        return read_plain(path, utc_offset_hours=0.0)
    return simulated_series(path)


def _label(path: Path, all_paths: list[Path]) -> str:
    # Name of a run: its phase method if unique among the runs, otherwise its folder
    if path.suffix.lower() == ".csv":
        return path.stem
    runs = [each for each in all_paths if each.suffix.lower() != ".csv"]
    methods = [_method(each) for each in runs]
    own = _method(path)
    folder = path.parent.name if path.suffix == ".nc" else path.name
    return own if own and methods.count(own) == 1 else folder


def _method(path: Path) -> str:
    return str(read_results(path).data.attrs.get("method", ""))


def _tell(found: list[Comparison]) -> None:
    rows = comparison_output.shares_table(found)
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
            say(
                f"{comparison.name}, {group} {quantity}: bias"
                f" {100 * one.relative_bias:+.1f} %, CV(RMSE)"
                f" {100 * one.variation:.1f} %{correlation}, {one.count} pairs"
            )
        say(*(f"  {note}" for note in comparison_output.comparison_notes(comparison)))
