"""What a worker of a cluster does: it keeps one job prepared and does its units.

A worker process computes on one device and with one scene at a time, however many
threads dask gives it; Dr.Jit spreads each launch over the processor's cores itself.
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
    """A worker's own place: its executor, and a lock that keeps it to one unit."""

    name = NAME

    def setup(self, worker: Any) -> None:
        """Start with nothing prepared."""
        self.local, self.lock = Local(), threading.Lock()
        self.sent: Any = None
        self.whole: Any = None

    def do(self, scene: Scene, job: Any, unit: Unit) -> np.ndarray:
        """Return what a unit adds; the job was sent without its scene."""
        with self.lock:
            if self.sent is not job or self.whole.scene is not scene:
                self.sent, self.whole = job, replace(job, scene=scene)
            sums: np.ndarray = self.local.run(self.whole, unit)
            return sums


def do_unit(scene: Scene, job: Job, unit: Unit) -> np.ndarray:
    """Return what a unit adds, on the worker that this is called on."""
    bench: Any = distributed.get_worker().plugins[NAME]
    sums: np.ndarray = bench.do(scene, job, unit)
    return sums


def versions() -> dict[str, str]:
    """Return the versions that results depend on."""
    ours = {NAME: __version__, "estimators": str(ESTIMATOR_REVISION)}
    return {**ours, **{name: version(name) for name in _PACKAGES}}


def device_of(wanted: Device) -> str:
    """Return the device that a request leads to on this worker."""
    return str(resolve(wanted))
