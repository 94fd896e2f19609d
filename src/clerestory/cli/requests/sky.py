"""Requests of `clerestory sky`: sky matrices, sun positions, weather files."""

from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import command
from clerestory.cli.requests import common
from clerestory.options import Argument, Option, argument, option, options, required

HELP = "Sky matrices, sun positions and weather files."

WeatherFile = Annotated[
    Path,
    Argument("Weather file (EPW, WEA, TMY2, …) or station file (.toml).", "WEATHER"),
]
Subdivision = Annotated[int, Option("Subdivision of the sky (MF).", least=1, most=6)]
SunSize = Annotated[
    float | None,
    Option(
        "Diameter of the sun [°], in the nearest patch: 0.533 is the real sun, 0 fills"
        " the patch. Default: the sun is spread over four patches.",
        metavar="DEG",
    ),
]
SunFormula = Annotated[
    Literal["spa", "radiance"],
    Option("Formula of the solar position; radiance is that of gensky and gendaymtx."),
]
Rotation = Annotated[
    float,
    Option("Azimuth of +y of the scene, clockwise from north [°].", metavar="DEG"),
]
NoDirect = Annotated[bool, Option("Exclude the direct sun.")]
Moment = Annotated[
    str | None,
    Option(
        "One time, local standard time: the sun at this time, with the irradiance of"
        " the time step that contains it.",
        metavar='"MM-DD HH:MM"',
    ),
]


@options
class Days:
    """First and last day of the selected weather data."""

    first_day: str | None = option(None, "First day.", "--from", metavar="MM-DD")
    last_day: str | None = option(None, "Last day.", "--to", metavar="MM-DD")


@command("sky:matrix", "oslo.epw --subdivision 4 -o S.smx")
class SkyMatrixRequest:
    """Sky matrix: radiance of ground and sky patches at every time step [W/(m²·sr)]."""

    weather: WeatherFile
    file: common.MatrixFile
    subdivision: Subdivision = 4
    sun_only: bool = option(False, "Include only the direct sun.")
    no_direct: NoDirect = False
    sun_size: SunSize = None
    sun_formula: Annotated[
        Literal["spa", "radiance"],
        Option(
            "spa; or radiance, which gives the values of gendaymtx: its solar position,"
            " not corrected in steps with sunrise or sunset; its scaling of the sky by"
            " the cosine at the centre of each patch (0.55 % less at MF 1); and its"
            " dew point of 11 °C instead of that of the file."
        ),
    ] = "spa"
    ground_reflectance: str = option(
        "0.2",
        "Reflectance of the ground, one number or R,G,B.",
        "--ground-reflectance",
        "--ground",
        metavar="X",
    )
    sky_colour: str = option("0.960,1.004,1.118", "Colour of the sky.", metavar="R,G,B")
    solar: bool = option(False, "Use the solar instead of the visible range.")
    rotation: Rotation = 0.0
    days: Days
    time: Moment = None
    daylight_only: bool = option(False, "Omit steps with the sun below the horizon.")
    average: bool = option(False, "Write one column, the mean of all time steps.")
    luminance: bool = option(False, "Write luminance [cd/m²] instead of RGB radiance.")


@command("sky:vector", "overcast --sun 40 180 --diffuse 100 -o S.vec")
class SkyVectorRequest:
    """Sky vector of one instant: radiance of ground and sky patches [W/(m²·sr)].

    For a time step of a weather file, use `sky matrix WEATHER --time`.
    """

    kind: str = argument(
        "uniform, overcast, intermediate, clear, CIE general sky 1..15, or perez.",
        "SKY",
    )
    file: common.MatrixFile
    sun: tuple[float, float] = required(
        "Altitude and azimuth of the sun, clockwise from north [°].", metavar="ALT AZI"
    )
    diffuse: float | None = option(
        None,
        "Diffuse horizontal irradiance, lux/179 [W/m²]; default: as gensky.",
        least=0,
    )
    direct: float | None = option(
        None, "Direct normal visible irradiance [W/m²]; default: as gensky.", least=0
    )
    no_direct: NoDirect = False
    turbidity: float = option(2.45, "Linke turbidity of clear skies.")
    ground_reflectance: float = option(0.2, "Ground reflectance.", least=0, most=1)
    subdivision: Subdivision = 4
    sun_size: SunSize = None


@command("sky:sun", "oslo.epw -o suns.csv")
class SunTable:
    """Write a CSV table of solar altitude and azimuth [°] at every time step.

    With --occurring or --reinhart, write a table of suns: position, number of time
    steps and irradiance of each sun.
    """

    weather: WeatherFile
    output: Path = required("CSV file to write.", "-o")
    occurring: bool = option(False, "Write distinct suns instead of all time steps.")
    tolerance: float = option(
        0.0, "Angle within which --occurring merges suns [°].", metavar="DEG"
    )
    reinhart: int | None = option(
        None,
        "Write suns at the centres of Reinhart patches (6: 5185).",
        least=1,
        most=6,
    )
    sun_formula: SunFormula = "spa"
    rotation: Rotation = 0.0
    days: Days


@command("sky:describe", "oslo.epw")
class WeatherDescription:
    """Describe a weather file: place, time steps, sums, repairs, quality checks."""

    weather: WeatherFile


@command("sky_plot:plot", "oslo.epw -o year.png")
class WeatherPlot:
    """Annual heat map of sun and sky; with --time, the sky in false colour."""

    weather: WeatherFile
    output: common.FigureOutput
    time: Moment = None
    days: Days
