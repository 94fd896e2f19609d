"""Work units: independent, pure parts of an estimate that any process can trace.

A *job* is plain values: a scene, what receives its light, a seed. A *unit* is a part
of a job: some rows of its matrix, some columns, a range of the sample sequence. The
sums of a unit depend on the job and the unit alone, so that results do not depend on
how many processes share the work, and a lost unit is traced again.

An *executor* decides where units are traced: `Local` in this process, a cluster in
processes elsewhere. A plan is an executor that records jobs and traces none
(`engine.cost_estimate`).
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Literal, Protocol

import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.channels import GROUP, band_groups, channels_of
from clerestory.engine.device import Device, free_memory, load, resolve
from clerestory.engine.scene_cache import SceneCache
from clerestory.scene.model import Scene

# Limits of a unit on a CPU, where larger launches are not faster: paths, bytes of sums
_PATHS, _SUMS = 1 << 22, 1 << 29

# Memory of a path while it is traced on a GPU [bytes]
_PATH_BYTES = 256

# Most paths of a launch: their numbers stay below 2³², sums below 2³¹ entries
_MOST_PATHS, _MOST_SUMS = 1 << 26, 1 << 33


@dataclass(frozen=True, eq=False)
class Unit:
    """A part of a job.

    Attributes
    ----------
    rows : their numbers in the whole matrix
    first, count : range of the sequence of sample points
    columns : numbers of the columns, such as suns; None for all
    """

    rows: Int[np.ndarray, " row"]
    first: int
    count: int
    columns: Int[np.ndarray, " column"] | None = None


Tracer = Callable[[Unit], Float[np.ndarray, "*shape channel"]]


def evenly_spaced(count: int, most: int) -> Int[np.ndarray, " number"]:
    """Return at most so many of the numbers below `count`, evenly spread.

    >>> evenly_spaced(10, 4).tolist(), evenly_spaced(3, 4).tolist()
    ([0, 3, 6, 9], [0, 1, 2])
    """
    few = min(count, most)
    return np.unique(np.linspace(0, count - 1, few).round().astype(int))


@dataclass(frozen=True, eq=False, kw_only=True)
class Job(ABC):
    """Plain values that an estimate depends on.

    Attributes
    ----------
    tracer : module of the engine, and its function that takes the job and returns what
        traces its units
    scene : that light goes through
    batches : independent estimates of each row
    bounces : most diffuse reflections or gathers; None: no limit
    """

    tracer: ClassVar[tuple[str, str]]

    scene: Scene
    batches: int
    bounces: int | None = None
    seed: int
    device: Literal["cpu", "cuda"]

    @property
    @abstractmethod
    def shape(self) -> tuple[int, int, int, int]:
        """Rows, batches, columns and channels of the whole result."""

    @property
    def receivers(self) -> int:
        """How many things the samples of a goal are counted by: rows."""
        return self.shape[0]

    @abstractmethod
    def pilot_unit(self, paths: int) -> Unit:
        """Return a unit of about so many paths, for a pilot run."""


@dataclass(frozen=True)
class Goal:
    """When a job is done.

    Attributes
    ----------
    samples : paths per row, or per row and column asked for; None to aim at an error
    relative_error : to reach; None if samples are given
    """

    samples: int | None
    relative_error: float | None = None


@dataclass(frozen=True)
class UnitSize:
    """Limits of the size of a unit.

    Attributes
    ----------
    paths : traced by one unit
    sums : that it returns [bytes]
    """

    paths: int
    sums: int


class Executor(Protocol):
    """Where units are traced."""

    def resolve(self, device: Device) -> Literal["cpu", "cuda"]:
        """Return the device that a request leads to."""

    def accepts(self, job: Job, goal: Goal) -> bool:
        """Return whether to trace a job; the result of another one stays blank."""

    def unit_size(self, device: Literal["cpu", "cuda"]) -> UnitSize:
        """Return the limits of the size of units."""

    def workers(self) -> int:
        """Return how many units are traced at once."""

    def map(self, job: Job, units: Iterable[Unit]) -> Iterator[np.ndarray]:
        """Yield the sums of each unit, in the order of the units."""


def tracer_of_bands(job: Job, prepare: Callable[[Job], Tracer]) -> Tracer:
    """Return what traces the units of a job in all bands of its scene.

    Groups of three bands are traced by the same seeds; their channels lie side by side.
    """
    tracers = [prepare(_with_scene(job, scene)) for scene in band_groups(job.scene)]
    bands, grey = len(job.scene.bands), channels_of(job.scene) == 1

    def trace(unit: Unit) -> np.ndarray:
        first = tracers[0](unit)
        if len(tracers) == 1 or (grey and first.shape[-1] == 1):
            return first[..., :bands]
        parts = [first, *(tracer(unit) for tracer in tracers[1:])]
        shape = *first.shape[:-1], GROUP
        every = [np.broadcast_to(part, shape) for part in parts]
        return np.concatenate(every, axis=-1)[..., :bands]

    return trace


def _with_scene(job: Job, scene: Scene) -> Job:
    return job if scene is job.scene else replace(job, scene=scene)


class Local:
    """The executor that traces units in this process, one after the other.

    The last job stays prepared; the next one takes over the scenes built for it.
    """

    def __init__(self) -> None:
        self._job: Job | None = None
        self._tracer: Tracer | None = None
        self._cache = SceneCache()

    def resolve(self, device: Device) -> Literal["cpu", "cuda"]:
        """Return the device that a request leads to on this machine."""
        return resolve(device)

    def accepts(self, job: Job, goal: Goal) -> bool:
        """Return True: every job is done."""
        return True

    def workers(self) -> int:
        """Return one: a unit takes the whole machine."""
        return 1

    def unit_size(self, device: Literal["cpu", "cuda"]) -> UnitSize:
        """Return units as large as a launch: on a GPU, what its free memory holds."""
        if device == "cpu":
            return UnitSize(_PATHS, _SUMS)
        free = free_memory() or 0
        paths = min(_MOST_PATHS, free // 4 // _PATH_BYTES)
        return UnitSize(max(_PATHS, paths), max(_SUMS, min(_MOST_SUMS, free // 4)))

    def map(self, job: Job, units: Iterable[Unit]) -> Iterator[np.ndarray]:
        """Yield the sums of each unit, in the order of the units."""
        for unit in units:
            yield self.run(job, unit)

    def run(self, job: Job, unit: Unit) -> np.ndarray:
        """Return the sums of a unit."""
        name, prepare = job.tracer
        module = load(job.device, name)  # each thread has a variant of its own
        if job is not self._job or self._tracer is None:
            # Free the former tables before the next ones are built
            self._job = self._tracer = None
            with self._cache.preparing():
                self._tracer = tracer_of_bands(job, getattr(module, prepare))
            self._job = job
        return self._tracer(unit)
