"""Requests of `clerestory gonio`: from goniophotometer measurements to BSDFs."""

from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import command
from clerestory.cli.requests import common
from clerestory.options import Option, argument, option, options, required

HELP = "Goniophotometer measurements."

Symmetry = Literal[
    "isotropic", "quadrilateral", "bilateral-x", "bilateral-y", "rotational", "none"
]
SymmetryOption = Annotated[
    Symmetry | None,
    Option("Symmetry of the layer; default: inferred from the directions."),
]
Lobes = Annotated[int, Option("Maximum number of lobes per incident direction.")]
Smoothing = Annotated[
    float, Option("Factor on the width of the lobes; with 1, their sum is smooth.")
]
Processes = Annotated[int, Option("Number of processes.", "-n", least=1)]


@options
class MeasurementFiles:
    """Measurement files, and options for reading them."""

    files: list[Path] = argument("Files of one sample (pab-opto, VIAVI, …).", "FILE…")
    form: str | None = option(
        None, "Format, such as pabopto or astm; default: detected.", "--format"
    )
    function: common.Function | None = option(
        None, "Measured function, if the files do not state it."
    )
    facing: Literal["room", "sky"] = option("room", "Side of the sample normal.")
    blank: Path | None = option(None, "Readings without the sample (RT-300S).")
    merge: bool = option(False, "Merge scans of the same incident direction.")


@options
class Fit:
    """Options of the fit of lobes to scans."""

    symmetry: SymmetryOption = None
    lobes: Lobes = 200
    smoothing: Smoothing = 1.0
    processes: Processes = 1


@command("gonio:info", "scans/*.txt")
class MeasurementInfo:
    """Describe measured scans: angular range, gaps, noise, symmetry, flux.

    Exit status: 1 if a finding of the quality checks can change results.
    """

    measurement: MeasurementFiles


@command("gonio:fit", "scans/*.txt -o film.nc")
class FitMeasurement:
    """Fit lobes to every scan, and compute transport plans between adjacent scans."""

    measurement: MeasurementFiles
    output: Path = required("File to write, .nc.", "-o")
    fit: Fit
    quiet: common.Quiet = False


@command("gonio:check", "scans/*.txt -o errors.png")
class CrossValidation:
    """Cross-validate: predict the scan of each incident direction from other scans."""

    measurement: MeasurementFiles
    output: Path | None = option(None, "Map of the errors to write.", "-o")
    symmetry: SymmetryOption = None
    lobes: Lobes = 200
    smoothing: list[float] | None = option(
        None, "Smoothing factor to test; repeatable. Default: 1."
    )
    more: int = option(0, "Number of further scans to recommend.", "--next", least=0)
    processes: Processes = 1
    quiet: common.Quiet = False


@command("gonio:export", "film.nc --to tree -o film.xml")
class ExportBsdf:
    """Write fitted lobes as one BSDF file for Radiance, WINDOW and Clerestory."""

    files: list[Path] = argument("Files written by clerestory gonio fit.", "FIT…")
    output: Path = required("BSDF file to write, .xml.", "-o")
    to: Literal["full", "half", "quarter", "tree"] = option(
        "full", "Klems basis, or a tensor tree."
    )
    halvings: common.Halvings = 5
    tolerance: float = option(0.05, "Relative difference below which cells are merged.")
    reciprocal: bool = option(False, "Average with the reverse function.")
    conserve: bool = option(False, "Scale down directions that gain energy.")
    processes: Processes = 1
    quiet: common.Quiet = False


@command("gonio:plot", "scans/*.txt --scan 3 -o scan.png")
class PlotMeasurement:
    """Plot measured points and fitted lobes of a scan, or an interpolation of scans."""

    measurement: MeasurementFiles
    output: common.FigureOutput
    scan: int = option(0, "Number of the scan, from 0.", least=0)
    between: list[str] | None = option(
        None, "Two directions; plot the interpolation half-way.", metavar="THETA,PHI"
    )
    fit: Fit
    quiet: common.Quiet = False
