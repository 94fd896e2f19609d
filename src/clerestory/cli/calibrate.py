"""`clerestory calibrate`: unknown quantities of a study, fitted to measurements."""

from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests.calibration import Calibrate
from clerestory.comparison.calibration_output import (
    write_calibrated_study,
    write_calibration,
)
from clerestory.comparison.calibration_run import CalibratedStudy, calibrate_study
from clerestory.comparison.series_comparison import Rules
from clerestory.files import make_folder
from clerestory.metrics.agreement import Agreement
from clerestory.report.calibration_page import PAGE_FILE, write_calibration_page
from clerestory.report.uncertain_value import number
from clerestory.study.config import read_study


def calibrate(request: Calibrate) -> None:
    """Calibrate a study; write values, calibrated study and page."""
    study, folder = read_study(request.study), make_folder(request.output)
    with progress_display(quiet=request.quiet) as display:
        found = calibrate_study(
            study,
            request.measured,
            out=folder,
            rules=Rules(request.above, request.shift, request.coverage),
            display=display,
        )
    write_calibration(found, folder)
    made = write_calibrated_study(found, study, request.study, folder)
    page = folder / PAGE_FILE
    write_calibration_page(page, found, title=study.title)
    _tell(found, quiet=request.quiet)
    if made is not None:
        say(f"study:  {made}", quiet=request.quiet)
    say(f"page:   {page.resolve().as_uri()}", quiet=request.quiet)


def _tell(found: CalibratedStudy, *, quiet: bool) -> None:
    fit = found.calibration
    for unknown, value, spread in zip(
        fit.unknowns, fit.values.tolist(), fit.deviations.tolist(), strict=True
    ):
        was = number(found.quantities.reference[unknown.name])
        words = f"{number(value)} ± {spread:.2g} {unknown.unit}".rstrip()
        say(f"{unknown.name}: {words} (study: {was})", quiet=quiet)
    say(
        f"all days: {_change(*found.agreements())}",
        *(
            f"{one.day}, not used: {_change(one.before, one.after)}"
            for one in found.held_out
        ),
        quiet=quiet,
    )


def _change(before: Agreement, after: Agreement) -> str:
    bias = [f"{100 * own.relative_bias:+.1f} %" for own in (before, after)]
    scatter = [f"{100 * own.variation:.1f} %" for own in (before, after)]
    return f"bias {' to '.join(bias)}, CV(RMSE) {' to '.join(scatter)}"
