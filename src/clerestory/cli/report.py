"""`clerestory report`: the report of an earlier run, written anew."""

from pathlib import Path
from typing import Annotated

import typer

from clerestory.cli.options import Quiet
from clerestory.cli.run import REPORT_FILE, picture_folder
from clerestory.report.page import write_report
from clerestory.study.results import read_results


def report(
    results: Annotated[
        Path, typer.Argument(metavar="RESULTS", help="Results folder or results.nc.")
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="The page to write.")
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Write the report of an earlier run anew, from what lies in its folder.

    Pictures are taken from the folder `pictures` beside results.nc.
    """
    folder = results if results.is_dir() else results.parent
    page = output or folder / REPORT_FILE
    found = read_results(results)
    write_report(found, page, pictures=picture_folder(folder, found))
    if not quiet:
        typer.echo(f"report: {page}")
