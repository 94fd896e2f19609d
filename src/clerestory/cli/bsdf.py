"""`clerestory bsdf`: descriptions, quality checks and figures of BSDF files."""

from functools import partial
from pathlib import Path

import typer

from clerestory.bsdf.layer_comparison import compare as compare_bsdfs
from clerestory.bsdf.quality_checks import check_file
from clerestory.bsdf.quality_finding import Finding
from clerestory.bsdf.xml_insertion import insert_blocks
from clerestory.checks import require
from clerestory.cli import bsdf_report
from clerestory.cli.angle_pair import angle_pair
from clerestory.cli.progress import say
from clerestory.cli.requests import bsdf as requests
from clerestory.constants import LIBRARY_PREFIX
from clerestory.errors import InputError
from clerestory.library.bsdf_source import bsdf_file, read_bsdf
from clerestory.report.bsdf_plot import (
    direction_from_angles,
    lobe_figure,
    patch_direction,
    share_figure,
)
from clerestory.report.bsdf_view import write_view
from clerestory.report.figure_file import figure_format, write_figure

_UNREADABLE = 2


def info(request: requests.BsdfInfo) -> None:
    """Print a description of a BSDF file."""
    say(*bsdf_report.info_lines(read_bsdf(request.file)))


def check(request: requests.CheckBsdf) -> int:
    """Print the findings of the quality checks; return the exit status."""
    reports: list[tuple[Path, tuple[Finding, ...], str]] = []
    for file in request.files:
        try:
            with bsdf_file(file) as path:
                reports.append((file, check_file(path), ""))
        except InputError as error:
            reports.append((file, (), str(error)))
    if request.as_json:
        typer.echo(bsdf_report.findings_json(reports))
    for file, findings, reason in reports:
        if reason:
            typer.echo(" ".join(reason.split()), err=True)
        elif not request.as_json:
            say(*bsdf_report.finding_lines(file, findings, all_of_them=request.every))
    if any(reason for _, _, reason in reports):
        return _UNREADABLE
    return int(any(f.matters for _, findings, _ in reports for f in findings))


def plot(request: requests.PlotBsdf) -> None:
    """Plot a BSDF."""
    _draw([request.file], request.output, request.drawing)


def compare(request: requests.CompareBsdfs) -> None:
    """Print how each BSDF differs from the first one, and draw all BSDFs."""
    files, drawing = request.files, request.drawing
    require(len(files) > 1, "one BSDF file is given; two or more expected")
    bsdfs = [read_bsdf(file) for file in files]
    for file, bsdf in zip(files[1:], bsdfs[1:], strict=True):
        result = compare_bsdfs(
            bsdfs[0], bsdf, function=drawing.function, channel=drawing.channel
        )
        say(*bsdf_report.comparison_lines(result, (str(files[0]), str(file))))
    if request.output is not None:
        _draw(files, request.output, drawing)


def view(request: requests.ViewBsdf) -> None:
    """Write an interactive view of a BSDF."""
    name = request.file.name.removeprefix(LIBRARY_PREFIX)
    output = request.output or Path(name).with_suffix(".html")
    write_view(read_bsdf(request.file), output)
    say(f"{output}: {output.stat().st_size / 1e6:.1f} MB")


def insert(request: requests.InsertBsdf) -> None:
    """Insert BSDF data into a template file, and check that the result can be read."""
    source, template, output = request.source, request.template, request.output
    wanted = [name.strip() for name in request.channels.split(",") if name.strip()]
    with bsdf_file(source) as path:
        result = insert_blocks(
            path,
            template,
            output,
            channels=wanted,
            source_channel=request.source_channel,
        )
    read_bsdf(output)
    say(f"{output}: {', '.join(result.blocks)} from {source}")
    if result.kept:
        say(f"{output}: {', '.join(result.kept)} as in {template}")


def _draw(files: list[Path], output: Path, drawing: requests.Drawing) -> None:
    figure_format(output)
    function = drawing.function
    directions = [patch_direction(k, function) for k in drawing.patch or []]
    directions += [
        direction_from_angles(*angle_pair(text), function)
        for text in drawing.source or []
    ]
    draw = (
        share_figure
        if drawing.curve
        else partial(
            lobe_figure, directions=directions or [patch_direction(0, function)]
        )
    )
    figure = draw(
        [read_bsdf(file) for file in files],
        function=function,
        channel=drawing.channel,
        names=[file.stem for file in files],
    )
    write_figure(figure, output)
