"""`clerestory sky`: sky matrices, sun positions and weather files."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Literal, cast

import numpy as np

from clerestory.checks import require
from clerestory.cli.matrix_output import write_sky
from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests import sky as requests
from clerestory.errors import InputError
from clerestory.files import write_text
from clerestory.sky.gensky import CieSky, cie_sky
from clerestory.sky.point_sky import PointSky, perez_moment, sky_vector
from clerestory.sky.quality_checks import describe_weather, warn_of_clock
from clerestory.sky.sky_conditions import daylight_steps
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.solar_radiance import SUN_DIAMETER_DEG, SunPlacement
from clerestory.sky.sun_matrix import SunMatrix, patch_suns, sun_matrix
from clerestory.sky.sun_tables import sun_path_table, suns_table
from clerestory.sky.weather import Weather
from clerestory.sky.weather_formats import read_weather
from clerestory.sky.weather_selection import select_days, select_moment


def matrix(request: requests.SkyMatrixRequest) -> None:
    """Compute the sky matrix of a weather file."""
    _exclude(luminance=request.luminance, solar=request.solar)
    _exclude(sun_only=request.sun_only, no_direct=request.no_direct)
    include: Literal["all", "sky", "sun"] = "sun" if request.sun_only else "all"
    include = "sky" if request.no_direct else include
    placement, diameter = _placement(request.sun_size)
    ground, colour = request.ground_reflectance, request.sky_colour
    with progress_display(quiet=request.file.quiet) as display:
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
        write_sky(request.file, sky, luminance=request.luminance)
        progress(1.0, "done")
    size = f"{sky.rows.describe()} by {sky.columns.describe()}"
    if request.time is not None:
        size += f", the sun at {request.time}, {data.notes[-1]}"
    say(f"{request.file.output}: {size}", quiet=request.file.quiet)


def vector(request: requests.SkyVectorRequest) -> None:
    """Compute the sky vector of a CIE or Perez sky."""
    altitude, azimuth = (float(angle) for angle in np.radians(request.sun))
    if request.kind == "perez":
        if request.diffuse is None or request.direct is None:
            raise InputError(
                "the sky is perez, but --diffuse or --direct is missing; both expected"
            )
        make: Callable[..., PointSky] = perez_moment
    else:
        word = request.kind
        kind = int(word) if word.isdigit() else cast(CieSky, word)
        make = partial(cie_sky, kind, turbidity=request.turbidity)
    sky = make(
        sun_altitude=altitude,
        sun_azimuth=azimuth,
        diffuse_horizontal=request.diffuse,
        direct_normal=request.direct,
        with_sun=not request.no_direct,
        ground_reflectance=request.ground_reflectance,
    )
    placement, diameter = _placement(request.sun_size)
    column = sky_vector(
        sky, subdivision=request.subdivision, sun=placement, sun_diameter_deg=diameter
    )
    file = request.file
    write_sky(file, column)
    say(f"{file.output}: {column.rows.describe()}", quiet=file.quiet)


def sun(request: requests.SunTable) -> None:
    """Write a table of sun positions."""
    _exclude(occurring=request.occurring, reinhart=request.reinhart)
    data = selected_weather(request.weather, request.days, None)
    make: Callable[..., SunMatrix | str] = sun_path_table
    if request.reinhart is not None:
        make = partial(patch_suns, subdivision=request.reinhart)
    elif request.occurring:
        make = partial(sun_matrix, tolerance_deg=request.tolerance)
    made = make(data, rotation_deg=request.rotation, sun_formula=request.sun_formula)
    if isinstance(made, SunMatrix):
        made = suns_table(made, step_minutes=data.step_minutes)
    write_text(request.output, made)


def describe(request: requests.WeatherDescription) -> None:
    """Print a description of a weather file."""
    found = describe_weather(read_weather(request.weather))
    say(*(f"{name:20}{value}" for name, value in found))


def _exclude(**options: object) -> None:
    both = " and ".join(f"--{name.replace('_', '-')}" for name in options)
    require(not all(options.values()), f"both {both} are given; one of them expected")


def _placement(size: float | None) -> tuple[SunPlacement, float]:
    if size is None:
        return "spread", SUN_DIAMETER_DEG
    return ("patch", SUN_DIAMETER_DEG) if size == 0 else ("disc", size)


def selected_weather(file: Path, days: requests.Days, moment: str | None) -> Weather:
    """Return the weather of one time step or of several days; warn of clock errors."""
    weather = read_weather(file)
    warn_of_clock(weather)
    first, last = days.first_day, days.last_day
    if moment is not None:
        require(
            not (first or last),
            "--time is given with --from or --to; one time step or days expected",
        )
        return select_moment(weather, moment)
    if first is None and last is None:
        return weather
    return select_days(weather, first=first or "01-01", last=last or "12-31")


def _numbers(option: str, text: str) -> tuple[float, float, float]:
    # Values of three channels, from one number for all or from R,G,B
    try:
        values = [float(word) for word in text.split(",")]
    except ValueError:
        values = []
    require(len(values) in (1, 3), f"{option} is {text}; one number or R,G,B expected")
    red, green, blue = values * (3 // len(values))
    return red, green, blue
