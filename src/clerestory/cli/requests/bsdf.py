"""Requests of `clerestory bsdf`: BSDF files of layers."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import Command
from clerestory.cli.requests.bsdf_generate import COMMAND as GENERATE
from clerestory.cli.requests.common import (
    BsdfFile,
    BsdfOutput,
    FigureOutput,
    Function,
    Halvings,
)
from clerestory.options import Argument, option

BsdfFiles = Annotated[list[Path], Argument("BSDF files.", "FILE…")]


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """What a figure of BSDFs shows."""

    patch: Annotated[
        list[int] | None,
        option(
            "Incident Klems patch, counted from 0 (WINDOW counts from 1); repeatable.",
            metavar="N",
        ),
    ] = None
    source: Annotated[
        list[str] | None,
        option(
            "Incident direction: angle to the normal and azimuth [°], 90 is up;"
            " repeatable.",
            "--from",
            metavar="THETA,PHI",
        ),
    ] = None
    function: Annotated[Function, option("Which of the four functions.")] = (
        "transmission_front"
    )
    channel: Annotated[str, option("Visible, solar, nir, …")] = "visible"
    curve: Annotated[
        bool, option("Draw direct-hemispherical values over angles, not discs.")
    ] = False


@dataclass(frozen=True, kw_only=True)
class BsdfInfo:
    """Describe a BSDF file: product, bases, transmittances and reflectances."""

    file: BsdfFile


@dataclass(frozen=True, kw_only=True)
class CheckBsdf:
    """Check BSDF files: energy, reciprocity, order of sides, labels, copies, gaps.

    One line per finding. Exit status: 0 no finding, 1 findings that can change results,
    2 a file cannot be read.
    """

    files: BsdfFiles
    every: Annotated[
        bool, option("Print remarks too, not only findings that matter.", "--all")
    ] = False
    as_json: Annotated[bool, option("Print JSON.", "--json")] = False


@dataclass(frozen=True, kw_only=True)
class PlotBsdf:
    """Plot scattering as discs in false colour, or the transmittance over angles."""

    file: BsdfFile
    output: FigureOutput
    drawing: Drawing


@dataclass(frozen=True, kw_only=True)
class CompareBsdfs:
    """Compare one or more BSDFs with the first: differences, and a figure."""

    files: BsdfFiles
    output: Annotated[
        Path | None, option("Figure with the layers side by side.", "-o")
    ] = None
    drawing: Drawing


@dataclass(frozen=True, kw_only=True)
class ViewBsdf:
    """Write an interactive view: choose an incident direction, see the scattering."""

    file: BsdfFile
    output: Annotated[Path, option("HTML file; it needs no network.", "-o")]


@dataclass(frozen=True, kw_only=True)
class InsertBsdf:
    """Insert the data of one BSDF file into another, which keeps everything else.

    A layer traced by genBSDF becomes one that WINDOW reads, with the material,
    thickness and emissivities of the template.
    """

    source: Annotated[Path, Argument("File whose data are inserted.", "SOURCE")]
    template: Annotated[Path, Argument("File that receives them.", "TEMPLATE")]
    output: Annotated[Path, option("File to write.", "-o")]
    channels: Annotated[str, option("Such as visible,solar; all if not given.")] = ""
    source_channel: Annotated[
        str | None,
        option("Channel of SOURCE to be used for all channels.", "--from-channel"),
    ] = None


@dataclass(frozen=True, kw_only=True)
class ConvertBsdf:
    """Convert a BSDF to another basis or to a tensor tree; flux is conserved."""

    file: BsdfFile
    output: BsdfOutput
    to: Annotated[
        Literal["full", "half", "quarter", "tree", "same"],
        option("Klems basis, or a tensor tree of rank 4."),
    ] = "full"
    halvings: Halvings = 5
    reciprocal: Annotated[bool, option("Average with the reverse function first.")] = (
        False
    )


@dataclass(frozen=True, kw_only=True)
class ReduceBsdf:
    """Reduce a tensor tree, and print the loss of accuracy; flux is conserved."""

    file: BsdfFile
    output: BsdfOutput
    percent: Annotated[float, option("Share of the smallest cells to merge.", "-t")] = (
        95.0
    )


@dataclass(frozen=True, kw_only=True)
class PackageBsdf:
    """Make a scene file of a BSDF: surfaces that scatter by it, and its geometry.

    The layer is centred on the origin, y up, its room side towards +z. Geometry in the
    file is placed between a front and a back surface.
    """

    file: BsdfFile
    output: Annotated[
        Path | None, option("Scene file; standard output if not given.", "-o")
    ] = None
    xform: Annotated[str, option('Transformation, such as "-rx 90 -t 1 0 2".')] = ""


HELP = "BSDF files of layers."
COMMANDS = {
    "convert": Command(
        ConvertBsdf, "bsdf_convert:convert", "tree.xml --to full -o matrix.xml"
    ),
    "reduce": Command(
        ReduceBsdf, "bsdf_convert:reduce", "tree.xml --percent 95 -o small.xml"
    ),
    "package": Command(PackageBsdf, "bsdf_package:package", "blind.xml -o blind.rad"),
    "generate": GENERATE,
    "info": Command(BsdfInfo, "bsdf:info", "blind.xml"),
    "check": Command(CheckBsdf, "bsdf:check", "blind.xml shade.xml"),
    "plot": Command(PlotBsdf, "bsdf:plot", "blind.xml --from 40,90 -o blind.png"),
    "compare": Command(
        CompareBsdfs, "bsdf:compare", "a.xml b.xml --patch 63 -o figure.png"
    ),
    "view": Command(ViewBsdf, "bsdf:view", "blind.xml -o blind.html"),
    "insert": Command(InsertBsdf, "bsdf:insert", "traced.xml window.xml -o layer.xml"),
}
