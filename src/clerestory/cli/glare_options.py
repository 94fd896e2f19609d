"""Options of `clerestory glare`, in our words and in evalglare's."""

from pathlib import Path
from typing import Annotated, Literal

import typer

Pictures = Annotated[
    list[Path],
    typer.Argument(metavar="PICTURE…", help="Fisheye pictures, .hdr, .pic or .exr."),
]
Format = Annotated[
    Literal["text", "json", "csv"],
    typer.Option("--format", help="text has the lines that evalglare prints."),
]
Detail = Annotated[
    bool, typer.Option("--detail", "-d", help="All indices, and the table of sources.")
]
Threshold = Annotated[
    float | None,
    typer.Option(
        "--threshold",
        "-b",
        help="Glare is brighter [cd/m²]; up to 100 a multiple of the average of the"
        " task or the picture. 2000, or 5 with a task, if not given.",
        metavar="X",
    ),
]
Task = Annotated[
    tuple[int, int, float] | None,
    typer.Option(
        "--task",
        "-t",
        help="Task: pixel to the right, pixel up from below, opening angle [rad].",
        metavar="X Y ANGLE",
    ),
]
ShownTask = Annotated[
    tuple[int, int, float] | None,
    typer.Option(
        "-T", help="As --task; blue in the check picture.", metavar="X Y ANGLE"
    ),
]
MergeAngle = Annotated[
    float,
    typer.Option(
        "--merge-angle",
        "-r",
        help="Sources nearer than half of it are one [rad].",
        metavar="ANGLE",
    ),
]
Smooth = Annotated[
    bool, typer.Option("--smooth", "-s", help="Fill the gaps within sources.")
]
Peak = Annotated[
    float,
    typer.Option(
        "--peak",
        "-Y",
        help="Brighter pixels are sources of their own [cd/m²].",
        metavar="L",
    ),
]
SplitPeaks = Annotated[
    bool,
    typer.Option("--peaks/--no-peaks", "-y/-x", help="Split peaks off their sources."),
]
Smallest = Annotated[
    float,
    typer.Option("--smallest", help="Leave out smaller sources [sr].", metavar="SR"),
]
FieldCut = Annotated[
    Literal["1", "2"] | None,
    typer.Option(
        "--field", "-G", help="Guth's field of view: 1 of either eye, 2 of both."
    ),
]
Illuminance = Annotated[
    float | None,
    typer.Option(
        "--illuminance",
        "-i",
        help="Illuminance of the eye as measured, for DGP [lux].",
        metavar="EV",
    ),
]
Filled = Annotated[
    tuple[float, int, int] | None,
    typer.Option(
        "--fill",
        "-I",
        help="As -i, for a picture cut above and below: from row YMAX upwards and from"
        " YMIN downwards, counted from below, it is filled with the last row seen.",
        metavar="EV YMAX YMIN",
    ),
]
Background = Annotated[
    Literal["cie", "average", "illuminance"],
    typer.Option("--background", help="Background luminance (evalglare -q 0, 1, 2)."),
]
Correction = Annotated[
    Literal["l+", "l-", "0"],
    typer.Option("--correction", "-C", help="l+ corrects DGP for dim rooms."),
]
Age = Annotated[
    float | None,
    typer.Option("--age", help="Correct DGP for the observer's age [years]."),
]
Position = Annotated[
    Literal["0", "1"],
    typer.Option("--position", "-P", help="Position index: 0 Guth, 1 Kim."),
]
ViewText = Annotated[
    str | None,
    typer.Option(
        "--view",
        help="View in place of the picture's: a view file, or options as in"
        ' "-vta -vh 180 -vv 180".',
        metavar="VIEW",
    ),
]
Mask = Annotated[
    Path | None,
    typer.Option(
        "--mask", "-A", help="Picture whose bright pixels mark a window.", metavar="F"
    ),
]
Band = Annotated[
    float | None,
    typer.Option(
        "--band", "-B", help="Statistics of a level band [rad].", metavar="ANGLE"
    ),
]
OneZone = Annotated[
    tuple[int, int, float] | None,
    typer.Option("--zone", "-l", help="Cut sources at a circle.", metavar="X Y ANGLE"),
]
TwoZones = Annotated[
    tuple[int, int, float, float] | None,
    typer.Option("--zones", "-L", help="… at two circles.", metavar="X Y ANGLE ANGLE"),
]
Check = Annotated[
    Path | None,
    typer.Option(
        "--check", "-c", help="Write the picture with coloured sources.", metavar="F"
    ),
]
Colour = Annotated[
    tuple[float, float, float] | None,
    typer.Option("--colour", "-u", help="One colour for all sources.", metavar="R G B"),
]
Weights = Annotated[
    tuple[float, float, float, float, float, float, float, float] | None,
    typer.Option(
        "--weights", "-w", help="Coefficients a1 … a5 c1 c2 c3 of DGP.", metavar="A1…"
    ),
]
OnlyIlluminance = Annotated[
    bool, typer.Option("-V", help="Print the illuminance of the eye only.")
]
Trust = Annotated[
    bool,
    typer.Option(
        "--trust", "-f", help="Evaluate in spite of doubts about the picture."
    ),
]
Annual = Annotated[
    Path | None,
    typer.Option(
        "--annual",
        help="Take the pictures for time steps through one view; write their glare to"
        " .nc or .csv.",
        metavar="OUT",
    ),
]
