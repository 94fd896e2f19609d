"""Requests of `clerestory trace`: transfer matrices."""

from pathlib import Path

from clerestory.cli.command import command
from clerestory.cli.requests import common
from clerestory.options import option, required

HELP = "Trace transfer matrices."


@command(
    "trace:view",
    "--scene materials.rad room.rad --window window.rad --sensors desks.pts"
    " --relative-error 0.01 -o V.mtx",
)
class ViewMatrix:
    """View matrix: irradiance of sensors per radiance of window patches [sr].

    With --view, radiance of pixels per radiance of window patches; an output such as
    V_%03d.hdr is one picture per patch. With several window groups, one file is written
    per group: V.mtx becomes V-south.mtx.
    """

    scene: common.SceneFiles
    window: common.WindowFiles
    receiver: common.SensorsOrView
    direct: bool = option(False, "Trace only direct light, for V_d (five-phase).")
    effort: common.EffortOptions
    file: common.MatrixFile


@command(
    "trace:daylight",
    "--scene materials.rad room.rad --window window.rad --sky-subdivision 4"
    " --relative-error 0.01 -o D.mtx",
)
class DaylightMatrix:
    """Daylight matrix: radiance of window patches per radiance of sky patches.

    With several window groups, one file is written per group, such as D-south.mtx.
    """

    scene: common.SceneFiles
    window: common.WindowFiles
    subdivision: common.SkySubdivision = 4
    effort: common.EffortOptions
    file: common.MatrixFile


@command(
    "trace:coefficients",
    "--scene materials.rad room.rad glazing.rad --sensors desks.pts"
    " --sky-subdivision 4 --samples 4096 -o C.mtx",
)
class DaylightCoefficients:
    """Daylight coefficients: irradiance of sensors per radiance of sky patches [sr]."""

    scene: common.SceneFiles
    sensors: Path = required("Sensor file, x y z dx dy dz per line.", metavar="F")
    subdivision: common.SkySubdivision = 4
    effort: common.EffortOptions
    file: common.MatrixFile


@command(
    "trace:facade",
    "--scene materials.rad room.rad awning.rad --window window.rad --port"
    " ports.rad --relative-error 0.01 -o F.nc",
)
class FacadeMatrix:
    """Façade matrix: radiance of window patches per radiance of port patches.

    Ports enclose an exterior shade in front of the window. With several ports, one file
    is written per port: F-top.nc, or with several windows F-south-top.nc.
    """

    scene: common.SceneFiles
    window: common.WindowFiles
    port: list[Path] = required(
        "Radiance files of ports whose front faces the window.", metavar="F…"
    )
    effort: common.EffortOptions
    file: common.MatrixFile


@command(
    "trace:sun",
    "--scene materials.rad room.rad --window window.rad --bsdf blind.xml"
    " --sensors desks.pts --weather oakland.epw -o C.nc",
)
class SunCoefficients:
    """Direct-sun coefficients: irradiance per direct normal irradiance of each sun.

    The suns of the weather file are at their exact positions. With --view, radiance of
    pixels per direct normal irradiance [1/sr].
    """

    scene: common.SceneFiles
    window: common.WindowFiles
    bsdf: Path = required("BSDF of the windows: .xml, or library:NAME.", metavar="F")
    weather: Path = required("Weather file that gives the sun positions.", metavar="F")
    receiver: common.SensorsOrView
    tolerance: float = option(0.25, "Angle within which suns are merged [°].", least=0)
    peak: bool = option(False, "Extract the direct transmission peak.")
    effort: common.SunEffort
    file: common.MatrixFile
