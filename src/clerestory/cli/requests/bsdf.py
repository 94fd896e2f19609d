"""Requests of `clerestory bsdf`: BSDF files of layers."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import Command
from clerestory.cli.requests import common
from clerestory.cli.requests.bsdf_generate import COMMAND as GENERATE
from clerestory.options import Argument, argument, option, required

BsdfFiles = Annotated[list[Path], Argument("BSDF files.", "FILE…")]


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """Content of a figure of BSDFs."""

    patch: list[int] | None = option(
        None,
        "Incident Klems patch, counted from 0 (WINDOW counts from 1); repeatable.",
        metavar="N",
    )
    source: list[str] | None = option(
        None,
        "Incident direction: angle to the normal and azimuth [°], 90 is up;"
        " repeatable.",
        "--from",
        metavar="THETA,PHI",
    )
    function: common.Function = option(
        "transmission_front", "Transmission or reflection function."
    )
    channel: str = option("visible", "Visible, solar, nir, …")
    curve: bool = option(
        False, "Draw direct-hemispherical values over the angle instead of discs."
    )


@dataclass(frozen=True, kw_only=True)
class BsdfInfo:
    """Describe a BSDF file: product, bases, transmittances and reflectances."""

    file: common.BsdfFile


@dataclass(frozen=True, kw_only=True)
class CheckBsdf:
    """Check BSDF files: energy, reciprocity, sides, labels, duplicates, gaps.

    One line per finding. Exit status: 0 no finding, 1 findings that can change results,
    2 a file cannot be read.
    """

    files: BsdfFiles
    every: bool = option(
        False, "Print all findings, not only those that affect results.", "--all"
    )
    as_json: bool = option(False, "Print JSON.", "--json")


@dataclass(frozen=True, kw_only=True)
class PlotBsdf:
    """Plot scattering as false-colour discs, or the transmittance over angles."""

    file: common.BsdfFile
    output: common.FigureOutput
    drawing: Drawing


@dataclass(frozen=True, kw_only=True)
class CompareBsdfs:
    """Compare BSDFs with the first one: print differences, draw a figure."""

    files: BsdfFiles
    output: Path | None = option(None, "Figure with the layers side by side.", "-o")
    drawing: Drawing


@dataclass(frozen=True, kw_only=True)
class ViewBsdf:
    """Write an interactive HTML view of the scattering per incident direction."""

    file: common.BsdfFile
    output: Path = required("Self-contained HTML file to write.", "-o")


@dataclass(frozen=True, kw_only=True)
class InsertBsdf:
    """Insert the data of one BSDF file into another file, used as a template.

    This makes layers traced by genBSDF readable by WINDOW, with the material, thickness
    and emissivities of the template.
    """

    source: Path = argument("File whose data are inserted.", "SOURCE")
    template: Path = argument("File into which they are inserted.", "TEMPLATE")
    output: Path = required("File to write.", "-o")
    channels: str = option("", "Channels, such as visible,solar; default: all.")
    source_channel: str | None = option(
        None, "Channel of SOURCE used for all channels.", "--from-channel"
    )


@dataclass(frozen=True, kw_only=True)
class ConvertBsdf:
    """Convert a BSDF to another basis or to a tensor tree; flux is conserved."""

    file: common.BsdfFile
    output: common.BsdfOutput
    to: Literal["full", "half", "quarter", "tree", "same"] = option(
        "full", "Klems basis, or a tensor tree of rank 4."
    )
    halvings: common.Halvings = 5
    reciprocal: bool = option(False, "Average with the reverse function first.")


@dataclass(frozen=True, kw_only=True)
class ReduceBsdf:
    """Reduce a tensor tree, and print the loss of accuracy; flux is conserved."""

    file: common.BsdfFile
    output: common.BsdfOutput
    percent: float = option(95.0, "Percentage of the smallest cells to merge.", "-t")


@dataclass(frozen=True, kw_only=True)
class PackageBsdf:
    """Write a scene file of a BSDF: surfaces with the BSDF, and its geometry.

    The layer is centred at the origin, y up, room side towards +z. Geometry in the file
    is placed between a front and a back surface.
    """

    file: common.BsdfFile
    output: Path | None = option(
        None, "Scene file to write; default: standard output.", "-o"
    )
    xform: str = option("", 'Transformation, such as "-rx 90 -t 1 0 2".')


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
