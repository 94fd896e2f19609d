"""Options that several commands share, spelt the same everywhere."""

from pathlib import Path
from typing import Annotated

import typer

from clerestory.engine.device import Device
from clerestory.matrix.radiance_format import Encoding

SceneFiles = Annotated[
    list[Path],
    typer.Option(
        "--scene", help="Radiance scene files, materials first.", metavar="F…"
    ),
]
WindowFiles = Annotated[
    list[Path],
    typer.Option(
        "--window",
        help="Radiance files of windows whose front faces the room.",
        metavar="F…",
    ),
]
SensorFile = Annotated[
    Path,
    typer.Option("--sensors", help="Sensors, x y z dx dy dz a line.", metavar="F"),
]
SensorsOrView = Annotated[
    Path | None,
    typer.Option(
        "--sensors",
        help="Sensors, x y z dx dy dz a line; or a picture by --view.",
        metavar="F",
    ),
]
_VIEW = typer.Option(
    "--view", help="View file, or its text: '-vta -vp 1 2 1.2 …'.", metavar="F"
)
RequiredView = Annotated[str, _VIEW]
ViewText = Annotated[str | None, _VIEW]
Resolution = Annotated[
    int,
    typer.Option(
        "--resolution", help="Columns or rows of a picture, the larger.", min=1
    ),
]
Samples = Annotated[
    int | None,
    typer.Option(
        "--samples", help="Paths per row of the matrix; or …", min=1, metavar="N"
    ),
]
RelativeError = Annotated[
    float | None,
    typer.Option(
        "--relative-error",
        help="… trace until this standard error is reached; 0.01 if neither is given.",
        metavar="X",
    ),
]
Bounces = Annotated[
    int | None,
    typer.Option(
        "--bounces",
        help="Most bounces, counted as Radiance's -ab; no limit if not given.",
        min=0,
        metavar="N",
    ),
]
Subdivision = Annotated[
    int,
    typer.Option(
        "--sky-subdivision",
        help="Reinhart's subdivision of the sky.",
        min=1,
        max=6,
        metavar="1..6",
    ),
]
Seed = Annotated[
    int,
    typer.Option("--seed", help="Random numbers: same seed, same result.", min=0),
]
DeviceOption = Annotated[Device, typer.Option("--device", help="Where to compute.")]
ClusterAddress = Annotated[
    str | None,
    typer.Option(
        "--cluster",
        help="Scheduler of a dask cluster that traces, such as tcp://10.0.0.1:8786.",
        metavar="ADDRESS",
    ),
]
Quiet = Annotated[
    bool, typer.Option("--quiet", "-q", help="Say nothing but errors and warnings.")
]
Output = Annotated[
    Path,
    typer.Option("--output", "-o", help="File to write; .nc keeps errors and labels."),
]
Format = Annotated[
    Encoding,
    typer.Option("--format", help="Numbers in a Radiance matrix file (not for .nc)."),
]
