"""Options of `clerestory sky`, and what they mean."""

from pathlib import Path
from typing import Annotated

import typer

from clerestory.errors import InputError
from clerestory.sky.gensky import CieSky
from clerestory.sky.quality_checks import warn_of_clock
from clerestory.sky.solar_position import SunFormula
from clerestory.sky.solar_radiance import SUN_DIAMETER_DEG, SunPlacement
from clerestory.sky.weather import Weather
from clerestory.sky.weather_formats import read_weather
from clerestory.sky.weather_selection import select_days, select_moment

WeatherFile = Annotated[
    Path,
    typer.Argument(
        metavar="WEATHER",
        help="EPW, WEA, TMY2, TMY3 or SURFRAD file, or a station file (.toml).",
    ),
]
Subdivision = Annotated[
    int, typer.Option(help="Reinhart's subdivision.", min=1, max=6, metavar="1..6")
]
SunSize = Annotated[
    float | None,
    typer.Option(
        "--sun-size",
        help="Sun of this diameter [°] in its nearest patch: 0.533 is the sun, 0 the"
        " whole patch. Spread over the four nearest patches if not given.",
        metavar="DEG",
    ),
]
Formula = Annotated[
    SunFormula,
    typer.Option(
        "--sun-formula", help="Where the sun stands; radiance is gendaymtx to the dot."
    ),
]
Rotation = Annotated[
    float,
    typer.Option(
        help="How far the scene's +y points east of north [°].", metavar="DEG"
    ),
]
Ground = Annotated[
    str,
    typer.Option(
        "--ground-reflectance",
        "--ground",
        help="Reflectance of the ground, one number or R,G,B.",
        metavar="X",
    ),
]
SkyColour = Annotated[
    str, typer.Option(help="Factor of each channel of the sky.", metavar="R,G,B")
]
FirstDay = Annotated[
    str | None, typer.Option("--from", help="First day.", metavar="MM-DD")
]
LastDay = Annotated[str | None, typer.Option("--to", help="Last day.", metavar="MM-DD")]
Moment = Annotated[
    str | None,
    typer.Option(
        "--time", help="One moment, local standard time.", metavar='"MM-DD HH:MM"'
    ),
]


def placement_of(
    size: float | None,
) -> tuple[SunPlacement, float]:
    """Return how the sun is put into patches, and its diameter [°]."""
    if size is None:
        return "spread", SUN_DIAMETER_DEG
    return ("patch", SUN_DIAMETER_DEG) if size == 0 else ("disc", size)


def part_of(
    file: Path, first: str | None, last: str | None, moment: str | None
) -> Weather:
    """Return the moment or the days asked for; warn of clocks that are wrong.

    Raises
    ------
    InputError : both were asked for, or the weather has none of them
    """
    weather = read_weather(file)
    warn_of_clock(weather)
    if moment is not None:
        if first or last:
            raise InputError("both --time and --from or --to; one of them expected")
        return select_moment(weather, moment)
    if first is None and last is None:
        return weather
    return select_days(weather, first=first or "01-01", last=last or "12-31")


def numbers(option: str, text: str) -> tuple[float, float, float]:
    """Return three channels; one number stands for all of them.

    Raises
    ------
    InputError : neither one number nor three
    """
    try:
        values = [float(word) for word in text.split(",")]
    except ValueError:
        values = []
    if len(values) not in (1, 3):
        raise InputError(f"{option} {text}; one number or R,G,B expected")
    red, green, blue = values * (3 // len(values))
    return red, green, blue


def sky_kind(word: str) -> CieSky | int:
    """Return the name of a sky, or the number of a general one."""
    return int(word) if word.isdigit() else word  # type: ignore[return-value]
