"""Options that several commands share."""

from pathlib import Path
from typing import Annotated, Literal

from clerestory.options import Argument, Option, option, options, required

Device = Literal["auto", "cpu", "cuda"]
Encoding = Literal["ascii", "float", "double"]
Function = Literal[
    "transmission_front", "transmission_back", "reflection_front", "reflection_back"
]

SceneFiles = Annotated[
    list[Path],
    Option("Radiance scene files, materials first.", "--scene", metavar="F…"),
]
WindowFiles = Annotated[
    list[Path],
    Option("Radiance files of windows that face the room.", "--window", metavar="F…"),
]
_VIEW = Option(
    "View file, or view options such as '-vta -vp 1 2 1.2 …'.", "--view", metavar="F"
)
ViewText = Annotated[str, _VIEW]
Resolution = Annotated[
    int, Option("Larger of the numbers of columns and rows.", "--resolution", least=1)
]
Bounces = Annotated[
    int | None,
    Option(
        "Maximum number of bounces, as -ab; default: unlimited.", metavar="N", least=0
    ),
]
Seed = Annotated[int, Option("Seed of the random numbers.", "--seed", least=0)]
DeviceName = Annotated[Device, Option("Compute device.")]
ClusterAddress = Annotated[
    str | None,
    Option("Dask scheduler for tracing, as tcp://10.0.0.1:8786.", metavar="ADDRESS"),
]
SkySubdivision = Annotated[
    int, Option("Subdivision of the sky (MF).", "--sky-subdivision", least=1, most=6)
]
SpectralBands = Annotated[
    str,
    Option("Spectral bands: 20, 81 or melanopic+photopic.", metavar="BANDS"),
]
NamedSpectra = Annotated[
    list[str] | None,
    Option(
        "With --spectral: spectrum of a material, a file or library:NAME; repeatable.",
        metavar="MATERIAL=FILE",
    ),
]
Quiet = Annotated[bool, Option("Print only warnings and errors.", "-q")]
PictureOutput = Annotated[Path, Option("Picture to write: .hdr or .exr.", "-o")]
FigureOutput = Annotated[Path, Option("Figure to write: .png, .svg or .pdf.", "-o")]
PictureFile = Annotated[
    Path, Argument("Picture: Radiance (.hdr, .pic) or OpenEXR (.exr).", "PICTURE")
]
BsdfFile = Annotated[Path, Argument("BSDF file to read, or library:NAME.", "FILE")]
BsdfOutput = Annotated[Path, Option("BSDF file to write.", "-o")]
Halvings = Annotated[int, Option("2^N cells along each axis of a tensor tree.")]


@options
class SensorsOrView:
    """Receivers of a matrix: the points of a sensor file, or the pixels of a view."""

    sensors: Path | None = option(
        None, "Sensor file, x y z dx dy dz per line; or use --view.", metavar="F"
    )
    view: Annotated[str | None, _VIEW] = None
    resolution: Resolution = 400


@options
class SkyChoice:
    """A sky at one instant: scene file, sky command, or weather file and time."""

    sky: str | None = option(
        None, "Sky: scene file, or command such as 'gensky 9 21 12 +s'.", metavar="F"
    )
    time: str | None = option(
        None,
        "Time such as 2026-09-21T12:00, with --weather: the sun at this time, with the"
        " irradiance of the time step that contains it.",
        metavar="T",
    )
    weather: Path | None = option(None, "Weather file for --time.", metavar="F")


@options
class EffortOptions:
    """Sampling effort, and compute device."""

    samples: int | None = option(
        None, "Paths per matrix row, sensor or pixel; or …", metavar="N", least=1
    )
    relative_error: float | None = option(
        None,
        "… relative standard error to reach; default: 0.01 for matrices, 0.02 for"
        " pictures and sensors, 0.03 for illums.",
        metavar="X",
    )
    bounces: Bounces = None
    seed: Seed = 1
    device: DeviceName = "auto"
    cluster: ClusterAddress = None


@options
class SunEffort:
    """Sampling effort of direct-sun coefficients, and compute device."""

    samples: int | None = option(
        None,
        "Paths per matrix row, for all suns together; default: 1024 per sensor, 16 per"
        " pixel.",
        metavar="N",
        least=1,
    )
    seed: Seed = 1
    device: DeviceName = "auto"
    cluster: ClusterAddress = None


@options
class MatrixFile:
    """Output file of a matrix, its encoding, and whether a summary is printed."""

    output: Path = required("File; .nc keeps standard errors and labels.", "-o")
    encoding: Encoding = option("float", "Encoding, except for .nc.", "--format")
    quiet: Quiet = False
