"""`clerestory trace`: transfer matrices by ray tracing."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from clerestory.cli.effort import tracing
from clerestory.cli.matrix_output import write_any_matrix
from clerestory.cli.progress import say
from clerestory.cli.requests import common
from clerestory.cli.requests import trace as requests
from clerestory.engine.effort import Effort
from clerestory.errors import InputError
from clerestory.escaping import file_stems
from clerestory.image.camera import Camera
from clerestory.image.picture_files import write_picture
from clerestory.image.picture_sets import numbered
from clerestory.library.bsdf_source import read_bsdf
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases import traced_matrices
from clerestory.phases.direct_light import blackened
from clerestory.phases.facade_matrices import facade_matrices
from clerestory.phases.picture_matrices import picture_view_matrices
from clerestory.phases.sun_coefficients import (
    picture_sun_coefficients,
    sun_coefficients,
)
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.view_text import view_of
from clerestory.radiance.window_reader import read_windows
from clerestory.scene.scene_checks import warn_of_scene
from clerestory.scene.sensors import Sensors, read_sensors
from clerestory.sky.sun_matrix import sun_matrix
from clerestory.sky.weather_formats import read_weather


def view(request: requests.ViewMatrix) -> None:
    """Trace view matrices."""
    room, windows = read_rad(*request.scene), read_windows(*request.window)
    receiver = _receiver(request.receiver)
    warn_of_scene(room, windows, _sensors(receiver))
    with _run(request.file, request.effort) as run:
        effort = run.effort("view matrix")
        if isinstance(receiver, Camera):
            traced = picture_view_matrices(
                room, windows, receiver, direct=request.direct, effort=effort
            )
        else:
            if request.direct:
                room, effort = blackened(room), replace(effort, bounces=1)
            traced = traced_matrices.view_matrices(
                room, windows, sensors=receiver, effort=effort
            )
        run.write(traced, receiver)


def daylight(request: requests.DaylightMatrix) -> None:
    """Trace daylight matrices."""
    room, windows = read_rad(*request.scene), read_windows(*request.window)
    warn_of_scene(room, windows)
    with _run(request.file, request.effort) as run:
        effort = run.effort("daylight matrix")
        run.write(
            traced_matrices.daylight_matrices(
                room, windows, subdivision=request.subdivision, effort=effort
            )
        )


def coefficients(request: requests.DaylightCoefficients) -> None:
    """Trace daylight coefficients."""
    room, points = read_rad(*request.scene), read_sensors(request.sensors)
    warn_of_scene(room, (), points)
    with _run(request.file, request.effort) as run:
        effort = run.effort("daylight coefficients")
        found = traced_matrices.daylight_coefficients(
            room, sensors=points, subdivision=request.subdivision, effort=effort
        )
        run.write({"": found})


def facade(request: requests.FacadeMatrix) -> None:
    """Trace façade matrices of shades at a distance from their window."""
    room, windows = read_rad(*request.scene), read_windows(*request.window)
    ports = read_windows(*request.port)
    warn_of_scene(room, windows)
    traced: dict[str, TransferMatrix] = {}
    with _run(request.file, request.effort) as run:
        for number, each in enumerate(windows):
            effort = run.effort(f"façade matrix of {each.name}")
            effort = replace(effort, seed=effort.seed + number)
            found = facade_matrices(room, each, ports, effort=effort)
            prefix = f"{each.name}-" if len(windows) > 1 else ""
            traced |= {prefix + name: matrix for name, matrix in found.items()}
        run.write(traced)


def sun(request: requests.SunCoefficients) -> None:
    """Trace direct-sun coefficients."""
    room, windows = read_rad(*request.scene), read_windows(*request.window)
    layer, receiver = read_bsdf(request.bsdf), _receiver(request.receiver)
    warn_of_scene(room, windows, _sensors(receiver))
    weather = read_weather(request.weather)
    suns = sun_matrix(weather, tolerance_deg=request.tolerance).directions
    traced = {}
    with _run(request.file, request.effort) as run:
        for each in windows:
            effort = run.effort(f"direct sun through {each.name}")
            common = room, windows, each.name, layer
            trace = (
                partial(picture_sun_coefficients, *common, receiver)
                if isinstance(receiver, Camera)
                else partial(sun_coefficients, *common, sensors=receiver)
            )
            traced[each.name] = trace(suns=suns, peak=request.peak, effort=effort)
        run.write(traced, receiver)


@dataclass(frozen=True)
class _Run:
    # Output file, and a function from matrix title to sampling effort
    file: common.MatrixFile
    effort: Callable[[str], Effort]
    begin: float

    def write(
        self,
        traced: dict[str, TransferMatrix],
        receiver: Camera | Sensors | None = None,
    ) -> None:
        """Write each matrix to a file, and print a summary."""
        output = self.file.output
        stems = file_stems(traced)
        for name, matrix in traced.items():
            stem = f"{output.stem}-{stems[name]}" if len(traced) > 1 else output.stem
            path = output.with_stem(stem)
            if isinstance(receiver, Camera) and "%" in path.name:
                _write_pictures(path, matrix, receiver)
            else:
                write_any_matrix(replace(self.file, output=path), matrix)
            say(f"{path}: {_summary(matrix)}", quiet=self.file.quiet)
        say(f"done in {time.perf_counter() - self.begin:.1f} s", quiet=self.file.quiet)


@contextmanager
def _run(
    file: common.MatrixFile, options: common.EffortOptions | common.SunEffort
) -> Iterator[_Run]:
    begin = time.perf_counter()
    with tracing(options, quiet=file.quiet) as effort:
        yield _Run(file, effort, begin)


def _receiver(chosen: common.SensorsOrView) -> Camera | Sensors:
    if chosen.sensors is not None and chosen.view is None:
        return read_sensors(chosen.sensors)
    if chosen.view is not None and chosen.sensors is None:
        view = view_of(chosen.view)
        return Camera(view, *view.size_for(chosen.resolution))
    raise InputError("either --sensors or --view expected")


def _sensors(receiver: Camera | Sensors) -> Sensors | None:
    return receiver if isinstance(receiver, Sensors) else None


def _write_pictures(path: Path, matrix: TransferMatrix, camera: Camera) -> None:
    # One picture per matrix column, which is a window patch or a sun
    for column in range(matrix.columns.size):
        picture = camera.picture(matrix.values[:, :, column])
        write_picture(picture, numbered(path, column))


def _summary(matrix: TransferMatrix) -> str:
    # Matrix size, and standard error of the row sums (response to a uniform source)
    size = f"{matrix.rows.describe()} by {matrix.columns.describe()}"
    luminance = matrix.weighted(matrix.bands.shares)
    if luminance.components is None:
        return size
    total = luminance.values[0].sum(axis=1)
    error = np.sqrt(np.square(luminance.components[:, 0].sum(axis=2)).sum(axis=0))
    lit = total > 0
    if not lit.any():
        return f"{size}; all values are zero"
    relative = float(np.median(error[lit] / total[lit]))
    return f"{size}; standard error of the row sums {relative:.2%} (median)"
