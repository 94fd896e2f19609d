"""`clerestory gonio`: BSDFs from goniophotometer measurements, with their errors."""

from collections.abc import Sequence

from clerestory.array_types import Directions
from clerestory.bsdf.quality_checks import check as check_bsdf
from clerestory.bsdf.resample import reciprocal_mean
from clerestory.bsdf.xml_writer import usual_digits, write_bsdf
from clerestory.checks import require, within
from clerestory.cli import gonio_text
from clerestory.cli.angle_pair import angle_pair
from clerestory.cli.bsdf_report import function_title
from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests import gonio as requests
from clerestory.errors import InputError
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.coverage import measure_coverage
from clerestory.gonio.cross_validation import cross_validate
from clerestory.gonio.fit_storage import read_fits, write_fits
from clerestory.gonio.fitted_measurement import (
    Fitted,
    conserve_energy,
    export_bsdf,
    fit_measurement,
)
from clerestory.gonio.lobe_fitting import FitOptions
from clerestory.gonio.measurement_files import read_measurement
from clerestory.gonio.measurement_planning import recommended_directions
from clerestory.gonio.scattering_measurement import Measurement
from clerestory.report.figure_file import figure_format, write_figure
from clerestory.report.gonio_plots import between_figure, error_figure, fit_figure


def info(request: requests.MeasurementInfo) -> int:
    """Print the angular coverage and noise of scans; return the exit status."""
    findings = 0
    for measurement in _read(request.measurement):
        coverage = measure_coverage(measurement)
        findings += len(coverage.doubts())
        say(*gonio_text.measurement_lines(measurement, coverage))
    return int(findings > 0)


def fit(request: requests.FitMeasurement) -> None:
    """Fit lobes to scans, and write the lobes and transport plans to a file."""
    fits = _fitted(_read(request.measurement), request.fit, quiet=request.quiet)
    write_fits(request.output, fits)
    say(*gonio_text.fit_lines(fits), quiet=request.quiet)


def check(request: requests.CrossValidation) -> None:
    """Print the errors of a cross-validation, and map them over incident directions."""
    output, measurements = request.output, _read(request.measurement)
    if output is not None:
        figure_format(output)
        require(
            len(measurements) == 1,
            f"the files contain {len(measurements)} functions; one function per figure"
            " expected",
        )
    for measurement in measurements:
        with progress_display(quiet=request.quiet) as progress:
            results = [
                cross_validate(
                    measurement,
                    symmetry=request.symmetry,
                    options=FitOptions(lobes=request.lobes, smoothing=smoothing),
                    processes=request.processes,
                    progress=progress,
                )
                for smoothing in request.smoothing or [1.0]
            ]
        for result in results:
            say(*gonio_text.validation_lines(result))
        if request.more:
            symmetry = request.symmetry or measurement.symmetry
            found = recommended_directions(
                results[0], symmetry=symmetry, count=request.more
            )
            say(*gonio_text.direction_lines(found))
        if output is not None:
            write_figure(error_figure(results[0]), output)


def export(request: requests.ExportBsdf) -> None:
    """Write fitted scattering functions as a BSDF file."""
    fits: tuple[Fitted, ...] = tuple(
        part for file in request.files for part in read_fits(file)
    )
    said: list[str] = []
    if request.conserve:
        conserved = conserve_energy(fits)
        fits = conserved.fits
        said.append(
            f"up to {conserved.largest:.4f} of the light scattered from one direction;"
            f" {conserved.changed} directions scaled down"
        )
    with progress_display(quiet=request.quiet) as progress:
        bsdf = export_bsdf(
            fits,
            request.to,
            halvings=request.halvings,
            tolerance=request.tolerance,
            processes=request.processes,
            progress=progress,
        )
    if request.reciprocal:
        mean = reciprocal_mean(bsdf)
        for channel, name in bsdf.functions:
            before, after = (b.diffuse(name, channel=channel) for b in (bsdf, mean))
            said.append(
                f"{function_title(channel, name)}: diffuse {before:.5f}"
                f" before averaging with the reverse function, {after:.5f} after"
            )
        bsdf = mean
    comment = f"clerestory gonio export to {request.to}"
    write_bsdf(request.output, bsdf, digits=usual_digits(bsdf), comment=comment)
    if not request.quiet:
        said += [str(finding) for finding in check_bsdf(bsdf) if finding.matters]
        say(*said, f"{request.output}: {request.output.stat().st_size / 1e6:.1f} MB")


def plot(request: requests.PlotMeasurement) -> None:
    """Plot a scan and its fit, or the interpolation between two directions."""
    figure_format(request.output)
    scan, between = request.scan, request.between
    measurement = _read(request.measurement)[0]
    within(scan, "scan", least=0, most=len(measurement.scans) - 1)
    require(
        not between or len(between) == 2,
        f"--between is given {len(between or [])} times; twice expected",
    )
    (fitted,) = _fitted([measurement], request.fit, quiet=request.quiet)
    if between:
        start, end = (_direction(text) for text in between)
        figure = between_figure(fitted.interpolant, start, end)
    else:
        figure = fit_figure(measurement, fitted.interpolant, scan)
    write_figure(figure, request.output)


def _read(files: requests.MeasurementFiles) -> tuple[Measurement, ...]:
    how = dict(vars(files))
    return read_measurement(*how.pop("files"), **how)


def _fitted(
    measurements: Sequence[Measurement], options: requests.Fit, *, quiet: bool
) -> list[Fitted]:
    fitted = FitOptions(lobes=options.lobes, smoothing=options.smoothing)
    with progress_display(quiet=quiet) as progress:
        return [
            fit_measurement(
                measurement,
                symmetry=options.symmetry,
                options=fitted,
                processes=options.processes,
                progress=progress,
            )
            for measurement in measurements
        ]


def _direction(text: str) -> Directions:
    theta, phi = angle_pair(text)
    if not 0 <= theta < 90:
        raise InputError(f"direction is {text!r}; θ from 0 to below 90° expected")
    return from_degrees(theta, phi)
