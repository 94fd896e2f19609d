"""`clerestory render`: a picture at one instant."""

import time
from collections.abc import Iterator
from dataclasses import replace
from datetime import datetime
from functools import partial

import numpy as np

from clerestory.checks import require
from clerestory.cli.effort import tracing
from clerestory.cli.named_spectra import spectral_bands
from clerestory.cli.progress import say
from clerestory.cli.requests.common import SkyChoice
from clerestory.cli.requests.render import Render
from clerestory.engine.effort import Effort
from clerestory.errors import InputError
from clerestory.glare.dgp_goal import DgpError
from clerestory.image.camera import Camera
from clerestory.image.denoise import denoise
from clerestory.image.picture import photometric, photometric_unit
from clerestory.image.picture_files import write_picture
from clerestory.phases.rendering import (
    Rendering,
    render_irradiance,
    render_progressively,
)
from clerestory.phases.rendering import render as render_picture
from clerestory.radiance.generated_sky import sky_at, sky_scene
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.view_text import view_of
from clerestory.scene.band_conversion import in_bands
from clerestory.scene.model import Scene
from clerestory.sky.weather_formats import read_weather


def render(request: Render) -> None:
    """Render a picture, and optionally its standard errors."""
    begin = time.perf_counter()
    room = _spectral(request, read_rad(*request.scene) + sky_of(request.sky))
    view = view_of(request.view)
    camera = Camera(view, *view.size_for(request.resolution))
    with tracing(request.effort, quiet=request.quiet) as effort:
        for made in _pictures(request, room, camera, effort("picture")):
            _write(request, made)
            seconds = time.perf_counter() - begin
            line = f"{request.output}: {_summary(made)}, {seconds:.1f} s"
            say(line, quiet=request.quiet)


def _spectral(request: Render, room: Scene) -> Scene:
    # The scene in the spectral bands of the request, if any
    chosen = spectral_bands(request.spectral, request.spectrum)
    return room if chosen is None else in_bands(room, chosen[0], spectra=chosen[1])


def _pictures(
    request: Render, room: Scene, camera: Camera, effort: Effort
) -> Iterator[Rendering]:
    # The picture, or with --preview the picture after each round
    view, columns, rows = camera.view, camera.columns, camera.rows
    if request.illuminance:
        require(
            request.dgp_error is None and not request.preview,
            "--illuminance with --dgp-error or --preview; one of them expected",
        )
        trace = partial(render_irradiance, effort=effort)
        yield trace(room, view, columns=columns, rows=rows)
        return
    goal = None if request.dgp_error is None else DgpError(request.dgp_error)
    if request.preview:
        trace_rounds = partial(render_progressively, goal=goal, effort=effort)
        yield from trace_rounds(room, view, columns=columns, rows=rows)
    else:
        trace = partial(render_picture, goal=goal, effort=effort)
        yield trace(room, view, columns=columns, rows=rows)


def _write(request: Render, made: Rendering) -> None:
    shown = denoise(made.picture) if request.denoise else made.picture
    write_picture(shown, request.output)
    if request.error is not None:
        radiance = made.error.astype(np.float32)
        write_picture(replace(made.picture, radiance=radiance), request.error)


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
