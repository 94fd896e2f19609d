"""Matrices of sensors larger than memory, stored in blocks of sensors.

Each file contains the rows of one block of sensors, with the columns of all windows or
of all sky patches, in single precision. Only one block at a time is in memory. Each
block is stored as soon as it is traced, so that an interrupted run resumes with the
next block.

The sixteen batches of paths are merged into four, which give four error components. The
expected variance is unchanged. Fewer error components need less memory and time, but
the estimated standard error is less precise.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Unpack

import numpy as np
from jaxtyping import Float, Float32, Int

from clerestory.bands import Bands
from clerestory.brief_repr import brief
from clerestory.engine.controller import EstimatedJob, estimate_rows, row_blocks
from clerestory.engine.effort import Effort, EffortKeywords
from clerestory.matrix.axis import Axis, sensor_axis, unknown_axis
from clerestory.matrix.netcdf import read_netcdf
from clerestory.matrix.transfer_matrix import Entries, TransferMatrix, require_matrix
from clerestory.phases.matrix_store import BlockMaker
from clerestory.phases.traced_matrices import (
    matrix_effort,
    patch_axes,
    view_job,
    warn_if_short,
)
from clerestory.progress import share_of_progress
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

# Number of error components after batches are merged
FEW = 4


@dataclass(frozen=True, eq=False)
class StoredViews:
    """Matrices in files, one for each block of sensors."""

    files: tuple[Path, ...]
    blocks: tuple[slice, ...]
    _last: dict[int, TransferMatrix] = field(default_factory=dict)

    @cached_property
    def counts(self) -> tuple[int, int]:
        """Numbers of channels and of error components."""
        values, parts = self._block(0).read(slice(0, 1))
        return len(values), 0 if parts is None else len(parts)

    @property
    def bands(self) -> Bands:
        """Spectral bands of the channels."""
        return self._block(0).bands

    def cut(self, most: int) -> list[slice]:
        """Return ranges of at most `most` sensors, each within one file."""
        return [
            slice(first, min(first + most, block.stop))
            for block in self.blocks
            for first in range(block.start, block.stop, most)
        ]

    def read(self, rows: slice, columns: slice) -> Entries:
        """Return some rows and columns of one file, and their error components."""
        stops = [block.stop for block in self.blocks]
        number = int(np.searchsorted(stops, rows.start, side="right"))
        start = self.blocks[number].start
        own = slice(rows.start - start, rows.stop - start)
        values, parts = self._block(number).read(own)
        return values[..., columns], None if parts is None else parts[..., columns]

    def of(
        self, sensors: Int[np.ndarray, " row"], columns: slice
    ) -> Float32[np.ndarray, "channel row column"]:
        """Return a range of columns for selected sensors, without error components.

        `sensors` are indices in increasing order.
        """
        parts = []
        for number, block in enumerate(self.blocks):
            inside = sensors[(sensors >= block.start) & (sensors < block.stop)]
            if len(inside):
                values = self._block(number).values
                parts.append(values[:, inside - block.start, columns])
        return np.concatenate(parts, axis=1)

    def _block(self, number: int) -> TransferMatrix:
        # Keep the last block in memory, as it is read once for each window. Threads may
        # read different blocks
        found = self._last.get(number)
        if found is None:
            found = read_netcdf(self.files[number])
            self._last.clear()
            self._last[number] = found
        return found


@dataclass(frozen=True, eq=False)
class StoredColumns:
    """Matrix of one window group or sky: columns of `views` from index `first` on."""

    views: StoredViews
    columns: Axis
    first: int

    __repr__ = brief

    @property
    def rows(self) -> Axis:
        """Axis of the sensors."""
        return sensor_axis(self.views.blocks[-1].stop)

    @property
    def part(self) -> slice:
        """Columns of this matrix among all columns in the files."""
        return slice(self.first, self.first + self.columns.size)

    def read(self, rows: slice) -> Entries:
        """Return a range of rows of one file, and their error components."""
        return self.views.read(rows, self.part)


def stored_columns(
    views: StoredViews, windows: Sequence[Window]
) -> tuple[StoredColumns, ...]:
    """Return the view matrix of each window, in the order of tracing."""
    axes = list(patch_axes(windows, "interior").values())
    ends = np.cumsum([axis.size for axis in axes]).tolist()
    return tuple(
        StoredColumns(views, axis, end - axis.size)
        for axis, end in zip(axes, ends, strict=True)
    )


def store_views(
    store: Callable[[Sequence[slice], BlockMaker], tuple[Path, ...]],
    scene: Scene,
    windows: Sequence[Window],
    *,
    sensors: Sensors,
    **keywords: Unpack[EffortKeywords],
) -> StoredViews:
    """Trace the view matrices of all windows into files; see `view_matrices`.

    `store` is a function that stores blocks of rows, such as `MatrixStore.blocks` with
    a given name and fingerprint.
    """
    effort = replace(matrix_effort(store_views, keywords), components=True)
    job = view_job(scene, windows, sensors, effort)
    rows = tuple(row_blocks(job))
    make = partial(traced_block, job, effort, what="view matrices")
    return StoredViews(store(rows, make), rows)


def traced_block(
    job: EstimatedJob,
    effort: Effort,
    rows: slice,
    *,
    what: str,
    arrange: Callable[[np.ndarray], np.ndarray] = np.asarray,
) -> TransferMatrix:
    """Trace a block of rows of a matrix, with four error components.

    `what` is the name of the matrix in messages; `arrange` rearranges the columns of
    the values and of the error components.
    """
    _, _, columns, channels = job.shape
    axes = sensor_axis(rows.stop - rows.start), unknown_axis(columns)
    # A dry run records the job and needs no memory
    if not effort.executor.accepts(job, effort.goal):
        shape = channels, axes[0].size, columns
        blank = np.broadcast_to(np.float32(0), (FEW, *shape))
        return TransferMatrix(blank[0], *axes, blank, job.scene.bands)
    first, whole = rows.start, job.shape[0]
    progress = share_of_progress(
        effort.progress,
        first / whole,
        axes[0].size / whole,
        f"{first:,} of {whole:,} sensors",
    )
    block = estimate_rows(job, rows, replace(effort, progress=progress), few=FEW)
    warn_if_short(block, f"{what} of sensors {first + 1} to {rows.stop}", effort)
    assert block.components is not None
    values, few = block.values.astype(np.float32), pooled(block.components, FEW)
    return TransferMatrix(arrange(values), *axes, arrange(few), job.scene.bands)


def pooled(
    components: Float[np.ndarray, "component channel row column"], count: int
) -> Float[np.ndarray, "few channel row column"]:
    """Merge error components into `count` components of equal expected variance.

    >>> pooled(np.full((16, 1, 1, 1), 0.25), 4).shape
    (4, 1, 1, 1)
    """
    batches = len(components)
    message = f"{batches} error components; a multiple of {count} expected"
    require_matrix(batches % count == 0, message)
    each = batches // count
    groups = components.reshape(count, each, *components.shape[1:]).sum(axis=1)
    scale = np.sqrt(batches * (batches - 1) / (count * (count - 1))) / each
    return np.asarray(groups * components.dtype.type(scale))


def with_few_components(matrix: TransferMatrix) -> TransferMatrix:
    """Merge the error components of a matrix, if there are any, into four."""
    if matrix.components is None:
        return matrix
    return replace(matrix, components=pooled(matrix.components, FEW))
