"""`clerestory sky`: sky matrices, suns, descriptions and plots of weather."""

import importlib
from typing import Annotated, Literal

import numpy as np
import typer

from clerestory.cli.matrix_output import write_sky, write_sky_luminance
from clerestory.cli.options import Format, Output, Quiet
from clerestory.cli.progress import progress_display
from clerestory.cli.sky_options import (
    FirstDay,
    Formula,
    Ground,
    LastDay,
    Moment,
    Rotation,
    SkyColour,
    Subdivision,
    SunSize,
    WeatherFile,
    numbers,
    part_of,
    placement_of,
    sky_kind,
)
from clerestory.errors import InputError
from clerestory.files import write_text
from clerestory.sky.gensky import cie_sky
from clerestory.sky.point_sky import perez_moment, sky_vector
from clerestory.sky.sky_conditions import daylight_steps
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import patch_suns, sun_matrix
from clerestory.sky.sun_tables import sun_path_table, suns_table
from clerestory.sky.weather_formats import read_weather
from clerestory.sky.weather_summary import describe_weather

app = typer.Typer(no_args_is_help=True, help="Skies and suns of a weather file.")


@app.command(epilog="Example: clerestory sky matrix oslo.epw --subdivision 4 -o S.smx")
def matrix(
    weather: WeatherFile,
    output: Output,
    subdivision: Subdivision = 4,
    sun_only: Annotated[
        bool, typer.Option("--sun-only", help="The direct sun alone.")
    ] = False,
    no_direct: Annotated[
        bool, typer.Option("--no-direct", help="The sky without the direct sun.")
    ] = False,
    sun_size: SunSize = None,
    sun_formula: Formula = "spa",
    ground_reflectance: Ground = "0.2",
    sky_colour: SkyColour = "0.960,1.004,1.118",
    solar: Annotated[
        bool,
        typer.Option(
            "--solar", help="The whole solar spectrum instead of the visible."
        ),
    ] = False,
    rotation: Rotation = 0.0,
    first_day: FirstDay = None,
    last_day: LastDay = None,
    time: Moment = None,
    daylight_only: Annotated[
        bool, typer.Option("--daylight-only", help="Only steps with the sun up.")
    ] = False,
    average: Annotated[
        bool, typer.Option("--average", help="One column, the mean of all steps.")
    ] = False,
    luminance: Annotated[
        bool,
        typer.Option(
            "--luminance", help="Luminance [cd/m²], one number instead of three."
        ),
    ] = False,
    encoding: Format = "float",
    quiet: Quiet = False,
) -> None:
    """Sky matrix: radiance of ground and sky patches at every time step [W/(m²·sr)]."""
    if luminance and solar:
        raise InputError("both --luminance and --solar; one of them expected")
    if sun_only and no_direct:
        raise InputError("both --sun-only and --no-direct; one of them expected")
    include: Literal["all", "sky", "sun"] = "sun" if sun_only else "all"
    include = "sky" if no_direct else include
    placement, diameter = placement_of(sun_size)
    with progress_display(quiet=quiet) as display:
        progress = display("sky matrix")
        data = part_of(weather, first_day, last_day, time)
        if daylight_only:
            data = daylight_steps(data, sun_formula=sun_formula)
        sky = sky_matrix(
            data,
            subdivision=subdivision,
            include=include,
            sun=placement,
            sun_diameter_deg=diameter,
            ground_reflectance=numbers("--ground-reflectance", ground_reflectance),
            sky_colour=numbers("--sky-colour", sky_colour),
            rotation_deg=rotation,
            sun_formula=sun_formula,
            spectrum="solar" if solar else "visible",
        )
        progress(0.2, "writing")
        sky = sky.mean() if average else sky
        write = write_sky_luminance if luminance else write_sky
        write(output, sky, encoding=encoding, command="clerestory sky matrix")
        progress(1.0, "done")
    if not quiet:
        typer.echo(f"{output}: {sky.rows.describe()} by {sky.columns.describe()}")


@app.command(
    epilog="Example: clerestory sky vector overcast --sun 40 180 --diffuse 100 -o S.vec"
)
def vector(
    kind: Annotated[
        str,
        typer.Argument(
            metavar="SKY",
            help="uniform, overcast, intermediate, clear, a CIE general sky 1..15, or"
            " perez.",
        ),
    ],
    output: Output,
    sun: Annotated[
        tuple[float, float],
        typer.Option(
            help="The sun's altitude, and azimuth clockwise from north [°].",
            metavar="ALT AZI",
        ),
    ],
    diffuse: Annotated[
        float | None,
        typer.Option(
            help="Visible irradiance of the sky on the ground [W/m²], lux over 179;"
            " gensky's if not given.",
            min=0,
        ),
    ] = None,
    direct: Annotated[
        float | None,
        typer.Option(
            help="Visible irradiance facing the sun [W/m²]; gensky's if not given.",
            min=0,
        ),
    ] = None,
    no_direct: Annotated[
        bool, typer.Option("--no-direct", help="The sky without the direct sun.")
    ] = False,
    turbidity: Annotated[float, typer.Option(help="Linke's, of clear skies.")] = 2.45,
    ground_reflectance: Annotated[
        float, typer.Option(help="Reflectance of the ground.", min=0, max=1)
    ] = 0.2,
    subdivision: Subdivision = 4,
    sun_size: SunSize = None,
    encoding: Format = "float",
    quiet: Quiet = False,
) -> None:
    """Sky vector of one moment: radiance of ground and sky patches [W/(m²·sr)].

    That of a moment of the weather: `sky matrix WEATHER --time`.
    """
    altitude, azimuth = (float(angle) for angle in np.radians(sun))
    if kind == "perez":
        if diffuse is None or direct is None:
            raise InputError("sky perez without --diffuse and --direct; both expected")
        sky = perez_moment(
            sun_altitude=altitude,
            sun_azimuth=azimuth,
            diffuse_horizontal=diffuse,
            direct_normal=direct,
            with_sun=not no_direct,
            ground_reflectance=ground_reflectance,
        )
    else:
        sky = cie_sky(
            sky_kind(kind),
            sun_altitude=altitude,
            sun_azimuth=azimuth,
            with_sun=not no_direct,
            turbidity=turbidity,
            diffuse_horizontal=diffuse,
            direct_normal=direct,
            ground_reflectance=ground_reflectance,
        )
    placement, diameter = placement_of(sun_size)
    column = sky_vector(
        sky, subdivision=subdivision, sun=placement, sun_diameter_deg=diameter
    )
    write_sky(output, column, encoding=encoding, command="clerestory sky vector")
    if not quiet:
        typer.echo(f"{output}: {column.rows.describe()}")


@app.command(epilog="Example: clerestory sky sun oslo.epw -o suns.csv")
def sun(
    weather: WeatherFile,
    output: Output,
    occurring: Annotated[
        bool,
        typer.Option("--occurring", help="The suns that shine, instead of all steps."),
    ] = False,
    tolerance: Annotated[
        float,
        typer.Option(
            help="Suns this near to each other are one [°]; with --occurring.",
            metavar="DEG",
        ),
    ] = 0.0,
    reinhart: Annotated[
        int | None,
        typer.Option(
            help="Suns in the middle of sky patches: 5185 for 6.",
            min=1,
            max=6,
            metavar="1..6",
        ),
    ] = None,
    sun_formula: Formula = "spa",
    rotation: Rotation = 0.0,
    first_day: FirstDay = None,
    last_day: LastDay = None,
) -> None:
    """Table of the sun's altitude and azimuth at every time step, as CSV [°].

    With --occurring or --reinhart a table of suns: where each stands, in how many
    steps it shines, and how much.
    """
    if occurring and reinhart is not None:
        raise InputError("both --occurring and --reinhart; one of them expected")
    data = part_of(weather, first_day, last_day, None)
    if occurring or reinhart is not None:
        text = suns_table(
            patch_suns(
                data,
                subdivision=reinhart,
                rotation_deg=rotation,
                sun_formula=sun_formula,
            )
            if reinhart is not None
            else sun_matrix(
                data,
                tolerance_deg=tolerance,
                rotation_deg=rotation,
                sun_formula=sun_formula,
            ),
            step_minutes=data.step_minutes,
        )
    else:
        text = sun_path_table(data, sun_formula=sun_formula, rotation_deg=rotation)
    write_text(output, text)


@app.command(epilog="Example: clerestory sky describe oslo.epw")
def describe(weather: WeatherFile) -> None:
    """Say what a weather file holds: place, steps, sums of light, repairs, doubts."""
    for name, value in describe_weather(read_weather(weather)):
        typer.echo(f"{name:20}{value}")


@app.command(epilog="Example: clerestory sky plot oslo.epw -o year.png")
def plot(
    weather: WeatherFile,
    output: Output,
    time: Moment = None,
    first_day: FirstDay = None,
    last_day: LastDay = None,
) -> None:
    """Heat map of sun and sky over the year; with --time, the dome in false colour."""
    data = part_of(weather, first_day, last_day, time)

    # Matplotlib takes half a second to load, which only plots should wait for
    plots = importlib.import_module("clerestory.report.sky_plots")
    figure = plots.year_figure(data) if time is None else plots.dome_figure(data)
    plots.write_figure(figure, output)
