"""`clerestory gonio`: from goniophotometer measurements to BSDFs, with their error."""

from pathlib import Path
from typing import Annotated

import typer

from clerestory.bsdf.quality_checks import check as check_bsdf
from clerestory.bsdf.resample import reciprocal_mean
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.cli.gonio_input import direction_of, picture_format, read_files
from clerestory.cli.gonio_options import (
    Blank,
    FacingChoice,
    Files,
    Fits,
    Form,
    FunctionChoice,
    Merge,
    MostLobes,
    Picture,
    Processes,
    Smoothing,
    SymmetryChoice,
)
from clerestory.cli.gonio_text import (
    direction_lines,
    fit_lines,
    measurement_lines,
    validation_lines,
)
from clerestory.cli.options import Quiet
from clerestory.cli.progress import progress_display
from clerestory.errors import InputError
from clerestory.files import replace_file
from clerestory.gonio.bsdf_export import Target, export_bsdf
from clerestory.gonio.coverage import measure_coverage
from clerestory.gonio.cross_validation import smoothing_study
from clerestory.gonio.energy_conservation import conserve_energy
from clerestory.gonio.fit_storage import read_fits, write_fits
from clerestory.gonio.fitted_measurement import Fitted, fit_measurement
from clerestory.gonio.lobe_fitting import FitOptions
from clerestory.gonio.measurement_planning import recommended_directions
from clerestory.report.gonio_plots import between_figure, error_figure, fit_figure

app = typer.Typer(no_args_is_help=True, help="Goniophotometer measurements.")

_DIGITS = 6


@app.command(epilog="Example: clerestory gonio info scans/*.txt")
def info(
    files: Files,
    form: Form = None,
    function: FunctionChoice = None,
    facing: FacingChoice = "room",
    blank: Blank = None,
    merge: Merge = False,
) -> int:
    """Say what measurements cover: angles, gaps, noise, symmetry, flux.

    Exit status: 1 if there are doubts that can change results.
    """
    doubts = 0
    for measurement in read_files(files, form, function, facing, blank, merge=merge):
        coverage = measure_coverage(measurement)
        doubts += len(coverage.doubts())
        for line in measurement_lines(measurement, coverage):
            typer.echo(line)
    return int(doubts > 0)


@app.command(epilog="Example: clerestory gonio fit scans/*.txt -o film.nc")
def fit(
    files: Files,
    output: Annotated[Path, typer.Option("--output", "-o", help="File to write, .nc.")],
    form: Form = None,
    function: FunctionChoice = None,
    facing: FacingChoice = "room",
    blank: Blank = None,
    merge: Merge = False,
    symmetry: SymmetryChoice = None,
    lobes: MostLobes = 200,
    smoothing: Smoothing = 1.0,
    processes: Processes = 1,
    quiet: Quiet = False,
) -> None:
    """Fit lobes to every scan and plan how light moves between them."""
    measurements = read_files(files, form, function, facing, blank, merge=merge)
    options = FitOptions(lobes=lobes, smoothing=smoothing)
    with progress_display(quiet=quiet) as progress:
        fits = [
            fit_measurement(
                measurement,
                symmetry=symmetry,
                options=options,
                processes=processes,
                progress=progress,
            )
            for measurement in measurements
        ]
    write_fits(output, fits)
    if not quiet:
        for line in fit_lines(fits):
            typer.echo(line)


@app.command(epilog="Example: clerestory gonio check scans/*.txt -o errors.png")
def check(
    files: Files,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Map of the errors.")
    ] = None,
    form: Form = None,
    function: FunctionChoice = None,
    facing: FacingChoice = "room",
    blank: Blank = None,
    merge: Merge = False,
    symmetry: SymmetryChoice = None,
    lobes: MostLobes = 200,
    smoothing: Annotated[
        list[float] | None,
        typer.Option("--smoothing", help="Factor to try; repeatable. 1 if not given."),
    ] = None,
    more: Annotated[
        int,
        typer.Option("--next", help="Name so many directions worth a scan.", min=0),
    ] = 0,
    processes: Processes = 1,
    quiet: Quiet = False,
) -> None:
    """Leave out each incident direction in turn and compare what the others predict."""
    kind = None if output is None else picture_format(output)
    measurements = read_files(files, form, function, facing, blank, merge=merge)
    if output is not None and len(measurements) > 1:
        raise InputError(
            f"{len(measurements)} functions for one picture; files of one expected"
        )
    for measurement in measurements:
        with progress_display(quiet=quiet) as progress:
            results = smoothing_study(
                measurement,
                smoothing or [1.0],
                symmetry=symmetry,
                lobes=lobes,
                processes=processes,
                progress=progress,
            )
        for result in results:
            for line in validation_lines(result):
                typer.echo(line)
        if more:
            found = recommended_directions(
                results[0],
                symmetry=symmetry or measurement.symmetry,
                count=more,
            )
            for line in direction_lines(found):
                typer.echo(line)
        if output is not None:
            with replace_file(output) as stream:
                error_figure(results[0]).savefig(stream, format=kind, dpi=150)


@app.command(epilog="Example: clerestory gonio export film.nc --to tree -o film.xml")
def export(
    files: Fits,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="BSDF file to write, .xml.")
    ],
    to: Annotated[
        Target, typer.Option("--to", help="Klems basis, or a tensor tree.")
    ] = "full",
    halvings: Annotated[
        int, typer.Option("--halvings", help="2^N cells along each axis of a tree.")
    ] = 5,
    tolerance: Annotated[
        float, typer.Option("--tolerance", help="Join cells that differ by less.")
    ] = 0.05,
    reciprocal: Annotated[
        bool, typer.Option("--reciprocal", help="Average with the reverse.")
    ] = False,
    conserve: Annotated[
        bool, typer.Option("--conserve", help="Dim what scatters more than it meets.")
    ] = False,
    processes: Processes = 1,
    quiet: Quiet = False,
) -> None:
    """Write fits as one BSDF file for Radiance, WINDOW and clerestory."""
    fits: tuple[Fitted, ...] = tuple(part for file in files for part in read_fits(file))
    said: list[str] = []
    if conserve:
        conserved = conserve_energy(fits)
        fits = conserved.fits
        said.append(
            f"up to {conserved.largest:.4f} of the light scattered from one direction;"
            f" {conserved.changed} directions dimmed"
        )
    with progress_display(quiet=quiet) as progress:
        bsdf = export_bsdf(
            fits,
            to,
            halvings=halvings,
            tolerance=tolerance,
            processes=processes,
            progress=progress,
        )
    if reciprocal:
        mended = reciprocal_mean(bsdf)
        for channel, name in bsdf.functions:
            before, after = (b.diffuse(name, channel=channel) for b in (bsdf, mended))
            said.append(
                f"{channel} {name.replace('_', ' ')}: {before:.5f} of diffuse light"
                f" before the mean with its reverse, {after:.5f} after"
            )
        bsdf = mended
    write_bsdf(output, bsdf, digits=_DIGITS, comment=f"clerestory gonio export to {to}")
    if not quiet:
        said += [str(finding) for finding in check_bsdf(bsdf) if finding.matters]
        for line in said:
            typer.echo(line)
        typer.echo(f"{output}: {output.stat().st_size / 1e6:.1f} MB")


@app.command(epilog="Example: clerestory gonio plot scans/*.txt --scan 3 -o scan.png")
def plot(
    files: Files,
    output: Picture,
    scan: Annotated[
        int, typer.Option("--scan", help="Which scan, counted from 0.", min=0)
    ] = 0,
    between: Annotated[
        list[str] | None,
        typer.Option(
            "--between",
            help="Two incident directions; draw the light half-way between them.",
            metavar="THETA,PHI",
        ),
    ] = None,
    form: Form = None,
    function: FunctionChoice = None,
    facing: FacingChoice = "room",
    blank: Blank = None,
    merge: Merge = False,
    symmetry: SymmetryChoice = None,
    lobes: MostLobes = 200,
    smoothing: Smoothing = 1.0,
    processes: Processes = 1,
    quiet: Quiet = False,
) -> None:
    """Draw measured points, fitted lobes and the mesh, or light between two scans."""
    kind = picture_format(output)
    measurement = read_files(files, form, function, facing, blank, merge=merge)[0]
    if scan >= len(measurement.scans):
        raise InputError(f"scan {scan}; 0 to {len(measurement.scans) - 1} expected")
    if between and len(between) != 2:
        raise InputError(f"{len(between)} times --between; twice expected")
    with progress_display(quiet=quiet) as progress:
        fitted = fit_measurement(
            measurement,
            symmetry=symmetry,
            options=FitOptions(lobes=lobes, smoothing=smoothing),
            processes=processes,
            progress=progress,
        )
    if between:
        start, end = (direction_of(text) for text in between)
        figure = between_figure(fitted.interpolant, start, end)
    else:
        figure = fit_figure(measurement, fitted.interpolant, scan)
    with replace_file(output) as stream:
        figure.savefig(stream, format=kind, dpi=150)
