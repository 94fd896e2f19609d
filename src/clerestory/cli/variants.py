"""Runs of all variants of a study, and comparisons of finished runs."""

import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.table import Table

from clerestory.cli.progress import progress_display, say
from clerestory.cli.view import view_command
from clerestory.files import make_folder
from clerestory.report.page import REPORT_FILE
from clerestory.report.uncertain_value import Figure
from clerestory.report.variants_page import write_variants_page
from clerestory.study.compared_settings import compared_settings
from clerestory.study.results import read_results
from clerestory.study.title_block import TitleBlock
from clerestory.study.variant_figures import (
    RunFigures,
    VariantFigure,
    common_keys,
    figure_rows,
    run_figures,
)
from clerestory.study.variant_outputs import TABLE_FILE, write_variants
from clerestory.study.variant_run import run_variants, variant_folders
from clerestory.study.variants import Variant


def run_all(variants: Sequence[Variant], folder: Path, *, quiet: bool) -> None:
    """Run all variants of a study and write the page that compares them."""
    with progress_display(quiet=quiet) as display:
        found = run_variants(variants, out=folder, display=display)
    own = variant_folders(variants, folder)
    first = next(iter(own.values()))
    study = variants[0].study
    block = study.report.title_block()
    _finish(found, folder, study.title, title_block=block, quiet=quiet)
    say(
        f"report of one variant:  clerestory report {shlex.quote(str(first))}",
        f"explore one variant:    {view_command(first)}",
        quiet=quiet,
    )


def compare_runs(
    paths: Sequence[Path], names: Sequence[str], folder: Path, *, quiet: bool
) -> None:
    """Compare finished runs; write their figures and a page into a folder."""
    found, studies, files = [], [], []
    for path, name in zip(paths, names, strict=True):
        results = read_results(path)
        found.append(run_figures(results, name=name))
        studies.append(results.run.get("study") or {})
        files.append(results.run.get("files") or {})
        results.data.close()
    settings = compared_settings(studies, files)
    found = [replace(r, settings=s) for r, s in zip(found, settings, strict=True)]
    common_keys(found)
    write_variants(found, make_folder(folder))
    _finish(found, folder, "Comparison of runs", quiet=quiet)


def _finish(
    runs: Sequence[RunFigures],
    folder: Path,
    title: str,
    *,
    title_block: TitleBlock | None = None,
    quiet: bool,
) -> None:
    if len(runs) < 2:
        return
    page = folder / REPORT_FILE
    write_variants_page(page, runs, title=title, title_block=title_block)
    if not quiet:
        Console().print(_table(runs, title))
        say(f"results: {folder}", f"report:  {page.resolve().as_uri()}")


def _table(runs: Sequence[RunFigures], title: str) -> Table:
    # The first two figures of light, and three of glare and energy
    table = Table(title=title, title_justify="left")
    table.add_column("variant")
    keys = common_keys(runs)
    aspects = {key: figure_rows(runs, key)[0][0].aspect for key in keys}
    light = [key for key in keys if aspects[key] == "light"][:2]
    other = [key for key in keys if aspects[key] in ("glare", "energy")][:3]
    for name, place in (*light, *other):
        table.add_column(f"{name}, {place}", justify="right")
    columns = [figure_rows(runs, key) for key in (*light, *other)]
    for number, run in enumerate(runs):
        cells = [_cell(row[number], first=number == 0) for row in columns]
        table.add_row(run.name, *cells)
    table.caption = "in brackets: difference from the first variant"
    if len(keys) > len(columns):
        table.caption += f"; all {len(keys)} figures: {TABLE_FILE}"
    table.caption_justify = "left"
    return table


def _cell(pair: tuple[VariantFigure, VariantFigure], *, first: bool) -> str:
    own, change = pair
    shown = str(Figure(own.value, own.error, own.unit))
    if first:
        return shown
    sign = "+" if change.value > 0 else ""
    return f"{shown} ({sign}{Figure(change.value, change.error, change.unit)})"
