"""`clerestory bsdf`: what a BSDF file holds, whether it can be true, how it looks."""

from pathlib import Path
from typing import Annotated

import typer

from clerestory.bsdf.bsdf_comparison import compare as compare_bsdfs
from clerestory.bsdf.quality_checks import check as check_bsdf
from clerestory.bsdf.quality_finding import Finding
from clerestory.bsdf.scattering_function import Function
from clerestory.bsdf.xml_insertion import insert_blocks
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.cli.bsdf_convert import convert, reduce
from clerestory.cli.bsdf_generate import EXAMPLE, generate
from clerestory.cli.bsdf_package import package_file
from clerestory.cli.bsdf_report import (
    comparison_lines,
    finding_lines,
    findings_json,
    info_lines,
)
from clerestory.cli.two_angles import two_angles
from clerestory.errors import InputError
from clerestory.files import replace_file
from clerestory.report.bsdf_plot import (
    direction_from_angles,
    lobe_figure,
    patch_direction,
    share_figure,
)
from clerestory.report.bsdf_view import write_view

app = typer.Typer(no_args_is_help=True, help="BSDF files of layers.")
app.command(epilog="Example: clerestory bsdf convert tree.xml --to full -o matrix.xml")(
    convert
)
app.command(
    epilog="Example: clerestory bsdf reduce tree.xml --percent 95 -o small.xml"
)(reduce)
app.command(
    "package", epilog="Example: clerestory bsdf package blind.xml -o blind.rad"
)(package_file)
app.command(epilog=EXAMPLE)(generate)

_UNREADABLE = 2
_PICTURES = (".png", ".svg", ".pdf")

BsdfFile = Annotated[
    Path, typer.Argument(metavar="FILE", help="BSDF file of LBNL's WINDOW or genBSDF.")
]
BsdfFiles = Annotated[list[Path], typer.Argument(metavar="FILE…", help="BSDF files.")]
FunctionChoice = Annotated[
    Function, typer.Option("--function", help="Which of the four functions.")
]
Channel = Annotated[str, typer.Option("--channel", help="Visible, solar, nir, …")]
Patches = Annotated[
    list[int] | None,
    typer.Option(
        "--patch",
        help="Incident Klems patch, counted from 0 (WINDOW counts from 1); repeatable.",
        metavar="N",
    ),
]
Angles = Annotated[
    list[str] | None,
    typer.Option(
        "--from",
        help="Angle to the normal and azimuth of the source, 90 is up; repeatable.",
        metavar="THETA,PHI",
    ),
]
Picture = Annotated[
    Path, typer.Option("--output", "-o", help="Picture to write: .png, .svg or .pdf.")
]
Curve = Annotated[
    bool, typer.Option("--curve", help="Draw shares over angles instead of discs.")
]


@app.command(epilog="Example: clerestory bsdf info blind.xml")
def info(file: BsdfFile) -> None:
    """Say what a BSDF file holds: product, bases, and how much light passes."""
    for line in info_lines(read_bsdf(file)):
        typer.echo(line)


@app.command(epilog="Example: clerestory bsdf check blind.xml shade.xml")
def check(
    files: BsdfFiles,
    every: Annotated[
        bool, typer.Option("--all", help="Tell remarks too, not only doubts.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Write JSON.")] = False,
) -> int:
    """Check BSDF files: energy, reciprocity, order of sides, labels, copies, gaps.

    A line for every finding. Exit status: 0 all sound, 1 findings that can change
    results, 2 a file cannot be read.
    """
    reports: list[tuple[Path, tuple[Finding, ...], str]] = []
    for file in files:
        try:
            reports.append((file, check_bsdf(read_bsdf(file)), ""))
        except InputError as error:
            reports.append((file, (), str(error)))
    if as_json:
        typer.echo(findings_json(reports))
    for file, findings, reason in reports:
        if reason:
            typer.echo(" ".join(reason.split()), err=True)
        elif not as_json:
            for line in finding_lines(file, findings, all_of_them=every):
                typer.echo(line)
    if any(reason for _, _, reason in reports):
        return _UNREADABLE
    return int(any(f.matters for _, findings, _ in reports for f in findings))


@app.command(epilog="Example: clerestory bsdf plot blind.xml --from 40,90 -o blind.png")
def plot(
    file: BsdfFile,
    output: Picture,
    patch: Patches = None,
    source: Angles = None,
    function: FunctionChoice = "transmission_front",
    channel: Channel = "visible",
    curve: Curve = False,
) -> None:
    """Draw where light goes, as discs in false colour, or how much passes."""
    _draw([file], output, patch, source, function, channel, curve=curve)


@app.command(
    epilog="Example: clerestory bsdf compare a.xml b.xml --patch 63 -o figure.png"
)
def compare(
    files: BsdfFiles,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Figure with the layers side by side."),
    ] = None,
    patch: Patches = None,
    source: Angles = None,
    function: FunctionChoice = "transmission_front",
    channel: Channel = "visible",
    curve: Curve = False,
) -> None:
    """Compare two or more BSDFs with the first: numbers, and a figure."""
    if len(files) < 2:
        raise InputError("one BSDF file; two or more expected")
    bsdfs = [read_bsdf(file) for file in files]
    for file, bsdf in zip(files[1:], bsdfs[1:], strict=True):
        result = compare_bsdfs(bsdfs[0], bsdf, function=function, channel=channel)
        for line in comparison_lines(result, (str(files[0]), str(file))):
            typer.echo(line)
    if output is not None:
        _draw(files, output, patch, source, function, channel, curve=curve)


@app.command(epilog="Example: clerestory bsdf view blind.xml -o blind.html")
def view(
    file: BsdfFile,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="HTML file; it needs no network.")
    ],
) -> None:
    """Write an interactive view: choose a direction, see where its light goes."""
    write_view(read_bsdf(file), output)
    typer.echo(f"{output}: {output.stat().st_size / 1e6:.1f} MB")


@app.command(
    epilog="Example: clerestory bsdf insert traced.xml window.xml -o layer.xml"
)
def insert(
    source: Annotated[
        Path, typer.Argument(metavar="SOURCE", help="File whose data are taken.")
    ],
    template: Annotated[
        Path, typer.Argument(metavar="TEMPLATE", help="File that stays otherwise.")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="File to write.")],
    channels: Annotated[
        str, typer.Option("--channels", help="Such as visible,solar; all if not given.")
    ] = "",
    source_channel: Annotated[
        str | None,
        typer.Option("--from-channel", help="Channel of SOURCE that serves all."),
    ] = None,
) -> None:
    """Put the data of one BSDF file into another, which keeps all else.

    A layer traced by genBSDF becomes one that WINDOW reads, with the material,
    thickness and emissivities of the template.
    """
    wanted = [name.strip() for name in channels.split(",") if name.strip()]
    result = insert_blocks(
        source, template, output, channels=wanted, source_channel=source_channel
    )
    read_bsdf(output)
    typer.echo(f"{output}: {', '.join(result.blocks)} from {source}")
    if result.kept:
        typer.echo(f"{output}: {', '.join(result.kept)} as in {template}")


def _draw(
    files: list[Path],
    output: Path,
    patches: list[int] | None,
    sources: list[str] | None,
    function: Function,
    channel: str,
    *,
    curve: bool,
) -> None:
    kind = output.suffix.lower()
    if kind not in _PICTURES:
        raise InputError(
            f"picture {output.name!r}; a name in {', '.join(_PICTURES)} expected"
        )
    directions = [patch_direction(k, function) for k in patches or []]
    directions += [
        direction_from_angles(*two_angles(text), function) for text in sources or []
    ]
    bsdfs = [read_bsdf(file) for file in files]
    names = [file.stem for file in files]
    if curve:
        figure = share_figure(bsdfs, function=function, channel=channel, names=names)
    else:
        figure = lobe_figure(
            bsdfs,
            directions or [patch_direction(0, function)],
            function=function,
            channel=channel,
            names=names,
        )
    with replace_file(output) as stream:
        figure.savefig(stream, format=kind[1:], dpi=150)
