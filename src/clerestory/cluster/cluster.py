"""Execution of work units on a dask.distributed cluster.

The scheduler and its workers are started beforehand, by any dask deployment method.
Each worker receives the scene once and each job (without its scene) once, then work
units, and returns the sums of path contributions. Units of a lost worker are repeated
on another worker. As units are deterministic, results are bitwise reproducible.

Client, scheduler and workers must trust each other: dask transfers values by pickle,
so anyone with access to the port of the scheduler can execute code. Pickled values are
never written to files. See `docs/cluster.md`.
"""

import importlib
import time
import warnings
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any, cast

import numpy as np

from clerestory.engine.device import Device, Processor
from clerestory.engine.work_units import Executor, Goal, Job, Local, Unit, UnitSize
from clerestory.errors import (
    ClerestoryError,
    ClerestoryWarning,
    DeviceError,
    InputError,
)
from clerestory.scene.model import Scene

# Units are smaller than on one machine: they are distributed over many workers, and
# their sums are sent over a network.
_UNIT_SIZE = UnitSize(paths=1 << 20, sums=1 << 25)

# Number of units submitted to each worker in advance, so that no worker has to wait
_AHEAD = 3

# Largest number of attempts at a unit whose workers are lost; timeouts for the first
# worker and for the scheduler [s]
_TRIES = 10
_WORKER, _SCHEDULER = 60.0, 10


@dataclass(frozen=True, eq=False)
class _Sent:
    # A scene or job sent to the workers, and the dask future of the copies there
    value: object
    copies: Any


_NOTHING = _Sent(None, None)


class Cluster:
    """Executor of work units on the workers of a dask scheduler; a context manager.

    Parameters
    ----------
    address : address of the scheduler, such as "tcp://10.0.0.1:8786"

    Raises
    ------
    InputError : no scheduler responds at the address
    DeviceError : no workers, different package versions, or dask is not installed
    """

    def __init__(self, address: str):
        dask = _distributed()
        self.address = address
        self._client = _client(dask, address)
        self._scene = self._job = _NOTHING
        try:
            self._worker = importlib.import_module("clerestory.cluster.worker")
            self._wait_for_workers()
            self._compare_versions()
            self._client.register_plugin(self._worker.Bench())
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> "Cluster":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Disconnect from the cluster without stopping it."""
        self._scene = self._job = _NOTHING
        self._client.close()

    def workers(self) -> int:
        """Return the number of connected workers; each traces one unit at a time."""
        return len(self._client.scheduler_info(n_workers=-1)["workers"])

    def resolve(self, device: Device) -> Processor:
        """Return the device used by all workers: a GPU only if every worker has one."""
        found = set(self._client.run(self._worker.device_of, device).values())
        if found == {"cuda"}:
            return "cuda"
        if "cuda" in found:
            warnings.warn(
                "not every worker of the cluster has a GPU; all workers use the CPU, so"
                " that results do not depend on the distribution of work units",
                ClerestoryWarning,
                stacklevel=2,
            )
        return "cpu"

    def accepts(self, job: Job, goal: Goal) -> bool:
        """Return True: the cluster traces every job."""
        return True

    def unit_size(self, device: Processor) -> UnitSize:
        """Return the largest size of a work unit."""
        return _UNIT_SIZE

    def map(self, job: Job, units: Iterable[Unit]) -> Iterator[np.ndarray]:
        """Trace work units, and yield the sums of each one in the given order."""
        waiting, running = iter(units), deque[tuple[Unit, Any]]()
        try:
            while True:
                ahead = _AHEAD * max(1, self.workers())
                while len(running) < ahead and (unit := next(waiting, None)):
                    running.append((unit, self._submit(job, unit)))
                if not running:
                    return
                unit, future = running.popleft()
                yield self._result(job, unit, future)
        finally:
            # Cancel submitted units, also after an error or an interruption
            self._client.cancel([future for _, future in running])

    def _submit(self, job: Job, unit: Unit) -> Any:
        # Jobs of several windows share a scene, which is sent once
        if job.scene is not self._scene.value:
            self._scene = self._job = _NOTHING
            self._scene = self._send(job.scene, job.scene)
        if job is not self._job.value:
            self._job = _NOTHING
            self._job = self._send(job, replace(cast(Any, job), scene=Scene()))
        copies = self._scene.copies, self._job.copies
        return self._client.submit(self._worker.do_unit, *copies, unit, pure=False)

    def _send(self, value: object, plain: object) -> "_Sent":
        return _Sent(value, self._client.scatter(plain, broadcast=True, hash=False))

    def _result(self, job: Job, unit: Unit, future: Any) -> np.ndarray:
        # Wait for the result; repeat the unit if its worker was lost
        for _ in range(_TRIES):
            try:
                sums: np.ndarray = future.result()
                return sums
            except ClerestoryError:
                raise
            except _losses():
                # Send scene and job again: the copies may be lost with the workers
                self._wait_for_workers()
                self._scene = self._job = _NOTHING
                future = self._submit(job, unit)
        raise DeviceError(
            f"a work unit failed {_TRIES} times because its worker was lost; check the"
            " memory limits and logs of the workers"
        )

    def _wait_for_workers(self) -> None:
        until = time.monotonic() + _WORKER
        while not self.workers():
            if time.monotonic() > until:
                what = f"the cluster at {self.address} has no workers"
                raise DeviceError(f"{what}; at least one expected")
            time.sleep(0.2)

    def _compare_versions(self) -> None:
        ours = self._worker.versions()
        for worker, theirs in self._client.run(self._worker.versions).items():
            for name, version in ours.items():
                if theirs[name] != version:
                    raise DeviceError(
                        f"worker {worker} has {name} {theirs[name]};"
                        f" {version} expected, as on the client"
                    )


@contextmanager
def executor_at(address: str | None) -> Iterator[Executor]:
    """Yield the cluster at an address, or the local executor if the address is None."""
    if address is None:
        yield Local()
        return
    with Cluster(address) as cluster:
        yield cluster


def _distributed() -> ModuleType:
    try:
        return importlib.import_module("distributed")
    except ImportError as error:
        raise DeviceError(
            "a cluster requires dask.distributed; pip install 'clerestory[cluster]'"
        ) from error


def _client(dask: ModuleType, address: str) -> Any:
    try:
        return dask.Client(address, timeout=_SCHEDULER, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"no dask scheduler answers at {address!r}; an address such as"
            " tcp://10.0.0.1:8786 expected"
        ) from error


def _losses() -> tuple[type[BaseException], ...]:
    # Exceptions that dask raises if a worker is lost together with its results
    client = importlib.import_module("distributed.client")
    killed = importlib.import_module("distributed.scheduler").KilledWorker
    return client.FutureCancelledError, killed, OSError
