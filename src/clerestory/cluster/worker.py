"""Execution of work units on a worker of a dask cluster.

A worker process computes one unit at a time, whatever its number of dask threads;
Dr.Jit distributes each launch over the cores of the processor.
"""

import threading
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import distributed
import numpy as np

from clerestory import __version__
from clerestory.engine.device import Device, resolve
from clerestory.engine.revision import ESTIMATOR_REVISION
from clerestory.engine.work_units import Job, Local, Unit
from clerestory.scene.model import Scene

NAME = "clerestory"

_PACKAGES = ("drjit", "mitsuba", "numpy")


class Bench(distributed.WorkerPlugin):
    """Dask plugin of a worker: an executor, and a lock for one unit at a time."""

    name = NAME

    def setup(self, worker: Any) -> None:
        """Create the executor and the lock."""
        self.local, self.lock = Local(), threading.Lock()
        self.sent: Any = None
        self.whole: Any = None

    def do(self, scene: Scene, job: Any, unit: Unit) -> np.ndarray:
        """Trace a unit and return its sums; `job` was sent without its scene."""
        with self.lock:
            if self.sent is not job or self.whole.scene is not scene:
                self.sent, self.whole = job, replace(job, scene=scene)
            sums: np.ndarray = self.local.run(self.whole, unit)
            return sums


def do_unit(scene: Scene, job: Job, unit: Unit) -> np.ndarray:
    """Trace a unit with the plugin of the current worker, and return its sums."""
    bench: Any = distributed.get_worker().plugins[NAME]
    sums: np.ndarray = bench.do(scene, job, unit)
    return sums


def versions() -> dict[str, str]:
    """Return the package versions that affect results."""
    ours = {NAME: __version__, "estimator revision": str(ESTIMATOR_REVISION)}
    return {**ours, **{name: version(name) for name in _PACKAGES}}


def device_of(wanted: Device) -> str:
    """Return the compute device of this worker for a setting such as "auto"."""
    return str(resolve(wanted))
