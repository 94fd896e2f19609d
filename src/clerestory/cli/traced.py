"""What all commands that trace matrices share: receivers, doubts, output."""

import time
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import typer

from clerestory.cli.matrix_files import write_pictures
from clerestory.cli.matrix_output import write_any_matrix
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.matrix.radiance_format import Encoding
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.picture_matrices import Camera
from clerestory.radiance.view_text import view_of
from clerestory.scene.model import Scene
from clerestory.scene.scene_checks import check_scene
from clerestory.scene.sensors import Sensors, read_sensors
from clerestory.scene.window import Window


def receiver_of(
    sensors: Path | None, view: str | None, resolution: int
) -> Camera | Sensors:
    """Return the sensors or the camera that a command was given, one of them.

    Raises
    ------
    InputError : both or none given
    """
    if sensors is not None and view is None:
        return read_sensors(sensors)
    if view is not None and sensors is None:
        looking = view_of(view)
        return Camera(looking, *looking.size_for(resolution))
    raise InputError("either --sensors or --view expected")


def warn_of_doubts(
    scene: Scene,
    windows: Sequence[Window],
    receiver: Camera | Sensors | None = None,
) -> None:
    """Warn of what is likely to be wrong with a scene and its windows."""
    sensors = receiver if isinstance(receiver, Sensors) else None
    for doubt in check_scene(scene, windows, sensors):
        warnings.warn(doubt, ClerestoryWarning, stacklevel=2)


def write_traced(
    kind: str,
    traced: dict[str, TransferMatrix],
    output: Path,
    *,
    encoding: Encoding,
    quiet: bool,
    begin: float,
    receiver: Camera | Sensors | None = None,
) -> None:
    """Write traced matrices, a file each where there are several, and tell of them.

    Parameters
    ----------
    kind : of the matrix: the name of its command
    traced : by what its file is told apart by
    begin : clock at the start of the command [s]
    """
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
    grey = matrix.weighted(matrix.bands.shares)
    if grey.components is None:
        return size
    total = grey.values[0].sum(axis=1)
    error = np.sqrt(np.square(grey.components[:, 0].sum(axis=2)).sum(axis=0))
    lit = total > 0
    if not lit.any():
        return f"{size}; no light arrives"
    relative = float(np.median(error[lit] / total[lit]))
    return f"{size}; standard error of the row sums {relative:.2%} (median)"
