"""`clerestory render`: a picture at one instant."""

import time
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from clerestory.cli.options import (
    Bounces,
    ClusterAddress,
    DeviceOption,
    Quiet,
    RelativeError,
    RequiredView,
    Resolution,
    Samples,
    SceneFiles,
    Seed,
)
from clerestory.cli.progress import progress_display
from clerestory.cluster.cluster import executor_at
from clerestory.errors import InputError
from clerestory.image.denoise import denoise as denoise_picture
from clerestory.image.picture import photometric, photometric_unit
from clerestory.image.picture_files import write_picture
from clerestory.phases.rendering import Rendering, render_irradiance
from clerestory.phases.rendering import render as render_picture
from clerestory.radiance.generated_sky import sky_at, sky_scene
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.view_text import view_of
from clerestory.scene.model import Scene
from clerestory.sky.weather_formats import read_weather

Sky = Annotated[
    str | None,
    typer.Option(
        "--sky",
        help="Scene file of the sky, or a command: 'gensky 9 21 12 +s …',"
        " 'gendaylit …'.",
        metavar="F",
    ),
]
Time = Annotated[
    str | None,
    typer.Option(
        "--time",
        help="Instead of --sky, with --weather: 2026-09-21T12:00.",
        metavar="T",
    ),
]
WeatherFile = Annotated[
    Path | None,
    typer.Option("--weather", help="Weather file that knows the time.", metavar="F"),
]
PictureOutput = Annotated[
    Path, typer.Option("--output", "-o", help="Picture to write: .hdr or .exr.")
]
ErrorOutput = Annotated[
    Path | None,
    typer.Option("--error", help="Picture of the standard errors to write."),
]
Illuminance = Annotated[
    bool,
    typer.Option(
        "--illuminance", help="Show the illuminance of surfaces, as rpict -i does."
    ),
]
Denoise = Annotated[
    bool,
    typer.Option("--denoise", help="Smooth the noise for the eye; the header says so."),
]


def render(
    scene: SceneFiles,
    view: RequiredView,
    output: PictureOutput,
    sky: Sky = None,
    moment: Time = None,
    weather: WeatherFile = None,
    resolution: Resolution = 512,
    samples: Samples = None,
    relative_error: RelativeError = None,
    bounces: Bounces = None,
    error: ErrorOutput = None,
    illuminance: Illuminance = False,
    denoise: Denoise = False,
    seed: Seed = 1,
    device: DeviceOption = "auto",
    cluster: ClusterAddress = None,
    quiet: Quiet = False,
) -> None:
    """Render a picture of a scene under a sky.

    The scene may hold its sky itself. Without --samples or --relative-error, paths
    are traced until the standard error of the mean pixel is 2 %.
    """
    begin = time.perf_counter()
    room = read_rad(*scene)
    room = room + sky_of(sky, moment, weather)
    camera = view_of(view)
    columns, rows = camera.size_for(resolution)
    with executor_at(cluster) as executor, progress_display(quiet=quiet) as display:
        trace = render_irradiance if illuminance else render_picture
        made = trace(
            room,
            camera,
            columns=columns,
            rows=rows,
            samples=samples,
            relative_error=relative_error,
            bounces=bounces,
            seed=seed,
            device=device,
            executor=executor,
            progress=display("picture"),
        )
    picture = denoise_picture(made.picture) if denoise else made.picture
    write_picture(picture, output)
    if error is not None:
        radiance = made.error.astype(np.float32)
        write_picture(replace(made.picture, radiance=radiance), error)
    if not quiet:
        typer.echo(_summary(made, output, time.perf_counter() - begin))


def sky_of(sky: str | None, moment: str | None, weather: Path | None) -> Scene:
    """Return the sky that options ask for, nothing where they do not."""
    if (moment is None) != (weather is None) or (sky and moment):
        raise InputError("either --sky, or --time with --weather, or neither expected")
    if moment is not None and weather is not None:
        try:
            when = datetime.fromisoformat(moment)
        except ValueError:
            raise InputError(
                f"--time {moment}; a date and time as 2026-09-21T12:00 expected"
            ) from None
        return sky_at(read_weather(weather), when)
    if sky is None:
        return Scene()
    return sky_scene(sky) if " " in sky.strip() else read_rad(sky)


def _summary(made: Rendering, output: Path, seconds: float) -> str:
    picture = made.picture
    mean = float(photometric(picture).mean())
    share = float(np.sqrt(np.mean(made.error**2)) / max(picture.radiance.mean(), 1e-30))
    return (
        f"{output}: {picture.columns} × {picture.rows} pixels, mean {mean:.4g}"
        f" {photometric_unit(picture)},"
        f" standard error of a pixel {share:.1%} of it; {made.paths:,} paths,"
        f" {seconds:.1f} s"
    )
