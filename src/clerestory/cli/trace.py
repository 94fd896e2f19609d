"""`clerestory trace`: transfer matrices by tracing."""

import time
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from clerestory.cli.matrix_files import write_pictures
from clerestory.cli.matrix_output import write_any_matrix
from clerestory.cli.options import (
    Bounces,
    ClusterAddress,
    DeviceOption,
    Format,
    Output,
    Quiet,
    RelativeError,
    Resolution,
    Samples,
    SceneFiles,
    Seed,
    SensorFile,
    SensorsOrView,
    Subdivision,
    ViewText,
    WindowFiles,
)
from clerestory.cli.progress import progress_display
from clerestory.cluster.cluster import executor_at
from clerestory.constants import LUMINANCE_WEIGHTS
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.gonio.layer import read_layer
from clerestory.matrix.radiance_format import Encoding
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.pictures import (
    Camera,
    picture_sun_coefficients,
    picture_view_matrices,
)
from clerestory.phases.sun import blackened, sun_coefficients
from clerestory.phases.trace import (
    daylight_coefficients,
    daylight_matrices,
    view_matrices,
)
from clerestory.scene.check import check_scene
from clerestory.scene.model import Scene
from clerestory.scene.rad import read_rad
from clerestory.scene.sensors import Sensors, read_sensors
from clerestory.scene.view_text import view_of
from clerestory.scene.window import Window, read_windows
from clerestory.sky.read import read_weather
from clerestory.sky.suns import sun_matrix

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


@app.command(
    epilog="Example: clerestory trace view --scene materials.rad room.rad"
    " --window window.rad --sensors desks.pts --relative-error 0.01 -o V.mtx"
)
def view(
    scene: SceneFiles,
    window: WindowFiles,
    output: Output,
    sensors: SensorsOrView = None,
    camera: ViewText = None,
    resolution: Resolution = 400,
    direct: Direct = False,
    samples: Samples = None,
    relative_error: RelativeError = None,
    bounces: Bounces = None,
    seed: Seed = 1,
    device: DeviceOption = "auto",
    cluster: ClusterAddress = None,
    encoding: Format = "float",
    quiet: Quiet = False,
) -> None:
    """View matrix: irradiance of sensors per radiance of window patches [sr].

    With --view, radiance of pixels per radiance of patches: an output such as
    V_%03d.hdr becomes one picture a patch. Windows of several groups write one file
    each: V.mtx becomes V-south.mtx.
    """
    begin = time.perf_counter()
    room, windows = read_rad(*scene), read_windows(*window)
    receiver = _receiver(sensors, camera, resolution)
    _warn_of_doubts(room, windows, receiver)
    effort = {
        "samples": samples,
        "relative_error": relative_error,
        "bounces": bounces,
        "seed": seed,
        "device": device,
    }
    with executor_at(cluster) as executor, progress_display(quiet=quiet) as display:
        progress = display("view matrix")
        effort["executor"] = executor
        if isinstance(receiver, Camera):
            traced = picture_view_matrices(
                room, windows, receiver, direct=direct, progress=progress, **effort
            )
        else:
            if direct:
                room, effort["bounces"] = blackened(room), 1
            traced = view_matrices(
                room, windows, sensors=receiver, progress=progress, **effort
            )
    _write(
        "view",
        traced,
        output,
        encoding=encoding,
        quiet=quiet,
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
    receiver = _receiver(sensors, camera, resolution)
    _warn_of_doubts(room, windows, receiver)
    suns = sun_matrix(read_weather(weather), tolerance_deg=tolerance).directions
    options = {
        "suns": suns,
        "peak": peak,
        "samples": samples,
        "seed": seed,
        "device": device,
    }
    traced = {}
    with executor_at(cluster) as executor, progress_display(quiet=quiet) as display:
        for each in windows:
            options["progress"] = display(f"direct sun through {each.name}")
            options["executor"] = executor
            common = room, windows, each.name, layer
            if isinstance(receiver, Camera):
                found = picture_sun_coefficients(*common, receiver, **options)
            else:
                found = sun_coefficients(*common, sensors=receiver, **options)
            traced[each.name] = found
    _write(
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
def daylight(
    scene: SceneFiles,
    window: WindowFiles,
    output: Output,
    subdivision: Subdivision = 4,
    samples: Samples = None,
    relative_error: RelativeError = None,
    bounces: Bounces = None,
    seed: Seed = 1,
    device: DeviceOption = "auto",
    cluster: ClusterAddress = None,
    encoding: Format = "float",
    quiet: Quiet = False,
) -> None:
    """Daylight matrix: radiance of window patches per radiance of sky patches.

    Windows of several groups write one file each: D.mtx becomes D-south.mtx.
    """
    begin = time.perf_counter()
    room, windows = read_rad(*scene), read_windows(*window)
    _warn_of_doubts(room, windows)
    with executor_at(cluster) as executor, progress_display(quiet=quiet) as display:
        traced = daylight_matrices(
            room,
            windows,
            subdivision=subdivision,
            samples=samples,
            relative_error=relative_error,
            bounces=bounces,
            seed=seed,
            device=device,
            executor=executor,
            progress=display("daylight matrix"),
        )
    _write("daylight", traced, output, encoding=encoding, quiet=quiet, begin=begin)


@app.command(
    epilog="Example: clerestory trace coefficients --scene materials.rad room.rad"
    " glazing.rad --sensors desks.pts --sky-subdivision 4 --samples 4096 -o C.mtx"
)
def coefficients(
    scene: SceneFiles,
    sensors: SensorFile,
    output: Output,
    subdivision: Subdivision = 4,
    samples: Samples = None,
    relative_error: RelativeError = None,
    bounces: Bounces = None,
    seed: Seed = 1,
    device: DeviceOption = "auto",
    cluster: ClusterAddress = None,
    encoding: Format = "float",
    quiet: Quiet = False,
) -> None:
    """Daylight coefficients: irradiance of sensors per radiance of sky patches [sr]."""
    begin = time.perf_counter()
    room, points = read_rad(*scene), read_sensors(sensors)
    _warn_of_doubts(room, (), points)
    with executor_at(cluster) as executor, progress_display(quiet=quiet) as display:
        traced = daylight_coefficients(
            room,
            sensors=points,
            subdivision=subdivision,
            samples=samples,
            relative_error=relative_error,
            bounces=bounces,
            seed=seed,
            device=device,
            executor=executor,
            progress=display("daylight coefficients"),
        )
    _write(
        "coefficients",
        {"": traced},
        output,
        encoding=encoding,
        quiet=quiet,
        begin=begin,
    )


def _receiver(
    sensors: Path | None, view: str | None, resolution: int
) -> Camera | Sensors:
    if sensors is not None and view is None:
        return read_sensors(sensors)
    if view is not None and sensors is None:
        looking = view_of(view)
        return Camera(looking, *looking.size_for(resolution))
    raise InputError("either --sensors or --view expected")


def _warn_of_doubts(
    scene: Scene,
    windows: Sequence[Window],
    receiver: Camera | Sensors | None = None,
) -> None:
    sensors = receiver if isinstance(receiver, Sensors) else None
    for doubt in check_scene(scene, windows, sensors):
        warnings.warn(doubt, ClerestoryWarning, stacklevel=2)


def _write(
    kind: str,
    traced: dict[str, TransferMatrix],
    output: Path,
    *,
    encoding: Encoding,
    quiet: bool,
    begin: float,
    receiver: Camera | Sensors | None = None,
) -> None:
    for name, matrix in traced.items():
        path = output
        if len(traced) > 1:
            path = output.with_name(f"{output.stem}-{name}{output.suffix}")
        if isinstance(receiver, Camera) and "%" in path.name:
            write_pictures(path, matrix, receiver)
        else:
            write_any_matrix(
                path, matrix, encoding=encoding, command=f"clerestory trace {kind}"
            )
        if not quiet:
            typer.echo(f"{path}: {_summary(matrix)}")
    if not quiet:
        typer.echo(f"done in {time.perf_counter() - begin:.1f} s")


def _summary(matrix: TransferMatrix) -> str:
    # Size, and the error of the row sums: what a uniform source would give
    size = f"{matrix.rows.describe()} by {matrix.columns.describe()}"
    grey = matrix.weighted(LUMINANCE_WEIGHTS)
    if grey.components is None:
        return size
    total = grey.values[0].sum(axis=1)
    error = np.sqrt(np.square(grey.components[:, 0].sum(axis=2)).sum(axis=0))
    lit = total > 0
    if not lit.any():
        return f"{size}; no light arrives"
    relative = float(np.median(error[lit] / total[lit]))
    return f"{size}; standard error of the row sums {relative:.2%} (median)"
