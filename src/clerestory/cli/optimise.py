"""`clerestory optimise`: designs that are best for stated goals."""

from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests.calibration import Optimise
from clerestory.report.page import REPORT_FILE
from clerestory.report.pareto_plot import goal_objectives
from clerestory.report.variants_page import write_variants_page
from clerestory.study.design_run import Optimised, optimise_study
from clerestory.study.variants import read_variants


def optimise(request: Optimise) -> None:
    """Search designs, run the best ones, and write the page that compares them."""
    variants = read_variants(request.study)
    with progress_display(quiet=request.quiet) as display:
        found = optimise_study(variants, out=request.output, display=display)
    study, page = variants[0].study, request.output / REPORT_FILE
    write_variants_page(
        page,
        found.runs,
        title=f"{study.title}: designs",
        title_block=study.report.title_block(),
        goals=goal_objectives(found.runs, found.table.goal),
    )
    if not request.quiet:
        _tell(found)
        say(f"report: {page.resolve().as_uri()}")


def _tell(found: Optimised) -> None:
    for number, design in enumerate(found.designs):
        run = found.runs[number + 1]
        values = ", ".join(f"{k} {v:.3g}" for k, v in design.values.items())
        goals = []
        for goal in found.table.goal:
            figure = next(
                own
                for own in run.figures
                if own.name == goal.figure and own.place == (goal.place or own.place)
            )
            goals.append(f"{figure.name} {figure.value:.4g} {figure.unit}")
        met = "" if found.met(number) else "; outside a limit when run in full"
        say(f"{run.name}: {values}: {', '.join(goals)}{met}")
