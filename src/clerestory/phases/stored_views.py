"""View matrices larger than memory: traced block by block into a file.

The file is HDF5 with `values` (channel, sensor, column) and `components` (component,
channel, sensor, column), single precision, in chunks of some sensors with all columns.
Columns are the patches of all windows, window by window. Sensors come and go in blocks;
no more than one block of them is ever in memory.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from jaxtyping import Float32

from clerestory.engine.device import Device
from clerestory.engine.estimate import Estimate
from clerestory.engine.traces import trace_view_blocks
from clerestory.engine.work import Executor
from clerestory.errors import InputError
from clerestory.files import replace_file
from clerestory.phases.trace import (
    Progress,
    matrix_effort,
    require_distinct,
    warn_if_short,
)
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

# Independent estimates of a coefficient: fewer than elsewhere, for memory and disk
BATCHES = 4

# Sensors of a chunk
_CHUNK = 64

_FORMAT = "Clerestory view matrices 1"


@dataclass(frozen=True, eq=False)
class ViewBlock:
    """View matrices of some consecutive sensors, of all windows side by side."""

    rows: slice
    values: Float32[np.ndarray, "channel row column"]
    components: Float32[np.ndarray, "component channel row column"]


@dataclass(frozen=True)
class StoredViews:
    """View matrices in a file.

    Attributes
    ----------
    path : of the file
    channels, sensors, columns : shape of the matrices of all windows side by side

    Raises
    ------
    InputError : not such a file
    """

    path: Path
    channels: int
    sensors: int
    columns: int

    @classmethod
    def read(cls, path: str | Path) -> "StoredViews":
        """Return the view matrices in a file that `store_views` wrote."""
        try:
            with h5py.File(path, "r") as file:
                if file.attrs.get("format") != _FORMAT:
                    raise InputError(f"a file of the format {_FORMAT!r}", file=path)
                return cls(Path(path), *file["values"].shape)
        except (OSError, KeyError, TypeError) as error:
            raise InputError(
                "damaged or missing; view matrices expected", file=path
            ) from error

    def blocks(self, size: int) -> Iterator[ViewBlock]:
        """Yield blocks of at most so many sensors, in order."""
        with h5py.File(self.path, "r") as file:
            values, components = file["values"], file["components"]
            for first in range(0, self.sensors, size):
                rows = slice(first, min(first + size, self.sensors))
                yield ViewBlock(rows, values[:, rows], components[:, :, rows])


def store_views(
    path: str | Path,
    scene: Scene,
    windows: Sequence[Window],
    *,
    sensors: Sensors,
    samples: int | None = None,
    relative_error: float | None = None,
    bounces: int | None = None,
    seed: int = 0,
    device: Device = "auto",
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> StoredViews:
    """Trace the view matrices of all windows into a file; see `view_matrices`.

    The file appears whole or not at all.

    Raises
    ------
    InputError : samples and relative_error both given, or a number out of range
    OutputError : the file cannot be written
    """
    require_distinct(windows)
    effort = matrix_effort(
        samples=samples,
        relative_error=relative_error,
        bounces=bounces,
        seed=seed,
        device=device,
        executor=executor,
        progress=progress,
        batches=BATCHES,
    )
    columns = sum(len(window.partition) for window in windows)
    blocks = trace_view_blocks(scene, tuple(windows), sensors, effort)
    with replace_file(path) as stream, h5py.File(stream, "w") as file:
        file.attrs["format"] = _FORMAT
        _write(file, blocks, (len(sensors), columns), relative_error)
    return StoredViews.read(path)


def _write(
    file: h5py.File,
    blocks: Iterator[Estimate],
    shape: tuple[int, int],
    relative_error: float | None,
) -> None:
    sensors, columns = shape
    values = components = None
    first = 0
    for block in blocks:
        channels, rows, _ = block.values.shape
        if values is None or components is None:
            whole = (channels, sensors, columns)
            chunk = (channels, min(_CHUNK, sensors), columns)
            values = file.create_dataset("values", whole, "f4", chunks=chunk)
            components = file.create_dataset(
                "components", (BATCHES, *whole), "f4", chunks=(1, *chunk)
            )
        place = slice(first, first + rows)
        values[:, place] = block.values
        components[:, :, place] = block.components
        first = place.stop
        warn_if_short(block, f"view matrices up to sensor {first}", relative_error)
