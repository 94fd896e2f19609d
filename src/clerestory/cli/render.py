"""`clerestory render`: a picture at one instant."""

import time
from dataclasses import replace
from datetime import datetime

import numpy as np

from clerestory.checks import require
from clerestory.cli.effort import tracing
from clerestory.cli.progress import say
from clerestory.cli.requests.common import SkyChoice
from clerestory.cli.requests.render import Render
from clerestory.errors import InputError
from clerestory.image.denoise import denoise
from clerestory.image.picture import photometric, photometric_unit
from clerestory.image.picture_files import write_picture
from clerestory.phases.rendering import Rendering, render_irradiance
from clerestory.phases.rendering import render as render_picture
from clerestory.radiance.generated_sky import sky_at, sky_scene
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.view_text import view_of
from clerestory.scene.model import Scene
from clerestory.sky.weather_formats import read_weather


def render(request: Render) -> None:
    """Render a picture, and optionally its standard errors."""
    begin = time.perf_counter()
    room = read_rad(*request.scene) + sky_of(request.sky)
    view = view_of(request.view)
    columns, rows = view.size_for(request.resolution)
    trace = render_irradiance if request.illuminance else render_picture
    with tracing(request.effort, quiet=request.quiet) as effort:
        made = trace(room, view, columns=columns, rows=rows, effort=effort("picture"))
    write_picture(
        denoise(made.picture) if request.denoise else made.picture, request.output
    )
    if request.error is not None:
        radiance = made.error.astype(np.float32)
        write_picture(replace(made.picture, radiance=radiance), request.error)
    seconds = time.perf_counter() - begin
    say(f"{request.output}: {_summary(made)}, {seconds:.1f} s", quiet=request.quiet)


def sky_of(chosen: SkyChoice) -> Scene:
    """Return the scene of the sky; empty if no sky is chosen."""
    sky, time_text, weather = chosen.sky, chosen.time, chosen.weather
    require(
        (time_text is None) == (weather is None) and not (sky and time_text),
        "--sky, --time and --weather do not match; --sky, or --time with --weather,"
        " or none of them expected",
    )
    if time_text is not None and weather is not None:
        try:
            instant = datetime.fromisoformat(time_text)
        except ValueError:
            raise InputError(
                f"--time is {time_text}; a time such as 2026-09-21T12:00 expected"
            ) from None
        return sky_at(read_weather(weather), instant)
    if sky is None:
        return Scene()
    return sky_scene(sky) if " " in sky.strip() else read_rad(sky)


def _summary(made: Rendering) -> str:
    picture = made.picture
    mean = float(photometric(picture).mean())
    share = float(np.sqrt(np.mean(made.error**2)) / max(picture.radiance.mean(), 1e-30))
    return (
        f"{picture.columns} × {picture.rows} pixels, mean {mean:.4g}"
        f" {photometric_unit(picture)}, standard error of a pixel {share:.1%} of it;"
        f" {made.paths:,} paths"
    )
