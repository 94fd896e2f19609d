"""Jobs of paths from pixels or sensors to windows, straight or by one reflection.

What a receiver sees of the windows depends neither on the sun nor on the shade: the
paths are recorded once (`scene.window_zones` explains the codes), and multiplied by
tables of the windows' radiance for every sun and shade state.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float, Int, UInt16, UInt32

from clerestory.engine.channels import channels_of
from clerestory.engine.controller import traced_units
from clerestory.engine.effort import Effort
from clerestory.engine.work_units import Job, Unit, evenly_spaced
from clerestory.image.camera import PixelsOrCells
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

# Paths of a work unit: their records are transferred between processes
_PATHS = 1 << 20


@dataclass(frozen=True, eq=False, kw_only=True)
class WindowPathsJob(Job):
    """Paths from receivers to windows; `samples` is the number of paths a receiver."""

    windows: tuple[Window, ...]
    samples: int

    @property
    def points(self) -> int:
        """Number of sample points in each batch."""
        return -(-self.samples // self.batches)

    def pilot_unit(self, paths: int) -> Unit:
        """Return a pilot unit of rows that are evenly distributed over the matrix."""
        few = max(1, paths // (self.batches * self.points))
        return Unit(evenly_spaced(self.receivers, few), 0, self.points)


@dataclass(frozen=True, eq=False, kw_only=True)
class PixelWindowPaths(WindowPathsJob):
    """Paths from pixels, or cells of the sphere, by at most one reflection."""

    tracer: ClassVar[tuple[str, str]] = ("window_paths", "prepare_pixels")

    camera: PixelsOrCells

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Numbers of pixels, batches, columns (one, as they are recorded), channels."""
        return len(self.camera), self.batches, 1, channels_of(self.scene)


@dataclass(frozen=True, eq=False, kw_only=True)
class SensorWindowPaths(WindowPathsJob):
    """Straight paths from irradiance sensors; weights are projected solid angles."""

    tracer: ClassVar[tuple[str, str]] = ("window_paths", "prepare_sensors")

    sensors: Sensors

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Numbers of sensors, batches, columns (one: they are recorded), channels."""
        return len(self.sensors), self.batches, 1, channels_of(self.scene)


@dataclass(frozen=True, eq=False)
class Records:
    """Contributions of one batch of paths, receiver by receiver.

    Attributes
    ----------
    starts : index of the first contribution of each receiver, and the number of all
    directions, zones : exit direction of each contribution, and zone of the window
        with a bit for windows that are seen directly; see `scene.window_zones`
    weights : radiance of the receiver per radiance of the window; for a sensor,
        irradiance [sr]
    """

    starts: Int[np.ndarray, " edge"]
    directions: UInt32[np.ndarray, " contribution"]
    zones: UInt16[np.ndarray, " contribution"]
    weights: Float[np.ndarray, "channel contribution"]


def record_window_paths(
    job: WindowPathsJob, effort: Effort, note: str
) -> list[Records]:
    """Trace the paths of a job; return the contributions of each batch."""
    units = list(_units(job))
    pieces: list[list[tuple[np.ndarray, ...]]] = [[] for _ in range(job.batches)]
    for _, part in traced_units(job, units, effort, note):
        for batch, found in enumerate(pieces):
            found.append(_contributions(part[:, batch], job.points))
    return [_whole(found) for found in pieces]


def _units(job: WindowPathsJob) -> Iterator[Unit]:
    rows = np.arange(job.receivers)
    every = max(1, _PATHS // (job.batches * job.points))
    for first in range(0, len(rows), every):
        yield Unit(rows[first : first + every], 0, job.points)


def _contributions(
    records: Float[np.ndarray, "row record channel"], points: int
) -> tuple[np.ndarray, ...]:
    # Number by row, codes and mean weights of the records that are not empty. Exit
    # directions, zones and weights are a third of the records each
    directions, zones, weights = np.split(records, 3, axis=1)
    used = weights.max(axis=-1) > 0
    codes = (
        np.ascontiguousarray(part[..., 0][used]).view(np.uint32)
        for part in (directions, zones)
    )
    direction, zone = codes
    weight = (weights[used] / points).T
    return used.sum(axis=1), direction, zone.astype(np.uint16), weight


def _whole(pieces: list[tuple[np.ndarray, ...]]) -> Records:
    counts, *codes, weights = (list(part) for part in zip(*pieces, strict=True))
    starts = np.concatenate([[0], np.cumsum(np.concatenate(counts))])
    return Records(starts, *map(np.concatenate, codes), np.concatenate(weights, axis=1))
