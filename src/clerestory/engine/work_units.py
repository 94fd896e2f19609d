"""Work units: independent, deterministic parts of an estimate for any process.

A *job* holds plain data: a scene, receivers such as sensors or pixels, a seed. A
*unit* is a part of a job: a set of matrix rows and columns, and a range of the sample
sequence. The sums of a unit depend only on the job and the unit. Results therefore do
not depend on the number of processes, and a lost unit can be traced again.

An *executor* traces units: `Local` in this process, a cluster in other processes. A
plan is an executor that records jobs without tracing them (`engine.cost_estimate`).
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Protocol

import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.channels import (
    GROUP,
    band_groups,
    bands_share_paths,
    channels_of,
    shared_groups,
)
from clerestory.engine.device import Device, Processor, free_memory, load, resolve
from clerestory.engine.scene_cache import SceneCache
from clerestory.engine.unusual_lengths import in_usual_lengths
from clerestory.scene.model import Scene

# Largest unit on a CPU, where larger launches are not faster: paths, sums [bytes]
_PATHS, _SUMS = 1 << 22, 1 << 29

# Memory of a path while it is traced on a GPU [bytes]
_PATH_BYTES = 256

# Largest launch: number of paths (indices below 2³²), sums [bytes] (below 2³¹ entries)
_MOST_PATHS, _MOST_SUMS = 1 << 26, 1 << 33


@dataclass(frozen=True, eq=False)
class Unit:
    """A part of a job: rows of the matrix, and a range of the sample points.

    `columns` are indices of columns, such as suns, or None for all columns.
    """

    rows: Int[np.ndarray, " row"]
    first: int
    count: int
    columns: Int[np.ndarray, " column"] | None = None

    def paths(self, batches: int) -> int:
        """Return the number of paths."""
        columns = 1 if self.columns is None else len(self.columns)
        return batches * len(self.rows) * columns * self.count


Tracer = Callable[[Unit], Float[np.ndarray, "*shape channel"]]


def evenly_spaced(count: int, most: int) -> Int[np.ndarray, " number"]:
    """Return at most `most` evenly spaced integers from 0 to `count` - 1.

    >>> evenly_spaced(10, 4).tolist(), evenly_spaced(3, 4).tolist()
    ([0, 3, 6, 9], [0, 1, 2])
    """
    few = min(count, most)
    return np.unique(np.linspace(0, count - 1, few).round().astype(int))


@dataclass(frozen=True, eq=False, kw_only=True)
class Job(ABC):
    """Plain data that determine an estimate: base class of all jobs.

    `tracer` names an engine module and its function that returns the tracer of the
    job's units; `scalable` tells whether its fields can be converted to another unit of
    length, `spectral_paths` whether its paths can carry more than three bands.
    `batches` is the number of independent estimates of each row; for `bounces`, see
    `Effort`.
    """

    tracer: ClassVar[tuple[str, str]]
    scalable: ClassVar[bool] = True
    spectral_paths: ClassVar[bool] = False

    scene: Scene
    batches: int
    bounces: int | None = None
    seed: int
    device: Processor

    @property
    @abstractmethod
    def shape(self) -> tuple[int, int, int, int]:
        """Numbers of rows, batches, columns and channels of the whole result."""

    @property
    def receivers(self) -> int:
        """Number of receivers with samples of their own: the rows of the matrix."""
        return self.shape[0]

    @abstractmethod
    def pilot_unit(self, paths: int) -> Unit:
        """Return a unit of about `paths` paths, for a pilot run."""


@dataclass(frozen=True)
class Goal:
    """Stopping criterion of a job: samples, or a target relative standard error.

    Samples are paths per row, or per pair of row and column.
    """

    samples: int | None
    relative_error: float | None = None


@dataclass(frozen=True)
class UnitSize:
    """Largest number of paths of a unit, and largest size of its sums [bytes]."""

    paths: int
    sums: int


class Executor(Protocol):
    """An object that traces work units."""

    def resolve(self, device: Device) -> Processor:
        """Return the compute device for a setting such as "auto"."""

    def accepts(self, job: Job, goal: Goal) -> bool:
        """Return whether to trace a job; the result of a rejected job is zero."""

    def unit_size(self, device: Processor) -> UnitSize:
        """Return the largest size of a work unit."""

    def workers(self) -> int:
        """Return the number of units traced in parallel."""

    def map(self, job: Job, units: Iterable[Unit]) -> Iterator[np.ndarray]:
        """Trace work units, and yield the sums of each one in the given order."""


def tracer_of_bands(job: Job, prepare: Callable[[Job], Tracer]) -> Tracer:
    """Return a function that traces the units of a job in all bands of its scene.

    All bands share the paths if possible (`channels`); otherwise, groups of three bands
    are traced with the same seeds, and their channels are concatenated. Scenes of
    unusual size are scaled (`unusual_lengths`).
    """
    job = in_usual_lengths(job)
    if job.spectral_paths and bands_share_paths(job.scene):
        return _tracer_of_shared_paths(job, prepare)
    scenes = band_groups(job.scene)
    bands, grey = len(job.scene.bands), channels_of(job.scene) == 1
    # In a scene of grey materials, only coloured sources require other groups
    some = scenes[:1] if grey else scenes
    tracers = [prepare(_with_scene(job, scene)) for scene in some]

    def trace(unit: Unit) -> np.ndarray:
        first = tracers[0](unit)
        if len(scenes) == 1 or (grey and first.shape[-1] == 1):
            return first[..., :bands]
        rest = scenes[len(tracers) :]
        tracers.extend(prepare(_with_scene(job, scene)) for scene in rest)
        parts = [first, *(tracer(unit) for tracer in tracers[1:])]
        shape = *first.shape[:-1], GROUP
        every = [np.broadcast_to(part, shape) for part in parts]
        return np.concatenate(every, axis=-1)[..., :bands]

    return trace


def _tracer_of_shared_paths(job: Job, prepare: Callable[[Job], Tracer]) -> Tracer:
    scenes = shared_groups(job.scene)
    tracers = [prepare(_with_scene(job, scene)) for scene in scenes]

    def trace(unit: Unit) -> np.ndarray:
        parts = [tracer(unit) for tracer in tracers]
        if len(parts) == 1:
            return parts[0]
        return np.concatenate(
            [
                np.broadcast_to(part, (*part.shape[:-1], len(scene.bands)))
                for part, scene in zip(parts, scenes, strict=True)
            ],
            axis=-1,
        )

    return trace


def _with_scene(job: Job, scene: Scene) -> Job:
    return job if scene is job.scene else replace(job, scene=scene)


class Local:
    """The executor that traces units in this process, one after another.

    The last job stays prepared; the next job reuses equal lowered scenes.
    """

    def __init__(self) -> None:
        self._job: Job | None = None
        self._tracer: Tracer | None = None
        self._cache = SceneCache()

    def resolve(self, device: Device) -> Processor:
        """Return the compute device for a setting such as "auto"."""
        return resolve(device)

    def accepts(self, job: Job, goal: Goal) -> bool:
        """Return True: every job is traced."""
        return True

    def workers(self) -> int:
        """Return one: a unit uses the whole machine."""
        return 1

    def unit_size(self, device: Processor) -> UnitSize:
        """Return the largest size of a work unit, limited by the memory of a GPU."""
        if device == "cpu":
            return UnitSize(_PATHS, _SUMS)
        free = free_memory() or 0
        paths = min(_MOST_PATHS, free // 4 // _PATH_BYTES)
        return UnitSize(max(_PATHS, paths), max(_SUMS, min(_MOST_SUMS, free // 4)))

    def map(self, job: Job, units: Iterable[Unit]) -> Iterator[np.ndarray]:
        """Trace work units, and yield the sums of each one in the given order."""
        for unit in units:
            yield self.run(job, unit)

    def run(self, job: Job, unit: Unit) -> np.ndarray:
        """Trace a unit, and return its sums of path contributions."""
        name, prepare = job.tracer
        module = load(job.device, name)  # the Mitsuba variant is set per thread
        if job is not self._job or self._tracer is None:
            # Free the Dr.Jit arrays of the previous job first
            self._job = self._tracer = None
            with self._cache.preparing():
                self._tracer = tracer_of_bands(job, getattr(module, prepare))
            self._job = job
        return self._tracer(unit)
