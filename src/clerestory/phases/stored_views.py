"""View matrices larger than memory, stored in blocks of sensors.

Each file contains the rows of one block of sensors, with the columns of all windows, in
single precision. Only one block at a time is in memory. Each block is stored as soon
as it is traced, so that an interrupted run resumes with the next block. The deviations
of the sixteen batches are pooled into four error components.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Unpack

import numpy as np
from jaxtyping import Float, Float32, Int

from clerestory.engine.controller import estimate_rows, row_blocks
from clerestory.engine.effort import Effort, EffortKeywords
from clerestory.engine.matrix_jobs import ViewJob
from clerestory.matrix.axis import Axis, sensor_axis, unknown_axis, window_axis
from clerestory.matrix.netcdf import read_netcdf
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_store import BlockStore
from clerestory.phases.pooled import FEW, pooled
from clerestory.phases.traced_matrices import (
    matrix_effort,
    require_distinct,
    require_sensors,
    view_job,
    warn_if_short,
)
from clerestory.progress import share_of_progress
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

# Coefficients of a range of rows, and their error components
Entries = tuple[
    Float[np.ndarray, "channel row column"],
    Float[np.ndarray, "component channel row column"] | None,
]


@dataclass(frozen=True, eq=False)
class StoredViews:
    """View matrices in files.

    Attributes
    ----------
    files : paths of the files, one per block of sensors
    blocks : range of sensors in each file
    """

    files: tuple[Path, ...]
    blocks: tuple[slice, ...]
    _last: dict[int, TransferMatrix] = field(default_factory=dict)

    @property
    def sensors(self) -> int:
        """Number of sensors."""
        return int(self.blocks[-1].stop)

    @cached_property
    def channels(self) -> int:
        """Number of channels: one for grey rooms, otherwise one per band.

        Raises
        ------
        InputError : a file is damaged
        """
        return len(self._block(0).values)

    @cached_property
    def components(self) -> int:
        """Number of error components.

        Raises
        ------
        InputError : a file is damaged
        """
        parts = self._block(0).components
        return 0 if parts is None else len(parts)

    def cut(self, most: int) -> list[slice]:
        """Return ranges of at most `most` sensors, each within one file."""
        return [
            slice(first, min(first + most, block.stop))
            for block in self.blocks
            for first in range(block.start, block.stop, most)
        ]

    def read(self, rows: slice, columns: slice) -> Entries:
        """Return a range of rows and columns of one file, and their error components.

        Raises
        ------
        InputError : the file is damaged
        """
        stops = [block.stop for block in self.blocks]
        number = int(np.searchsorted(stops, rows.start, side="right"))
        start = self.blocks[number].start
        own = slice(rows.start - start, rows.stop - start)
        block = self._block(number)
        parts = block.components
        errors = None if parts is None else parts[:, :, own, columns]
        return block.values[:, own, columns], errors

    def of(
        self, sensors: Int[np.ndarray, " row"], columns: slice
    ) -> Float32[np.ndarray, "channel row column"]:
        """Return a range of columns of selected sensors, without error components.

        Parameters
        ----------
        sensors : indices of the sensors, in increasing order
        """
        parts = []
        for number, block in enumerate(self.blocks):
            inside = sensors[(sensors >= block.start) & (sensors < block.stop)]
            if len(inside):
                values = self._block(number).values
                parts.append(values[:, inside - block.start, columns])
        return np.concatenate(parts, axis=1)

    def _block(self, number: int) -> TransferMatrix:
        # Cache of the last block, which is read for each window in turn
        if number not in self._last:
            self._last.clear()
            self._last[number] = read_netcdf(self.files[number])
        return self._last[number]


@dataclass(frozen=True, eq=False)
class StoredColumns:
    """View matrix of one window group in files.

    Attributes
    ----------
    views : matrices of all window groups side by side
    columns : interior patches of this group
    first : index of its first column among the columns of all groups
    """

    views: StoredViews
    columns: Axis
    first: int

    @property
    def rows(self) -> Axis:
        """Axis of the sensors."""
        return sensor_axis(self.views.sensors)

    @property
    def part(self) -> slice:
        """Range of columns of this group among the columns of all groups."""
        return slice(self.first, self.first + self.columns.size)

    def read(self, rows: slice) -> Entries:
        """Return a range of rows of one file, and their error components."""
        return self.views.read(rows, self.part)

    def of(
        self, sensors: Int[np.ndarray, " row"]
    ) -> Float32[np.ndarray, "channel row column"]:
        """Return rows of selected sensors (increasing), without error components."""
        return self.views.of(sensors, self.part)


def stored_columns(
    views: StoredViews, windows: Sequence[Window]
) -> tuple[StoredColumns, ...]:
    """Return the view matrix of each window, in the order of tracing."""
    ends = np.cumsum([len(window.partition) for window in windows]).tolist()
    return tuple(
        StoredColumns(
            views,
            window_axis("interior", window.partition, window.name),
            end - len(window.partition),
        )
        for window, end in zip(windows, ends, strict=True)
    )


def store_views(
    store: BlockStore,
    scene: Scene,
    windows: Sequence[Window],
    *,
    name: str,
    key: str,
    sensors: Sensors,
    **keywords: Unpack[EffortKeywords],
) -> StoredViews:
    """Trace the view matrices of all windows into files; see `view_matrices`.

    Parameters
    ----------
    store : cache of the blocks
    name, key : name of the matrices in the cache, and fingerprint of all their inputs

    Raises
    ------
    InputError : samples and relative_error both given, or a number out of range
    OutputError : a file cannot be written
    """
    require_distinct(windows)
    effort = replace(matrix_effort(store_views, keywords), components=True)
    require_sensors(sensors, effort)
    job = view_job(scene, windows, sensors, effort)
    rows = tuple(row_blocks(job))
    make = _block_maker(job, effort)
    return StoredViews(store.blocks(name, key, rows, make), rows)


def _block_maker(job: ViewJob, effort: Effort) -> Callable[[slice], TransferMatrix]:
    def make(rows: slice) -> TransferMatrix:
        # A dry run records the job and needs no memory
        if not effort.executor.accepts(job, effort.goal):
            return _blank(job, rows)
        first, whole = rows.start, job.receivers
        progress = share_of_progress(
            effort.progress,
            first / whole,
            (rows.stop - first) / whole,
            f"{first:,} of {whole:,} sensors",
        )
        block = estimate_rows(job, rows, replace(effort, progress=progress))
        what = f"view matrices of sensors {rows.start + 1} to {rows.stop}"
        warn_if_short(block, what, effort)
        assert block.components is not None
        few = pooled(block.components, FEW)
        return _matrix(block.values.astype(np.float32), few, job)

    return make


def _blank(job: ViewJob, rows: slice) -> TransferMatrix:
    _, _, columns, channels = job.shape
    shape = channels, rows.stop - rows.start, columns
    nothing = np.float32(0)
    return _matrix(
        np.broadcast_to(nothing, shape),
        np.broadcast_to(nothing, (FEW, *shape)),
        job,
    )


def _matrix(
    values: Float32[np.ndarray, "channel row column"],
    components: Float32[np.ndarray, "component channel row column"],
    job: ViewJob,
) -> TransferMatrix:
    axes = sensor_axis(values.shape[1]), unknown_axis(values.shape[2])
    return TransferMatrix(values, *axes, components, job.scene.bands)
