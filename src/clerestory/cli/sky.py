"""`clerestory sky`: sky matrices and sun positions from weather."""

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import typer
from jaxtyping import Float

from clerestory.cli.matrix_files import write_any_matrix
from clerestory.cli.options import Format, Output, Quiet
from clerestory.cli.progress import progress_display
from clerestory.errors import InputError
from clerestory.files import write_text
from clerestory.sky.read import read_weather
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun import SunPosition, sun_position
from clerestory.sky.weather import Weather

app = typer.Typer(no_args_is_help=True, help="Skies and suns of a weather file.")

WeatherFile = Annotated[
    Path, typer.Argument(metavar="WEATHER", help="EPW, WEA or TMY3 file.")
]
# Radiance's sun, the only one with a matrix of its own [°]
_SUN_SIZE_DEG = 0.533


@app.command(epilog="Example: clerestory sky matrix oslo.epw --subdivision 4 -o S.smx")
def matrix(
    weather: WeatherFile,
    output: Output,
    subdivision: Annotated[
        int, typer.Option(help="Reinhart's subdivision.", min=1, max=6, metavar="1..6")
    ] = 4,
    sun_only: Annotated[
        bool, typer.Option("--sun-only", help="The direct sun alone.")
    ] = False,
    no_direct: Annotated[
        bool, typer.Option("--no-direct", help="The sky without the direct sun.")
    ] = False,
    sun_size: Annotated[
        float | None,
        typer.Option(
            "--sun-size",
            help="Sun of this diameter [°] in its nearest patch: 0.533, or 0 for the"
            " whole patch. Spread over the four nearest patches if not given.",
            metavar="DEG",
        ),
    ] = None,
    ground_reflectance: Annotated[
        float, typer.Option(help="Reflectance of the ground.", min=0, max=1)
    ] = 0.2,
    rotation: Annotated[
        float, typer.Option(help="How far the scene's +y points east of north [°].")
    ] = 0.0,
    encoding: Format = "float",
    quiet: Quiet = False,
) -> None:
    """Sky matrix: radiance of ground and sky patches at every time step [W/(m²·sr)]."""
    if sun_only and no_direct:
        raise InputError("both --sun-only and --no-direct; one of them expected")
    include: Literal["all", "sky", "sun"] = "sun" if sun_only else "all"
    include = "sky" if no_direct else include
    with progress_display(quiet=quiet) as display:
        progress = display("sky matrix")
        sky = sky_matrix(
            read_weather(weather),
            subdivision=subdivision,
            include=include,
            sun=_placement(sun_size),
            ground_reflectance=ground_reflectance,
            rotation_deg=rotation,
        )
        progress(0.2, "writing")
        dense, command = sky.to_transfer_matrix(), "clerestory sky matrix"
        write_any_matrix(output, dense, encoding=encoding, command=command)
        progress(1.0, "done")
    if not quiet:
        typer.echo(f"{output}: {sky.rows.describe()} by {sky.columns.describe()}")


@app.command(epilog="Example: clerestory sky sun oslo.epw -o suns.csv")
def sun(weather: WeatherFile, output: Output) -> None:
    """Table of the sun's altitude and azimuth at every time step, as CSV [°]."""
    data = read_weather(weather)
    position = _sun(data)
    lines = ["time,altitude,azimuth clockwise from north,direct normal [W/m²]"]
    rows = zip(
        data.times.astype("datetime64[m]"),
        np.degrees(position.altitude),
        np.degrees(position.azimuth) % 360,
        data.direct_normal,
        strict=True,
    )
    lines += [
        f"{str(t).replace('T', ' ')},{a:.3f},{z:.3f},{d:g}" for t, a, z, d in rows
    ]
    write_text(output, "\n".join(lines) + "\n")


@app.command(epilog="Example: clerestory sky describe oslo.epw")
def describe(weather: WeatherFile) -> None:
    """Say what a weather file holds: place, time steps, sums of sun and sky."""
    data = read_weather(weather)
    level = data.direct_normal * np.sin(np.maximum(_sun(data).altitude, 0))
    first, last = data.times[[0, -1]].astype("datetime64[m]")

    def energy(irradiance: Float[np.ndarray, " time"]) -> str:
        return f"{irradiance.sum() * data.step_minutes / 60_000:.0f} kWh/m²"

    rows = {
        "place": data.place,
        "latitude": f"{data.latitude_deg:.3f}° north",
        "longitude": f"{data.longitude_deg:.3f}° east",
        "elevation": f"{data.elevation:g} m",
        "time zone": f"UTC{data.utc_offset_hours:+g} h",
        "time steps": f"{len(data)} of {data.step_minutes:g} min, {first} to {last}",
        "direct normal": energy(data.direct_normal),
        "direct horizontal": energy(level),
        "diffuse horizontal": energy(data.diffuse_horizontal),
    }
    for name, value in rows.items():
        typer.echo(f"{name:20}{value}")
    for note in data.notes:
        typer.echo(f"{'repaired':20}{note}")


def _placement(size: float | None) -> Literal["spread", "patch", "disc"]:
    if size is None:
        return "spread"
    if size == 0:
        return "patch"
    if abs(size - _SUN_SIZE_DEG) < 1e-6:
        return "disc"
    raise InputError(f"--sun-size {size:g}; 0.533, the sun, or 0, a patch, expected")


def _sun(weather: Weather) -> SunPosition:
    return sun_position(
        weather.times,
        latitude_deg=weather.latitude_deg,
        longitude_deg=weather.longitude_deg,
        utc_offset_hours=weather.utc_offset_hours,
        elevation=weather.elevation,
    )
