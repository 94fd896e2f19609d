"""Requests of `clerestory render`, `irradiance`, `illum` and `multiply`."""

from pathlib import Path
from typing import Literal

from clerestory.cli.command import command
from clerestory.cli.requests import common
from clerestory.options import argument, option, required


@command(
    "render:render",
    "--scene materials.rad room.rad --view desk.vf --sky 'gensky 9 21 12 +s -a 48"
    " -o -11 -m -15' -o noon.hdr",
)
class Render:
    """Render a picture of a scene under a sky.

    The scene may contain its sky. Without --samples or --relative-error, paths are
    traced until the standard error of a pixel is on average 2 %.
    """

    scene: common.SceneFiles
    view: common.ViewText
    output: common.PictureOutput
    sky: common.SkyChoice
    resolution: common.Resolution = 512
    spectral: common.SpectralBands = ""
    spectrum: common.NamedSpectra = None
    effort: common.EffortOptions
    dgp_error: float | None = option(
        None,
        "Instead of --samples and --relative-error: standard error of DGP to reach, for"
        " fisheye views of 180°.",
        metavar="X",
    )
    preview: bool = option(
        False, "Write the picture after each round, from coarse to fine."
    )
    error: Path | None = option(None, "Picture of the standard errors to write.")
    illuminance: bool = option(False, "Render irradiance, as rpict -i does.")
    denoise: bool = option(False, "Denoise for display; the header records it.")
    quiet: common.Quiet = False


@command(
    "irradiance:irradiance",
    "--scene materials.rad room.rad --sensors desks.pts --sky 'gensky 9 21 12 +s -a 48"
    " -o -11 -m -15' -o desks.csv",
)
class Irradiance:
    """Compute illuminance and irradiance of sensors under a sky, like rtrace -I.

    The scene may contain its sky. Without --samples or --relative-error, paths are
    traced until the standard error of each sensor is 2 %. The first bounce is the light
    that arrives at the sensor: --bounces 1 is rtrace -ab 0 plus the light of the sky.
    """

    scene: common.SceneFiles
    sensors: Path = required(
        "Sensor file, x y z dx dy dz per line; - for standard input.", metavar="F"
    )
    sky: common.SkyChoice
    output: Path | None = option(
        None, "Table to write; default: standard output.", "-o", metavar="F"
    )
    form: Literal["csv", "text"] = option(
        "csv",
        "csv: sensor, illuminance [lux], irradiance [W/m²] and their standard errors;"
        " text: irradiance R G B per line, as rtrace -h -I.",
        "--format",
    )
    effort: common.EffortOptions
    quiet: common.Quiet = False


@command(
    "illum:illum",
    "--scene materials.rad room.rad --panes window.rad --sky 'gensky 9 21 12 +s'"
    " -o emitters.rad",
)
class Illum:
    """Precompute window emitters: trace the emission of windows, like mkillum.

    To render, replace the pane file by the written file. Without --samples or
    --relative-error, paths are traced until the standard error of the radiance in a
    direction is on average 3 %.
    """

    scene: common.SceneFiles
    panes: Path = required(
        "Scene file of the panes, whose fronts face the room.", metavar="F"
    )
    output: Path = required(
        "Scene file to write; data files are written to the same folder.", "-o"
    )
    sky: common.SkyChoice
    zone: float = option(float("inf"), "Maximum edge of a pane part [m].")
    rings: int = option(18, "Number of polar rings; twice as many azimuths.")
    effort: common.EffortOptions
    quiet: common.Quiet = False


@command("multiply:multiply", "V.mtx blind.xml D.mtx S.smx -o E.mtx")
class Multiply:
    """Multiply two to five matrices from left to right; add products.

    V.mtx T.xml D.mtx S.smx gives the irradiance [W/m²] of every sensor at every time
    step, like dctimestep; RGB weights of 47.4, 119.9 and 11.6 give illuminance. If the
    first factor is a set of pictures V_%03d.hdr, OUT is a set of one picture per time
    step. For a shade with several ports, F-a.nc D-a.nc + F-b.nc D-b.nc is the daylight
    matrix of the window.
    """

    factors: list[Path] = argument(
        "Matrix files (.mtx .smx .nc), BSDF files (.xml, transmission), or, as first"
        " factor, a set of pictures (V_%03d.hdr). + adds products.",
        "A B [C D E] [+ A B …]",
    )
    file: common.MatrixFile
