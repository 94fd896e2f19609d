"""Options that the commands of `clerestory gonio` share."""

from pathlib import Path
from typing import Annotated

import typer

from clerestory.bsdf.scattering_function import Function
from clerestory.gonio.formats.file_format import Facing
from clerestory.gonio.measurement_files import FORMATS
from clerestory.gonio.symmetry import Symmetry

Files = Annotated[
    list[Path],
    typer.Argument(
        metavar="FILE…", help="Files of one sample: pab-opto, VIAVI, RT-300S, …"
    ),
]
Fits = Annotated[
    list[Path], typer.Argument(metavar="FIT…", help="Files of clerestory gonio fit.")
]
Form = Annotated[
    str | None,
    typer.Option(
        "--format",
        metavar="|".join(FORMATS),
        help="Format of the files; recognized from the first one if not given.",
    ),
]
FunctionChoice = Annotated[
    Function | None,
    typer.Option("--function", help="Which light was measured, if files do not say."),
]
FacingChoice = Annotated[
    Facing, typer.Option("--facing", help="Where the normal of the sample looks.")
]
Blank = Annotated[
    Path | None, typer.Option("--blank", help="Readings without sample (RT-300S).")
]
Merge = Annotated[
    bool, typer.Option("--merge", help="Join scans of the same incident direction.")
]
SymmetryChoice = Annotated[
    Symmetry | None,
    typer.Option("--symmetry", help="Of the layer; told from the directions."),
]
MostLobes = Annotated[
    int, typer.Option("--lobes", help="Most lobes an incident direction.")
]
Smoothing = Annotated[
    float, typer.Option("--smoothing", help="Width of lobes; 1 is an even sum.")
]
Processes = Annotated[
    int, typer.Option("--processes", "-n", help="That share the work.", min=1)
]
Picture = Annotated[
    Path, typer.Option("--output", "-o", help="Picture to write: .png, .svg or .pdf.")
]
