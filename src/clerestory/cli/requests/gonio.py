"""Requests of `clerestory gonio`: from goniophotometer measurements to BSDFs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import Command
from clerestory.cli.requests.common import FigureOutput, Function, Halvings, Quiet
from clerestory.options import Argument, option

Symmetry = Literal[
    "isotropic", "quadrilateral", "bilateral-x", "bilateral-y", "rotational", "none"
]
SymmetryOption = Annotated[
    Symmetry | None,
    option("Symmetry of the layer; inferred from the directions if not given."),
]
Lobes = Annotated[int, option("Maximum number of lobes per incident direction.")]
Smoothing = Annotated[
    float, option("Factor on the width of lobes; 1 makes a uniform sum.")
]
Processes = Annotated[int, option("Number of processes.", "-n", least=1)]


@dataclass(frozen=True, kw_only=True)
class MeasurementFiles:
    """Files of measurements, and how to read them."""

    files: Annotated[
        list[Path],
        Argument("Files of one sample: pab-opto, VIAVI, RT-300S, …", "FILE…"),
    ]
    form: Annotated[
        str | None,
        option(
            "Format of the files, such as pabopto or astm; recognized from the first"
            " file if not given.",
            "--format",
            metavar="NAME",
        ),
    ] = None
    function: Annotated[
        Function | None, option("Function measured, if the files do not name it.")
    ] = None
    facing: Annotated[
        Literal["room", "sky"], option("Side towards which the sample's normal points.")
    ] = "room"
    blank: Annotated[Path | None, option("Readings without the sample (RT-300S).")] = (
        None
    )
    merge: Annotated[bool, option("Merge scans of the same incident direction.")] = (
        False
    )


@dataclass(frozen=True, kw_only=True)
class Fit:
    """Parameters of a fit."""

    symmetry: SymmetryOption = None
    lobes: Lobes = 200
    smoothing: Smoothing = 1.0
    processes: Processes = 1


@dataclass(frozen=True, kw_only=True)
class MeasurementInfo:
    """Describe the coverage of measurements: angles, gaps, noise, symmetry, flux.

    Exit status: 1 if quality checks find what can change results.
    """

    measurement: MeasurementFiles


@dataclass(frozen=True, kw_only=True)
class FitMeasurement:
    """Fit lobes to every scan, and compute transport plans between neighbours."""

    measurement: MeasurementFiles
    output: Annotated[Path, option("File to write, .nc.", "-o")]
    fit: Fit
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class CrossValidation:
    """Cross-validate: predict each incident direction from the others."""

    measurement: MeasurementFiles
    output: Annotated[Path | None, option("Map of the errors to write.", "-o")] = None
    symmetry: SymmetryOption = None
    lobes: Lobes = 200
    smoothing: Annotated[
        list[float] | None,
        option("Smoothing factor to try; repeatable. 1 if not given."),
    ] = None
    more: Annotated[
        int,
        option(
            "Number of further directions to recommend for scans.", "--next", least=0
        ),
    ] = 0
    processes: Processes = 1
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class ExportBsdf:
    """Write fits as one BSDF file for Radiance, WINDOW and Clerestory."""

    files: Annotated[list[Path], Argument("Files of clerestory gonio fit.", "FIT…")]
    output: Annotated[Path, option("BSDF file to write, .xml.", "-o")]
    to: Annotated[
        Literal["full", "half", "quarter", "tree"],
        option("Klems basis, or a tensor tree."),
    ] = "full"
    halvings: Halvings = 5
    tolerance: Annotated[float, option("Merge cells that differ by less.")] = 0.05
    reciprocal: Annotated[bool, option("Average with the reverse function.")] = False
    conserve: Annotated[
        bool, option("Scale down directions that scatter more than they receive.")
    ] = False
    processes: Processes = 1
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class PlotMeasurement:
    """Plot measured points, fitted lobes and the mesh, or light between two scans."""

    measurement: MeasurementFiles
    output: FigureOutput
    scan: Annotated[int, option("Number of the scan, from 0.", least=0)] = 0
    between: Annotated[
        list[str] | None,
        option(
            "Two incident directions; plot the interpolation half-way between them.",
            metavar="THETA,PHI",
        ),
    ] = None
    fit: Fit
    quiet: Quiet = False


HELP = "Goniophotometer measurements."
COMMANDS = {
    "info": Command(MeasurementInfo, "gonio:info", "scans/*.txt"),
    "fit": Command(FitMeasurement, "gonio:fit", "scans/*.txt -o film.nc"),
    "check": Command(CrossValidation, "gonio:check", "scans/*.txt -o errors.png"),
    "export": Command(ExportBsdf, "gonio:export", "film.nc --to tree -o film.xml"),
    "plot": Command(PlotMeasurement, "gonio:plot", "scans/*.txt --scan 3 -o scan.png"),
}
