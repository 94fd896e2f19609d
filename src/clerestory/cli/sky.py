"""`clerestory sky`: sky matrices, sun positions and weather files."""

from pathlib import Path
from typing import Literal

import numpy as np
import typer

from clerestory.cli.matrix_output import write_sky, write_sky_luminance
from clerestory.cli.progress import progress_display
from clerestory.cli.requests import sky as requests
from clerestory.errors import InputError
from clerestory.files import write_text
from clerestory.sky.gensky import CieSky, cie_sky
from clerestory.sky.point_sky import perez_moment, sky_vector
from clerestory.sky.quality_checks import describe_weather, warn_of_clock
from clerestory.sky.sky_conditions import daylight_steps
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.solar_radiance import SUN_DIAMETER_DEG, SunPlacement
from clerestory.sky.sun_matrix import patch_suns, sun_matrix
from clerestory.sky.sun_tables import sun_path_table, suns_table
from clerestory.sky.weather import Weather
from clerestory.sky.weather_formats import read_weather
from clerestory.sky.weather_selection import select_days, select_moment


def matrix(request: requests.SkyMatrixRequest) -> None:
    """Compute the sky matrix of a weather file."""
    _exclude(request, "luminance", "solar")
    _exclude(request, "sun_only", "no_direct")
    include: Literal["all", "sky", "sun"] = "sun" if request.sun_only else "all"
    include = "sky" if request.no_direct else include
    placement, diameter = _placement(request.sun_size)
    ground, colour = request.ground_reflectance, request.sky_colour
    with progress_display(quiet=request.quiet) as display:
        progress = display("sky matrix")
        data = selected_weather(request.weather, request.days, request.time)
        if request.daylight_only:
            data = daylight_steps(data, sun_formula=request.sun_formula)
        sky = sky_matrix(
            data,
            subdivision=request.subdivision,
            include=include,
            sun=placement,
            sun_diameter_deg=diameter,
            ground_reflectance=_numbers("--ground-reflectance", ground),
            sky_colour=_numbers("--sky-colour", colour),
            rotation_deg=request.rotation,
            sun_formula=request.sun_formula,
            spectrum="solar" if request.solar else "visible",
        )
        progress(0.2, "writing")
        sky = sky.mean() if request.average else sky
        write = write_sky_luminance if request.luminance else write_sky
        command = "clerestory sky matrix"
        write(request.output, sky, encoding=request.encoding, command=command)
        progress(1.0, "done")
    if not request.quiet:
        size = f"{sky.rows.describe()} by {sky.columns.describe()}"
        typer.echo(f"{request.output}: {size}")


def vector(request: requests.SkyVectorRequest) -> None:
    """Compute the sky vector of a CIE or Perez sky."""
    altitude, azimuth = (float(angle) for angle in np.radians(request.sun))
    if request.kind == "perez":
        if request.diffuse is None or request.direct is None:
            raise InputError(
                "sky perez without --diffuse or --direct; both options expected"
            )
        sky = perez_moment(
            sun_altitude=altitude,
            sun_azimuth=azimuth,
            diffuse_horizontal=request.diffuse,
            direct_normal=request.direct,
            with_sun=not request.no_direct,
            ground_reflectance=request.ground_reflectance,
        )
    else:
        sky = cie_sky(
            _sky_kind(request.kind),
            sun_altitude=altitude,
            sun_azimuth=azimuth,
            with_sun=not request.no_direct,
            turbidity=request.turbidity,
            diffuse_horizontal=request.diffuse,
            direct_normal=request.direct,
            ground_reflectance=request.ground_reflectance,
        )
    placement, diameter = _placement(request.sun_size)
    column = sky_vector(
        sky, subdivision=request.subdivision, sun=placement, sun_diameter_deg=diameter
    )
    command = "clerestory sky vector"
    write_sky(request.output, column, encoding=request.encoding, command=command)
    if not request.quiet:
        typer.echo(f"{request.output}: {column.rows.describe()}")


def sun(request: requests.SunTable) -> None:
    """Write a table of sun positions."""
    if request.occurring and request.reinhart is not None:
        raise InputError("both --occurring and --reinhart; one of them expected")
    data = selected_weather(request.weather, request.days, None)
    rotation, formula = request.rotation, request.sun_formula
    if request.reinhart is not None:
        suns = patch_suns(
            data,
            subdivision=request.reinhart,
            rotation_deg=rotation,
            sun_formula=formula,
        )
        text = suns_table(suns, step_minutes=data.step_minutes)
    elif request.occurring:
        suns = sun_matrix(
            data,
            tolerance_deg=request.tolerance,
            rotation_deg=rotation,
            sun_formula=formula,
        )
        text = suns_table(suns, step_minutes=data.step_minutes)
    else:
        text = sun_path_table(data, rotation_deg=rotation, sun_formula=formula)
    write_text(request.output, text)


def describe(request: requests.WeatherDescription) -> None:
    """Print a description of a weather file."""
    for name, value in describe_weather(read_weather(request.weather)):
        typer.echo(f"{name:20}{value}")


def _exclude(request: requests.SkyMatrixRequest, *names: str) -> None:
    if all(getattr(request, name) for name in names):
        both = " and ".join(f"--{name.replace('_', '-')}" for name in names)
        raise InputError(f"both {both}; one of them expected")


def _placement(size: float | None) -> tuple[SunPlacement, float]:
    if size is None:
        return "spread", SUN_DIAMETER_DEG
    return ("patch", SUN_DIAMETER_DEG) if size == 0 else ("disc", size)


def selected_weather(file: Path, days: requests.Days, moment: str | None) -> Weather:
    """Return the weather of one time step or several days, with checked time stamps."""
    weather = read_weather(file)
    warn_of_clock(weather)
    first, last = days.first_day, days.last_day
    if moment is not None:
        if first or last:
            raise InputError("both --time and --from or --to; one of them expected")
        return select_moment(weather, moment)
    if first is None and last is None:
        return weather
    return select_days(weather, first=first or "01-01", last=last or "12-31")


def _numbers(option: str, text: str) -> tuple[float, float, float]:
    # A single number applies to all three channels
    try:
        values = [float(word) for word in text.split(",")]
    except ValueError:
        values = []
    if len(values) not in (1, 3):
        raise InputError(f"{option} {text}; one number or R,G,B expected")
    red, green, blue = values * (3 // len(values))
    return red, green, blue


def _sky_kind(word: str) -> CieSky | int:
    return int(word) if word.isdigit() else word  # type: ignore[return-value]
