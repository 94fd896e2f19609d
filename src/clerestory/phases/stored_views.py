"""View matrices larger than memory: kept block by block of sensors.

A file holds the rows of some sensors, all windows side by side, in single precision.
No more than one block is ever in memory, and each is kept as soon as it is traced, so
that a run that was killed goes on with the next one. Sixteen batches are traced, as
everywhere; their deviations are pooled into four error components.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Unpack

import numpy as np
from jaxtyping import Float32, Int

from clerestory.engine.controller import estimate_rows, row_blocks
from clerestory.engine.effort import Effort, EffortKeywords
from clerestory.engine.matrix_jobs import ViewJob
from clerestory.matrix.axis import sensor_axis, unknown_axis
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


@dataclass(frozen=True, eq=False)
class ViewBlock:
    """View matrices of some consecutive sensors, of all windows side by side."""

    rows: slice
    values: Float32[np.ndarray, "channel row column"]
    components: Float32[np.ndarray, "component channel row column"]


@dataclass(frozen=True, eq=False)
class StoredViews:
    """View matrices in files.

    Attributes
    ----------
    files : of the blocks of sensors
    rows : numbers of the sensors in each
    """

    files: tuple[Path, ...]
    rows: tuple[slice, ...]

    @property
    def sensors(self) -> int:
        """How many sensors there are."""
        return int(self.rows[-1].stop)

    def channels(self) -> int:
        """Return how many there are: one where the room is grey, else three.

        Raises
        ------
        InputError : a file is damaged
        """
        return len(read_netcdf(self.files[0]).values)

    def blocks(self, most: int) -> Iterator[ViewBlock]:
        """Yield blocks of at most so many sensors, in order.

        Raises
        ------
        InputError : a file is damaged
        """
        for file, rows in zip(self.files, self.rows, strict=True):
            matrix = read_netcdf(file)
            values, components = matrix.values, matrix.components
            if components is None:
                components = np.zeros((FEW, *values.shape), np.float32)
            for first in range(0, values.shape[1], most):
                part = slice(first, min(first + most, values.shape[1]))
                place = slice(rows.start + part.start, rows.start + part.stop)
                yield ViewBlock(place, values[:, part], components[:, :, part])

    def of(
        self, sensors: Int[np.ndarray, " row"]
    ) -> Float32[np.ndarray, "channel row column"]:
        """Return the coefficients of some sensors, without their errors.

        Parameters
        ----------
        sensors : their numbers, in growing order
        """
        parts = [
            block.values[:, chosen - block.rows.start]
            for block in self.blocks(self.sensors)
            for chosen in [_within(sensors, block.rows)]
            if len(chosen)
        ]
        return np.concatenate(parts, axis=1)


def _within(
    numbers: Int[np.ndarray, " row"], rows: slice
) -> Int[np.ndarray, " chosen"]:
    return np.asarray(numbers[(numbers >= rows.start) & (numbers < rows.stop)])


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
        return _matrix(block.values.astype(np.float32), few)

    return make


def _blank(job: ViewJob, rows: slice) -> TransferMatrix:
    _, _, columns, channels = job.shape
    shape = channels, rows.stop - rows.start, columns
    nothing = np.float32(0)
    return _matrix(
        np.broadcast_to(nothing, shape),
        np.broadcast_to(nothing, (FEW, *shape)),
    )


def _matrix(
    values: Float32[np.ndarray, "channel row column"],
    components: Float32[np.ndarray, "component channel row column"],
) -> TransferMatrix:
    _, rows, columns = values.shape
    return TransferMatrix(values, sensor_axis(rows), unknown_axis(columns), components)
