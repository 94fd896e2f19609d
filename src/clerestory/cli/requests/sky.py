"""Requests of `clerestory sky`: sky matrices, sun positions, weather files."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import Command
from clerestory.cli.requests import common
from clerestory.options import Argument, Option, argument, option, required

WeatherFile = Annotated[
    Path,
    Argument(
        "EPW, WEA, TMY2, TMY3 or SURFRAD file, or a station file (.toml).", "WEATHER"
    ),
]
Subdivision = Annotated[
    int,
    Option("Subdivision of the Reinhart sky (MF).", metavar="1..6", least=1, most=6),
]
SunSize = Annotated[
    float | None,
    Option(
        "Put the sun, of this diameter [°], into its nearest patch: 0.533 is the real"
        " sun, 0 the whole patch. Spread over the four nearest patches if not given.",
        metavar="DEG",
    ),
]
SunFormula = Annotated[
    Literal["spa", "radiance"],
    Option("Formula of the sun position; radiance reproduces gendaymtx exactly."),
]
Rotation = Annotated[
    float, Option("Angle of the scene's +y east of north [°].", metavar="DEG")
]
NoDirect = Annotated[bool, Option("The sky without the direct sun.")]
Moment = Annotated[
    str | None,
    Option("One time step, local standard time.", metavar='"MM-DD HH:MM"'),
]


@dataclass(frozen=True, kw_only=True)
class Days:
    """First and last day of a part of the weather."""

    first_day: str | None = option(None, "First day.", "--from", metavar="MM-DD")
    last_day: str | None = option(None, "Last day.", "--to", metavar="MM-DD")


@dataclass(frozen=True, kw_only=True)
class SkyMatrixRequest:
    """Sky matrix: radiance of ground and sky patches at every time step [W/(m²·sr)]."""

    weather: WeatherFile
    output: common.MatrixOutput
    subdivision: Subdivision = 4
    sun_only: bool = option(False, "The direct sun only.")
    no_direct: NoDirect = False
    sun_size: SunSize = None
    sun_formula: SunFormula = "spa"
    ground_reflectance: str = option(
        "0.2",
        "Reflectance of the ground, one number or R,G,B.",
        "--ground-reflectance",
        "--ground",
        metavar="X",
    )
    sky_colour: str = option(
        "0.960,1.004,1.118", "Factor of each channel of the sky.", metavar="R,G,B"
    )
    solar: bool = option(False, "The whole solar spectrum instead of the visible.")
    rotation: Rotation = 0.0
    days: Days
    time: Moment = None
    daylight_only: bool = option(False, "Only time steps with the sun up.")
    average: bool = option(False, "One column, the mean of all time steps.")
    luminance: bool = option(False, "Luminance [cd/m²], one number instead of three.")
    encoding: common.MatrixEncoding = "float"
    quiet: common.Quiet = False


@dataclass(frozen=True, kw_only=True)
class SkyVectorRequest:
    """Sky vector of one instant: radiance of ground and sky patches [W/(m²·sr)].

    For an instant of a weather file: `sky matrix WEATHER --time`.
    """

    kind: str = argument(
        "uniform, overcast, intermediate, clear, a CIE general sky 1..15, or perez.",
        "SKY",
    )
    output: common.MatrixOutput
    sun: tuple[float, float] = required(
        "Altitude of the sun, and its azimuth clockwise from north [°].",
        metavar="ALT AZI",
    )
    diffuse: float | None = option(
        None,
        "Diffuse horizontal visible irradiance [W/m²], lux over 179; gensky's if"
        " not given.",
        least=0,
    )
    direct: float | None = option(
        None, "Direct normal visible irradiance [W/m²]; gensky's if not given.", least=0
    )
    no_direct: NoDirect = False
    turbidity: float = option(2.45, "Linke turbidity of clear skies.")
    ground_reflectance: float = option(
        0.2, "Reflectance of the ground.", least=0, most=1
    )
    subdivision: Subdivision = 4
    sun_size: SunSize = None
    encoding: common.MatrixEncoding = "float"
    quiet: common.Quiet = False


@dataclass(frozen=True, kw_only=True)
class SunTable:
    """Table of the sun's altitude and azimuth at every time step, as CSV [°].

    With --occurring or --reinhart a table of suns: the position of each, the number of
    time steps in which it shines, and its irradiance.
    """

    weather: WeatherFile
    output: common.MatrixOutput
    occurring: bool = option(
        False, "The distinct sun positions, instead of all time steps."
    )
    tolerance: float = option(
        0.0,
        "Suns no farther apart than this are one sun [°]; with --occurring.",
        metavar="DEG",
    )
    reinhart: int | None = option(
        None,
        "Suns at the centres of Reinhart sky patches: 5185 for 6.",
        metavar="1..6",
        least=1,
        most=6,
    )
    sun_formula: SunFormula = "spa"
    rotation: Rotation = 0.0
    days: Days


@dataclass(frozen=True, kw_only=True)
class WeatherDescription:
    """Describe a weather file: place, time steps, sums, repairs, quality checks."""

    weather: WeatherFile


@dataclass(frozen=True, kw_only=True)
class WeatherPlot:
    """Heat map of sun and sky over the year; with --time, the sky in false colour."""

    weather: WeatherFile
    output: common.MatrixOutput
    time: Moment = None
    days: Days


HELP = "Sky matrices, sun positions and weather files."
COMMANDS = {
    "matrix": Command(
        SkyMatrixRequest, "sky:matrix", "oslo.epw --subdivision 4 -o S.smx"
    ),
    "vector": Command(
        SkyVectorRequest, "sky:vector", "overcast --sun 40 180 --diffuse 100 -o S.vec"
    ),
    "sun": Command(SunTable, "sky:sun", "oslo.epw -o suns.csv"),
    "describe": Command(WeatherDescription, "sky:describe", "oslo.epw"),
    "plot": Command(WeatherPlot, "sky_plot:plot", "oslo.epw -o year.png"),
}
