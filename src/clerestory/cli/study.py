"""`clerestory new`, `run`, `demo` and `report`: studies and their reports."""

from collections.abc import Iterator
from pathlib import Path

import xarray as xr
from rich.console import Console
from rich.table import Table

from clerestory.cli.plan_text import plan_table, stage_table
from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests import study as requests
from clerestory.cli.variants import run_all
from clerestory.cli.view import view_command
from clerestory.metrics.replicates import error_of_group_mean
from clerestory.report.compliance_words import verdict_words
from clerestory.report.knowledge_section import known_figures, probabilities
from clerestory.report.page import REPORT_FILE, picture_folder, write_report
from clerestory.report.pdf import find_browser, write_pdf
from clerestory.report.uncertain_value import Figure
from clerestory.report.view_grid_content import percent, uncertain_dgp
from clerestory.study.compliance_table import assessments_of
from clerestory.study.config import Study, read_study
from clerestory.study.new_study import GLAZING, begin_study, write_demo
from clerestory.study.results import Results, read_results
from clerestory.study.run_plan import plan_study
from clerestory.study.study_run import run_study
from clerestory.study.title_block import title_block_of
from clerestory.study.variants import read_variants
from clerestory.study.view_grid_outputs import view_grid_part, view_grids

_SUGGESTED = (
    f"no --bsdf: windows of {GLAZING}; with a blind, for example"
    f" {GLAZING}+venetian-80-white@45; `clerestory bsdf library` lists all"
)


def new(request: requests.NewStudy) -> None:
    """Write a study file and its input files."""
    begun = begin_study(
        request.folder,
        scene=request.scene,
        windows=request.window or (),
        glazing=request.glazing or (),
        bsdf=request.bsdf or GLAZING,
        weather=request.weather,
        sensors=request.sensors,
        spacing=request.spacing,
        height=request.height,
        units=request.units,
        views=request.views,
    )
    rooms = f" in {begun.rooms} rooms" if begun.rooms > 1 else ""
    rooms += f", {begun.windows} windows" if begun.windows > 1 else ""
    views = f", {begun.views} views" if begun.views else ""
    say(
        *(
            f'panes "{name}" have several faces: that towards the room is the window;'
            f" {count} other {'faces' if count > 1 else 'face'} left out"
            for name, count in begun.faces.items()
        ),
        *(f'window "{n}" reversed: its front must face the room' for n in begun.turned),
        *([] if request.bsdf else [_SUGGESTED]),
        f"{begun.study}: {begun.sensors} sensors{rooms}{views}",
        f"next: clerestory run {begun.study}",
        quiet=request.quiet,
    )


def run(request: requests.RunStudy) -> None:
    """Run a study, or print the estimated cost of a run."""
    variants = [
        variant.with_trace(
            seed=request.seed, device=request.device, cluster=request.cluster
        )
        for variant in read_variants(request.study)
    ]
    study = variants[0].study
    folder = request.out or request.study.with_name(f"{request.study.stem}_results")
    if request.plan:
        plan = plan_study(*(variant.study for variant in variants), out=folder)
        Console().print(plan_table(plan), stage_table(plan))
    elif variants[0].name:
        run_all(variants, folder, quiet=request.quiet)
    else:
        _run(study, folder, quiet=request.quiet)


def demo(request: requests.Demo) -> None:
    """Copy the bundled study and run it."""
    study = read_study(write_demo(request.folder, bsdf=request.bsdf))
    chosen = study.with_trace(seed=request.seed, device=request.device)
    _run(chosen, request.folder / "results", quiet=request.quiet)


def report(request: requests.WriteReport) -> None:
    """Write the report of an earlier run."""
    path = request.results
    folder = path if path.is_dir() else path.parent
    page = request.output or folder / REPORT_FILE
    if request.pdf:
        find_browser()
    results = read_results(path)
    block = title_block_of(results.run).with_changes(
        project=request.project,
        client=request.client,
        author=request.author,
        logo=request.logo,
        notes=request.notes,
    )
    pictures = picture_folder(folder, results)
    write_report(results, page, pictures=pictures, title_block=block)
    say(f"report: {page}", f"explore: {view_command(path)}", quiet=request.quiet)
    if request.pdf:
        write_pdf(page, page.with_suffix(".pdf"))
        say(f"PDF: {page.with_suffix('.pdf')}", quiet=request.quiet)


def _run(study: Study, folder: Path, *, quiet: bool) -> None:
    with progress_display(quiet=quiet) as display:
        results = run_study(study, out=folder, display=display)
    page = folder / REPORT_FILE
    write_report(results, page, pictures=picture_folder(folder, results))
    if not quiet:
        Console().print(_summary(results))
        if view_grids(results):
            Console().print(_glare_summary(results))
        for name, words in (*_verdicts(results), *_known(results)):
            say(f"{name}: {words}")
        say(f"results: {folder}", f"report:  {page.resolve().as_uri()}")
        say(f"explore: {view_command(folder)}")


def _summary(results: Results) -> Table:
    # Table of metrics averaged over each grid, with their standard errors
    data = results.data
    table = Table(title=results.title, title_justify="left")
    target = f"{data.attrs['target_lux']:g}"
    table.add_column("grid")
    melanopic = "melanopic_edi" in data
    for heading in ("sensors", "mean", f"hours ≥ {target} lux", "useful"):
        table.add_column(heading, justify="right")
    if melanopic:
        limit = f"{data.attrs['melanopic_target_lux']:g}"
        table.add_column(f"hours ≥ {limit} lux melanopic EDI", justify="right")
    for grid in results.grids():
        part = data.isel(sensor=(data["grid"] == grid).values)
        table.add_row(
            grid,
            str(part.sizes["sensor"]),
            _mean(part, "mean_illuminance", 1, "lux"),
            _mean(part, "daylight_autonomy", 100, "%"),
            _mean(part, "useful", 100, "%"),
            *([_mean(part, "melanopic_autonomy", 100, "%")] if melanopic else []),
        )
    return table


def _glare_summary(results: Results) -> Table:
    # Table of the annual glare of each view grid, with standard errors
    data = results.data
    table = Table(title="Glare of view grids", title_justify="left")
    table.add_column("view grid")
    headings = ("views", "disturbed views", "disturbed positions", "DGP of worst view")
    for heading in headings:
        table.add_column(heading, justify="right")
    for number, grid in enumerate(view_grids(results)):
        part = view_grid_part(data, grid)
        exceeded = part["grid_view_exceeded_dgp"].values
        worst = int(exceeded.argmax())
        error = float(part["grid_view_exceeded_dgp_error"][worst])
        row = data.isel(view_grid_name=number)
        shares = (
            percent(float(row[name]), float(row[f"{name}_error"]))
            for name in ("disturbed_views", "disturbed_positions")
        )
        dgp = uncertain_dgp(float(exceeded[worst]), error)
        table.add_row(grid, str(len(exceeded)), *shares, dgp)
    table.caption = (
        "disturbed: DGP above 0.40 in more than 5 % of the occupied hours; worst view:"
        " DGP exceeded in 5 % of them"
    )
    table.caption_justify = "left"
    return table


def _verdicts(results: Results) -> Iterator[tuple[str, str]]:
    # Verdicts of each standard on all spaces together, and requirements not fulfilled
    found = assessments_of(results.data)
    for name in dict.fromkeys(one.standard for one in found):
        own = [one for one in found if one.standard == name]
        for verdict in own[-1].verdicts:
            yield name, f"{verdict.criterion}: {verdict_words(verdict)}"
        lines = {line for one in own for line in one.requirements}
        count = sum(line.status == "not fulfilled" for line in lines)
        if count:
            yield name, f"requirements not fulfilled: {count}, listed in the report"


def _known(results: Results) -> Iterator[tuple[str, str]]:
    # Error of the bands; both errors of each figure, and probabilities of standards,
    # with [uncertainty]
    if "band_errors" in results.data.attrs:
        words = results.data.attrs["band_errors"]
        yield "bands", f"after two materials of this study {words} of those at 1 nm"
    if "known_figure_value" not in results.data:
        return
    for one in known_figures(results.data):
        words = f"{one.simulation} (simulation), {one.knowledge} (what is not known)"
        yield f"{one.name}, {one.place}", words
    for name, (space, level, chance) in probabilities(results.data):
        yield name, f"{space}: {level} or better with a probability of {chance}"


def _mean(part: xr.Dataset, name: str, factor: float, unit: str) -> str:
    error = error_of_group_mean(part[f"{name}_components"].values)
    return str(Figure(factor * float(part[name].mean()), factor * error, unit))
