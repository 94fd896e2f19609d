"""View matrices larger than memory: kept block by block of sensors.

A file holds the rows of some sensors, all windows side by side, in single precision.
No more than one block is ever in memory, and each is kept as soon as it is traced, so
that a run that was killed goes on with the next one. Sixteen batches are traced, as
everywhere; their deviations are pooled into four error components.
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

# Coefficients of some rows, and their error components
Entries = tuple[
    Float[np.ndarray, "channel row column"],
    Float[np.ndarray, "component channel row column"] | None,
]


@dataclass(frozen=True, eq=False)
class StoredViews:
    """View matrices in files.

    Attributes
    ----------
    files : of the blocks of sensors
    blocks : numbers of the sensors in each
    """

    files: tuple[Path, ...]
    blocks: tuple[slice, ...]
    _last: dict[int, TransferMatrix] = field(default_factory=dict)

    @property
    def sensors(self) -> int:
        """How many sensors there are."""
        return int(self.blocks[-1].stop)

    @cached_property
    def channels(self) -> int:
        """Number of channels: one where the room is grey, else one per band.

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
        """Return the rows in parts of at most so many sensors, none in two files."""
        return [
            slice(first, min(first + most, block.stop))
            for block in self.blocks
            for first in range(block.start, block.stop, most)
        ]

    def read(self, rows: slice, columns: slice) -> Entries:
        """Return some columns of consecutive rows of one file, and their components.

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
        """Return some columns of some sensors, without their errors.

        Parameters
        ----------
        sensors : their numbers, in growing order
        """
        parts = []
        for number, block in enumerate(self.blocks):
            inside = sensors[(sensors >= block.start) & (sensors < block.stop)]
            if len(inside):
                values = self._block(number).values
                parts.append(values[:, inside - block.start, columns])
        return np.concatenate(parts, axis=1)

    def _block(self, number: int) -> TransferMatrix:
        # The block read last is kept, as all windows ask for it in turn
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
    columns : patches of this group
    first : number of the first of them
    """

    views: StoredViews
    columns: Axis
    first: int

    @property
    def rows(self) -> Axis:
        """The sensors."""
        return sensor_axis(self.views.sensors)

    @property
    def part(self) -> slice:
        """Columns of this group among those of all."""
        return slice(self.first, self.first + self.columns.size)

    def read(self, rows: slice) -> Entries:
        """Return consecutive rows of one file, and their components."""
        return self.views.read(rows, self.part)

    def of(
        self, sensors: Int[np.ndarray, " row"]
    ) -> Float32[np.ndarray, "channel row column"]:
        """Return some sensors, in growing order, without their errors."""
        return self.views.of(sensors, self.part)


def stored_columns(
    views: StoredViews, windows: Sequence[Window]
) -> tuple[StoredColumns, ...]:
    """Return the view matrix of each window, in the order in which they were traced."""
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
    store : where the blocks are kept, and found again
    name, key : of the matrices in the store; the key is a fingerprint of all that
        they depend on

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
        # A plan asks for all rows at once, and takes no memory
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
