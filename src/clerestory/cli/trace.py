"""`clerestory trace`: transfer matrices by tracing."""

import time
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import typer

from clerestory.cli.matrix_files import write_any_matrix
from clerestory.cli.options import (
    Bounces,
    DeviceOption,
    Format,
    Output,
    Quiet,
    RelativeError,
    Samples,
    SceneFiles,
    Seed,
    SensorFile,
    Subdivision,
    WindowFiles,
)
from clerestory.cli.progress import progress_display
from clerestory.constants import LUMINANCE_WEIGHTS
from clerestory.errors import ClerestoryWarning
from clerestory.matrix.radiance_format import Encoding
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.trace import (
    daylight_coefficients,
    daylight_matrices,
    view_matrices,
)
from clerestory.scene.check import check_scene
from clerestory.scene.model import Scene
from clerestory.scene.rad import read_rad
from clerestory.scene.sensors import Sensors, read_sensors
from clerestory.scene.window import Window, read_windows

app = typer.Typer(no_args_is_help=True, help="Trace transfer matrices.")


@app.command(
    epilog="Example: clerestory trace view --scene materials.rad room.rad"
    " --window window.rad --sensors desks.pts --relative-error 0.01 -o V.mtx"
)
def view(
    scene: SceneFiles,
    window: WindowFiles,
    sensors: SensorFile,
    output: Output,
    samples: Samples = None,
    relative_error: RelativeError = None,
    bounces: Bounces = None,
    seed: Seed = 1,
    device: DeviceOption = "auto",
    encoding: Format = "float",
    quiet: Quiet = False,
) -> None:
    """View matrix: irradiance of sensors per radiance of window patches [sr].

    Windows of several groups write one file each: V.mtx becomes V-south.mtx.
    """
    begin = time.perf_counter()
    room, windows, points = (
        read_rad(*scene),
        read_windows(*window),
        read_sensors(sensors),
    )
    _warn_of_doubts(room, windows, points)
    with progress_display(quiet=quiet) as display:
        traced = view_matrices(
            room,
            windows,
            sensors=points,
            samples=samples,
            relative_error=relative_error,
            bounces=bounces,
            seed=seed,
            device=device,
            progress=display("view matrix"),
        )
    _write("view", traced, output, encoding=encoding, quiet=quiet, begin=begin)


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
    encoding: Format = "float",
    quiet: Quiet = False,
) -> None:
    """Daylight matrix: radiance of window patches per radiance of sky patches.

    Windows of several groups write one file each: D.mtx becomes D-south.mtx.
    """
    begin = time.perf_counter()
    room, windows = read_rad(*scene), read_windows(*window)
    _warn_of_doubts(room, windows)
    with progress_display(quiet=quiet) as display:
        traced = daylight_matrices(
            room,
            windows,
            subdivision=subdivision,
            samples=samples,
            relative_error=relative_error,
            bounces=bounces,
            seed=seed,
            device=device,
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
    encoding: Format = "float",
    quiet: Quiet = False,
) -> None:
    """Daylight coefficients: irradiance of sensors per radiance of sky patches [sr]."""
    begin = time.perf_counter()
    room, points = read_rad(*scene), read_sensors(sensors)
    _warn_of_doubts(room, (), points)
    with progress_display(quiet=quiet) as display:
        traced = daylight_coefficients(
            room,
            sensors=points,
            subdivision=subdivision,
            samples=samples,
            relative_error=relative_error,
            bounces=bounces,
            seed=seed,
            device=device,
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


def _warn_of_doubts(
    scene: Scene, windows: Sequence[Window], sensors: Sensors | None = None
) -> None:
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
) -> None:
    for name, matrix in traced.items():
        path = output
        if len(traced) > 1:
            path = output.with_name(f"{output.stem}-{name}{output.suffix}")
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
