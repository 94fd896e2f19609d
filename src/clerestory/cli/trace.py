"""`clerestory trace`: transfer matrices by tracing."""

import time
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from clerestory.cli.options import (
    ClusterAddress,
    DeviceOption,
    Format,
    Output,
    Quiet,
    Resolution,
    SceneFiles,
    Seed,
    SensorFile,
    SensorsOrView,
    Subdivision,
    ViewText,
    WindowFiles,
)
from clerestory.cli.progress import progress_display
from clerestory.cli.trace_facade import facade
from clerestory.cli.trace_options import TraceOptions, spelt_out
from clerestory.cli.traced import receiver_of, warn_of_doubts, write_traced
from clerestory.cluster.cluster import executor_at
from clerestory.engine.effort import Effort
from clerestory.gonio.layer_file import read_layer
from clerestory.phases.picture_matrices import (
    Camera,
    picture_sun_coefficients,
    picture_view_matrices,
)
from clerestory.phases.sun_coefficients import blackened, sun_coefficients
from clerestory.phases.traced_matrices import (
    daylight_coefficients,
    daylight_matrices,
    view_matrices,
)
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.window_reader import read_windows
from clerestory.scene.sensors import read_sensors
from clerestory.sky.sun_matrix import sun_matrix
from clerestory.sky.weather_formats import read_weather

Direct = Annotated[
    bool,
    typer.Option("--direct", help="Direct light alone: V_d of the five-phase method."),
]
BsdfFile = Annotated[
    Path, typer.Option("--bsdf", help="BSDF of the windows (.xml).", metavar="F")
]
WeatherOfSuns = Annotated[
    Path, typer.Option("--weather", help="Weather that the suns are of.", metavar="F")
]
Tolerance = Annotated[
    float,
    typer.Option("--tolerance", help="Suns no farther apart share one [°].", min=0),
]
Peak = Annotated[
    bool,
    typer.Option("--peak", help="Keep light that passes straight as sharp as the sun."),
]
SunSamples = Annotated[
    int, typer.Option("--samples", help="Paths per row and sun.", min=1, metavar="N")
]

app = typer.Typer(no_args_is_help=True, help="Trace transfer matrices.")
app.command(
    epilog="Example: clerestory trace facade --scene materials.rad room.rad awning.rad"
    " --window window.rad --port ports.rad --relative-error 0.01 -o F.nc"
)(spelt_out(facade))


@app.command(
    epilog="Example: clerestory trace view --scene materials.rad room.rad"
    " --window window.rad --sensors desks.pts --relative-error 0.01 -o V.mtx"
)
@spelt_out
def view(
    scene: SceneFiles,
    window: WindowFiles,
    output: Output,
    sensors: SensorsOrView = None,
    camera: ViewText = None,
    resolution: Resolution = 400,
    direct: Direct = False,
    *,
    options: TraceOptions,
) -> None:
    """View matrix: irradiance of sensors per radiance of window patches [sr].

    With --view, radiance of pixels per radiance of patches: an output such as
    V_%03d.hdr becomes one picture a patch. Windows of several groups write one file
    each: V.mtx becomes V-south.mtx.
    """
    begin = time.perf_counter()
    room, windows = read_rad(*scene), read_windows(*window)
    receiver = receiver_of(sensors, camera, resolution)
    warn_of_doubts(room, windows, receiver)
    with (
        executor_at(options.cluster) as executor,
        progress_display(quiet=options.quiet) as display,
    ):
        effort = options.effort(executor, display("view matrix"))
        if isinstance(receiver, Camera):
            traced = picture_view_matrices(
                room, windows, receiver, direct=direct, effort=effort
            )
        else:
            if direct:
                room, effort = blackened(room), replace(effort, bounces=1)
            traced = view_matrices(room, windows, sensors=receiver, effort=effort)
    write_traced(
        "view",
        traced,
        output,
        encoding=options.encoding,
        quiet=options.quiet,
        begin=begin,
        receiver=receiver,
    )


@app.command(
    epilog="Example: clerestory trace sun --scene materials.rad room.rad --window"
    " window.rad --bsdf blind.xml --sensors desks.pts --weather oakland.epw -o C.nc"
)
def sun(
    scene: SceneFiles,
    window: WindowFiles,
    bsdf: BsdfFile,
    weather: WeatherOfSuns,
    output: Output,
    sensors: SensorsOrView = None,
    camera: ViewText = None,
    resolution: Resolution = 400,
    tolerance: Tolerance = 0.25,
    peak: Peak = False,
    samples: SunSamples = 64,
    seed: Seed = 1,
    device: DeviceOption = "auto",
    cluster: ClusterAddress = None,
    encoding: Format = "float",
    quiet: Quiet = False,
) -> None:
    """Direct-sun coefficients: irradiance per direct normal irradiance of each sun.

    The suns are those of the weather, at their true places. With --view, radiance of
    pixels per normal irradiance [1/sr].
    """
    begin = time.perf_counter()
    room, windows, layer = read_rad(*scene), read_windows(*window), read_layer(bsdf)
    receiver = receiver_of(sensors, camera, resolution)
    warn_of_doubts(room, windows, receiver)
    suns = sun_matrix(read_weather(weather), tolerance_deg=tolerance).directions
    effort = Effort(samples=samples, seed=seed, device=device)
    traced = {}
    with executor_at(cluster) as executor, progress_display(quiet=quiet) as display:
        for each in windows:
            progress = display(f"direct sun through {each.name}")
            own = replace(effort, executor=executor, progress=progress)
            common = room, windows, each.name, layer
            if isinstance(receiver, Camera):
                traced[each.name] = picture_sun_coefficients(
                    *common, receiver, suns=suns, peak=peak, effort=own
                )
            else:
                traced[each.name] = sun_coefficients(
                    *common, sensors=receiver, suns=suns, peak=peak, effort=own
                )
    write_traced(
        "sun",
        traced,
        output,
        encoding=encoding,
        quiet=quiet,
        begin=begin,
        receiver=receiver,
    )


@app.command(
    epilog="Example: clerestory trace daylight --scene materials.rad room.rad"
    " --window window.rad --sky-subdivision 4 --relative-error 0.01 -o D.mtx"
)
@spelt_out
def daylight(
    scene: SceneFiles,
    window: WindowFiles,
    output: Output,
    subdivision: Subdivision = 4,
    *,
    options: TraceOptions,
) -> None:
    """Daylight matrix: radiance of window patches per radiance of sky patches.

    Windows of several groups write one file each: D.mtx becomes D-south.mtx.
    """
    begin = time.perf_counter()
    room, windows = read_rad(*scene), read_windows(*window)
    warn_of_doubts(room, windows)
    with (
        executor_at(options.cluster) as executor,
        progress_display(quiet=options.quiet) as display,
    ):
        traced = daylight_matrices(
            room,
            windows,
            subdivision=subdivision,
            effort=options.effort(executor, display("daylight matrix")),
        )
    write_traced(
        "daylight",
        traced,
        output,
        encoding=options.encoding,
        quiet=options.quiet,
        begin=begin,
    )


@app.command(
    epilog="Example: clerestory trace coefficients --scene materials.rad room.rad"
    " glazing.rad --sensors desks.pts --sky-subdivision 4 --samples 4096 -o C.mtx"
)
@spelt_out
def coefficients(
    scene: SceneFiles,
    sensors: SensorFile,
    output: Output,
    subdivision: Subdivision = 4,
    *,
    options: TraceOptions,
) -> None:
    """Daylight coefficients: irradiance of sensors per radiance of sky patches [sr]."""
    begin = time.perf_counter()
    room, points = read_rad(*scene), read_sensors(sensors)
    warn_of_doubts(room, (), points)
    with (
        executor_at(options.cluster) as executor,
        progress_display(quiet=options.quiet) as display,
    ):
        traced = daylight_coefficients(
            room,
            sensors=points,
            subdivision=subdivision,
            effort=options.effort(executor, display("daylight coefficients")),
        )
    write_traced(
        "coefficients",
        {"": traced},
        output,
        encoding=options.encoding,
        quiet=options.quiet,
        begin=begin,
    )
