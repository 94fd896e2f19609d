"""Requests of `clerestory bsdf`: BSDF files of layers."""

from pathlib import Path
from typing import Annotated, Any, Literal

from clerestory.cli.command import command
from clerestory.cli.requests import common
from clerestory.options import Argument, argument, option, options, required

HELP = "BSDF files of layers."

BsdfFiles = Annotated[list[Path], Argument("BSDF files, or library:NAME.", "FILE…")]


@options
class Drawing:
    """Content of a BSDF figure: incident directions, scattering function, channel."""

    patch: list[int] | None = option(
        None, "Incident Klems patch, from 0 (WINDOW: from 1); repeatable.", metavar="N"
    )
    source: list[str] | None = option(
        None,
        "Incident direction: angle to the normal and azimuth [°], 90 is up;"
        " repeatable.",
        "--from",
        metavar="THETA,PHI",
    )
    function: common.Function = option("transmission_front", "Scattering function.")
    channel: str = option("visible", "Visible, solar, nir, …")
    curve: bool = option(False, "Draw hemispherical values over the angle.")


@command("bsdf_library:library", "venetian")
class BsdfLibrary:
    """List the built-in BSDFs and spectra, or write one to a file.

    They are used by name wherever a BSDF file is expected, as `library:double-lowe-6`;
    `@45` tilts slats, and `+` joins layers from outdoors to indoors. Spectra are
    measured reflectances of materials, used as `library:pine` where a file is expected.
    """

    name: str | None = argument(
        "Part of the names to list; with -o, the name of one.", "[NAME]", default=None
    )
    output: Path | None = option(
        None, "BSDF file, or text file of a spectrum, to write.", "-o"
    )


@command("bsdf:info", "blind.xml")
class BsdfInfo:
    """Describe a BSDF file: product, bases, transmittances and reflectances."""

    file: common.BsdfFile


@command("bsdf:check", "blind.xml shade.xml")
class CheckBsdf:
    """Check BSDF files: energy, reciprocity, sides, labels, duplicates, gaps.

    One line per finding, and one on the programs that can read the file. Exit status: 0
    no finding, 1 findings that can change results, 2 a file cannot be read.
    """

    files: BsdfFiles
    every: bool = option(False, "Also print findings that affect no result.", "--all")
    as_json: bool = option(False, "Print JSON.", "--json")


@command("bsdf:plot", "blind.xml --from 40,90 -o blind.png")
class PlotBsdf:
    """Plot a BSDF as false-colour discs, or hemispherical values over the angle."""

    file: common.BsdfFile
    output: common.FigureOutput
    drawing: Drawing


@command("bsdf:compare", "a.xml b.xml --patch 63 -o figure.png")
class CompareBsdfs:
    """Compare BSDFs with the first BSDF: print differences, draw a figure."""

    files: BsdfFiles
    output: Path | None = option(None, "Figure with the layers side by side.", "-o")
    drawing: Drawing


@command("bsdf:view", "blind.xml -o blind.html")
class ViewBsdf:
    """Write an interactive HTML view of a BSDF for selectable incident directions."""

    file: common.BsdfFile
    output: Path | None = option(
        None, "Self-contained HTML file to write; default: the name with .html.", "-o"
    )


@command("bsdf:insert", "traced.xml window.xml -o layer.xml")
class InsertBsdf:
    """Insert the data of one BSDF file into another file, used as a template.

    WINDOW can then read a layer traced by genBSDF, with the material, thickness and
    emissivities of the template.
    """

    source: Path = argument("File whose data are inserted.", "SOURCE")
    template: Path = argument("File into which they are inserted.", "TEMPLATE")
    output: Path = required("File to write.", "-o")
    channels: str = option("", "Channels, such as visible,solar; default: all.")
    source_channel: str | None = option(
        None, "Channel of SOURCE used for all channels.", "--from-channel"
    )


@command("bsdf_convert:convert", "tree.xml --to full -o matrix.xml")
class ConvertBsdf:
    """Convert a BSDF to another basis or to a tensor tree; flux is conserved."""

    file: common.BsdfFile
    output: common.BsdfOutput
    to: Literal["full", "half", "quarter", "tree", "same"] = option(
        "full", "Klems basis, or a tensor tree of rank 4."
    )
    halvings: common.Halvings = 5
    reduction: float = option(
        75.0, "Percentage of the smallest cells of a new tree to merge.", "--reduce"
    )
    reciprocal: bool = option(False, "Average with the reverse function first.")


@command("bsdf_convert:reduce", "tree.xml --percent 95 -o small.xml")
class ReduceBsdf:
    """Merge cells of a tensor tree; flux is conserved, the loss of accuracy printed."""

    file: common.BsdfFile
    output: common.BsdfOutput
    percent: float = option(95.0, "Percentage of the smallest cells to merge.", "-t")


@command("bsdf_package:package", "blind.xml -o blind.rad")
class PackageBsdf:
    """Write a Radiance scene file of a BSDF: BSDF surfaces and shading geometry.

    The layer is centred at the origin, y up, room side towards +z. Geometry in the BSDF
    file is placed between a front and a back surface.
    """

    file: common.BsdfFile
    output: Path | None = option(None, "Scene file; default: standard output.", "-o")
    xform: str = option("", 'Transformation, such as "-rx 90 -t 1 0 2".')


def _kind(example: str) -> Any:
    return option(
        None,
        f"Parametric system, such as {example}; lengths in metres.",
        metavar="NAME=VALUE,…",
        panel="Parametric systems",
    )


@options
class ParametricSystem:
    """Options that choose a shading system by its parameters; at most one is given."""

    venetian: str | None = _kind("slat_width=0.08,spacing=0.072,tilt_deg=45")
    microlouvre: str | None = _kind("cutoff_deg=40, or default")
    prismatic: str | None = _kind("upper_angle_deg=60, or default")
    mirrored_channels: str | None = _kind("pitch=0.001, or default")
    perforated: str | None = _kind("pitch=0.002,hole=0.001")
    woven: str | None = _kind("spacing=0.001,thread=0.0003")
    fabric: str | None = _kind("openness=0.03,reflectance=0.5")
    diffuse_pane: str | None = _kind("transmittance=0.5")
    clear_pane: str | None = _kind("transmissivity=0.96, or default")


@options
class Tracing:
    """Options of BSDF tracing, with the names of the keywords of `generate_bsdf`."""

    basis: Literal["full", "half", "quarter", "tree3", "tree4"] = option(
        "full", "Klems basis, or a tensor tree of rank 3 or 4."
    )
    halvings: common.Halvings = 5
    sides: Literal["both", "front", "back"] = option("both", "Sides of incident light.")
    colour: bool = option(False, "Write CIE X and Z too; u' and v' for trees.")
    samples: int | None = option(
        None, "Paths per patch or cell (default 2000); or …", metavar="N", least=1
    )
    relative_error: float | None = option(
        None, "… root mean square error relative to the mean value.", metavar="X"
    )
    bounces: common.Bounces = None
    symmetry: bool = option(
        True, "Trace one of two symmetric patches.", "--symmetry/--no-symmetry"
    )
    reciprocal: bool = option(False, "Average with the reverse function.")
    reduction: float = option(0.0, "Percentage of cells to merge.", "--reduce")
    geometry: bool = option(True, "Include the geometry.", "--geometry/--no-geometry")
    name: str = option("", "Name of the product.")
    seed: common.Seed = 1
    device: common.DeviceName = "auto"


@command(
    "bsdf_generate:generate",
    "--venetian slat_width=0.08,spacing=0.072,tilt_deg=45 -o blind.xml",
)
class GenerateBsdf:
    """Trace the BSDF of a shading system, as genBSDF does.

    +x is the width, +y up, +z into the room; all geometry is at z ≤ 0.
    """

    output: common.BsdfOutput
    files: list[Path] | None = argument(
        "Radiance scene files, materials first.", "[FILE…]", default=None
    )
    system: Path | None = option(None, "TOML file of a parametric system.")
    kinds: ParametricSystem
    dimensions: tuple[float, float, float, float, float, float] | None = option(
        None,
        "Sample area [m], like genBSDF -dim; default: the bounding box.",
        "--dim",
        metavar="XMIN XMAX YMIN YMAX ZMIN ZMAX",
    )
    periodic: bool = option(False, "Repeat the sample area periodically.")
    band: list[str] | None = option(
        None, "Band and weights of red, green, blue; repeatable.", metavar="NAME=R/G/B"
    )
    spectral: common.SpectralBands = ""
    spectrum: common.NamedSpectra = None
    tracing: Tracing
    errors: Path | None = option(None, "BSDF file of the standard errors to write.")
    rad: Path | None = option(None, "Radiance scene file of the geometry to write.")
    quiet: common.Quiet = False
