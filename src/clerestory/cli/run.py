"""`clerestory run` and `demo`: a whole study, from its file to its report."""

from pathlib import Path
from typing import Annotated

import typer
import xarray as xr
from rich.console import Console
from rich.table import Table

from clerestory.cli.options import ClusterAddress, Quiet
from clerestory.cli.plan_text import plan_table
from clerestory.cli.progress import progress_display
from clerestory.engine.device import Device
from clerestory.report.page import write_report
from clerestory.study.annual_views import PICTURE_FOLDER
from clerestory.study.config import Study, read_study
from clerestory.study.demo_study import write_demo
from clerestory.study.results import Results
from clerestory.study.run_plan import plan_study
from clerestory.study.study_run import run_study

REPORT_FILE = "report.html"

Out = Annotated[
    Path | None,
    typer.Option(
        "--out",
        help="Folder for the results; NAME_results beside NAME.toml if not given.",
    ),
]
DeviceChoice = Annotated[
    Device | None, typer.Option("--device", help="Instead of the study's own device.")
]
SeedChoice = Annotated[
    int | None, typer.Option("--seed", help="Instead of the study's own seed.", min=0)
]

PlanOnly = Annotated[
    bool,
    typer.Option("--plan", help="Say what will be traced and what it takes; no more."),
]


def run(
    study: Annotated[Path, typer.Argument(metavar="STUDY.toml", help="The study.")],
    out: Out = None,
    device: DeviceChoice = None,
    seed: SeedChoice = None,
    cluster: ClusterAddress = None,
    plan: PlanOnly = False,
    quiet: Quiet = False,
) -> None:
    """Run a study: trace, multiply by a year of sky, write results and a report.

    Matrices traced before are found again in OUT/matrices; a run that was killed
    goes on where it stopped.
    """
    chosen = read_study(study).with_trace(seed=seed, device=device, cluster=cluster)
    folder = out or study.with_name(f"{study.stem}_results")
    if plan:
        Console().print(plan_table(plan_study(chosen, out=folder)))
        return
    _run(chosen, folder, quiet=quiet)


def demo(
    folder: Annotated[
        Path,
        typer.Argument(metavar="DIR", help="Folder for the study and its results."),
    ] = Path("clerestory_demo"),
    device: DeviceChoice = None,
    seed: SeedChoice = None,
    quiet: Quiet = False,
) -> None:
    """Copy the bundled study, a test room behind a venetian blind, and run it.

    Files that are in DIR already stay as they are.
    """
    chosen = read_study(write_demo(folder)).with_trace(seed=seed, device=device)
    _run(chosen, folder / "results", quiet=quiet)


def _run(study: Study, folder: Path, *, quiet: bool) -> None:
    with progress_display(quiet=quiet) as display:
        results = run_study(study, out=folder, display=display)
    page = folder / REPORT_FILE
    write_report(results, page, pictures=picture_folder(folder, results))
    if not quiet:
        Console().print(_summary(results))
        typer.echo(f"results: {folder}")
        typer.echo(f"report:  {page.resolve().as_uri()}")


def picture_folder(folder: Path, results: Results) -> Path:
    """Return where pictures lie: of several methods, in the folder of the last one."""
    own = folder / str(results.data.attrs.get("method", "")) / PICTURE_FOLDER
    return own if own.is_dir() else folder / PICTURE_FOLDER


def _summary(results: Results) -> Table:
    # Means over each grid, with the means of their errors
    data = results.data
    table = Table(title=results.title, title_justify="left")
    target = f"{data.attrs['target_lux']:g}"
    for heading in (
        "grid",
        "sensors",
        "mean [lux]",
        f"hours ≥ {target} lux [%]",
        "useful [%]",
    ):
        table.add_column(heading, justify="left" if heading == "grid" else "right")
    for grid in results.grids():
        part = data.isel(sensor=(data["grid"] == grid).values)
        table.add_row(
            grid,
            str(part.sizes["sensor"]),
            _figure(part, "mean_illuminance", 1),
            _figure(part, "daylight_autonomy", 100),
            _figure(part, "useful", 100),
        )
    return table


def _figure(part: xr.Dataset, name: str, factor: float) -> str:
    value = factor * float(part[name].mean())
    error = factor * float(part[f"{name}_error"].mean())
    return f"{value:.1f} ± {error:.1f}"
