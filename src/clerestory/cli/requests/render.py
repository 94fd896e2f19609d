"""Requests of `clerestory render`, `illum` and `multiply`."""

from dataclasses import dataclass
from pathlib import Path

from clerestory.cli.command import Command
from clerestory.cli.requests import common
from clerestory.options import argument, option, required


@dataclass(frozen=True, kw_only=True)
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
    effort: common.EffortOptions
    error: Path | None = option(None, "Picture of the standard errors to write.")
    illuminance: bool = option(
        False, "Render the irradiance of surfaces, as rpict -i does."
    )
    denoise: bool = option(
        False, "Denoise the picture for display; its header records it."
    )
    quiet: common.Quiet = False


@dataclass(frozen=True, kw_only=True)
class Illum:
    """Precompute window emitters: trace once what windows emit, as mkillum does.

    Render with the file written in place of the file of the panes. Without --samples or
    --relative-error, paths are traced until the standard error of a direction is on
    average 3 %.
    """

    scene: common.SceneFiles
    panes: Path = required(
        "Scene file of the window panes, in materials of the scene; fronts face the"
        " room.",
        metavar="F",
    )
    output: Path = required(
        "Scene file to write; its data files are written beside it.", "-o"
    )
    sky: common.SkyChoice
    zone: float = option(
        float("inf"), "Longest edge of a part with an emission table of its own [m]."
    )
    rings: int = option(18, "Rings of directions; twice as many directions in azimuth.")
    effort: common.EffortOptions
    quiet: common.Quiet = False


@dataclass(frozen=True, kw_only=True)
class Multiply:
    """Multiply two to five matrices from left to right, and add such products.

    V.mtx T.xml D.mtx S.smx gives the irradiance [W/m²] of every sensor at every
    time step, as dctimestep does; times 47.4, 119.9 and 11.6 it is illuminance. With
    a set of pictures V_%03d.hdr first, OUT is a set too, one picture per time step.
    Behind a shade with several ports, F-a.nc D-a.nc + F-b.nc D-b.nc is the D of the
    window.
    """

    factors: list[Path] = argument(
        "Matrix files (.mtx .smx .nc), a BSDF (.xml) for its transmission, or first"
        " a set of pictures (V_%03d.hdr). A + adds products.",
        "A B [C D E] [+ A B …]",
    )
    output: common.MatrixOutput
    encoding: common.MatrixEncoding = "float"
    quiet: common.Quiet = False


COMMANDS = {
    "render": Command(
        Render,
        "render:render",
        "--scene materials.rad room.rad --view desk.vf"
        " --sky 'gensky 9 21 12 +s -a 48 -o -11 -m -15' -o noon.hdr",
    ),
    "illum": Command(
        Illum,
        "illum:illum",
        "--scene materials.rad room.rad --panes window.rad"
        " --sky 'gensky 9 21 12 +s' -o emitters.rad",
    ),
    "multiply": Command(
        Multiply, "multiply:multiply", "V.mtx blind.xml D.mtx S.smx -o E.mtx"
    ),
}
