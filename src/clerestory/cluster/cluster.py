"""A dask.distributed cluster as a place where units of work are done.

The scheduler and its workers run already, started by any of dask's own deployments.
A scene is sent to each worker once, and so is each job, without its scene; units
follow, and their sums come back. Units of a worker that is lost are done again
elsewhere, and since every unit is pure the result is the same to the bit.

Client, scheduler and workers trust each other: dask sends values by pickle, so
whoever reaches the scheduler's port can run code. Nothing of this is ever written
to a file. See `docs/cluster.md`.
"""

import time
import warnings
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Any, Literal, cast

import numpy as np

from clerestory.cluster import optional
from clerestory.engine.device import Device
from clerestory.engine.work_units import Executor, Goal, Job, Local, Unit, UnitSize
from clerestory.errors import ClerestoryError, ClerestoryWarning, DeviceError
from clerestory.scene.model import Scene

# Units are small beside launches on one machine: many workers share a round, and what
# they return travels over a network.
_UNIT_SIZE = UnitSize(paths=1 << 20, sums=1 << 25)

# Units under way, for each worker; what is done waits here for its turn
_AHEAD = 3

# How often a unit is tried when its worker is lost, and how long a cluster without
# workers is waited for [s]
_TRIES = 10
_PATIENCE = 60.0


@dataclass(frozen=True, eq=False)
class _Sent:
    # A value, and its copies on the workers
    value: object
    copies: Any


_NOTHING = _Sent(None, None)


class Cluster:
    """Workers of a running dask scheduler; a context manager, or call `close`.

    Parameters
    ----------
    address : of the scheduler, such as "tcp://10.0.0.1:8786"

    Raises
    ------
    InputError : nothing answers there
    DeviceError : no workers, other versions than here, or dask is not installed
    """

    def __init__(self, address: str):
        self._dask = optional.load()
        self.address = address
        self._client = optional.connect(self._dask, address)
        self._scene = self._job = _NOTHING
        try:
            self._worker = optional.load_worker()
            self._wait_for_workers()
            self._compare_versions()
            self._client.register_plugin(self._worker.Bench())
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> "Cluster":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the cluster; it goes on running."""
        self._scene = self._job = _NOTHING
        self._client.close()

    def workers(self) -> int:
        """Return how many units are done at once: the workers there are now."""
        return len(self._client.scheduler_info(n_workers=-1)["workers"])

    def resolve(self, device: Device) -> Literal["cpu", "cuda"]:
        """Return the device of all workers: a GPU only if each of them has one."""
        found = set(self._client.run(self._worker.device_of, device).values())
        if found == {"cuda"}:
            return "cuda"
        if "cuda" in found:
            warnings.warn(
                "not every worker of the cluster has a GPU; all trace on the CPU, so"
                " that results do not depend on who did what",
                ClerestoryWarning,
                stacklevel=2,
            )
        return "cpu"

    def accepts(self, job: Job, goal: Goal) -> bool:
        """Return True: every job is done."""
        return True

    def unit_size(self, device: Literal["cpu", "cuda"]) -> UnitSize:
        """Return how large units may be."""
        return _UNIT_SIZE

    def map(self, job: Job, units: Iterable[Unit]) -> Iterator[np.ndarray]:
        """Yield what each unit adds, in the order of the units.

        Raises
        ------
        DeviceError : the workers are gone for good, or a unit ends every worker
        """
        waiting, running = iter(units), deque[tuple[Unit, Any]]()
        try:
            while True:
                # Keep every worker busy, and a few units ahead
                ahead = _AHEAD * max(1, self.workers())
                while len(running) < ahead and (unit := next(waiting, None)):
                    running.append((unit, self._submit(job, unit)))
                if not running:
                    return
                unit, future = running.popleft()
                yield self._result(job, unit, future)
        finally:
            # On an error or an interruption: nothing goes on behind the back
            self._client.cancel([future for _, future in running])

    def _submit(self, job: Job, unit: Unit) -> Any:
        # The next window's job goes through the same scene: that is sent once
        if job.scene is not self._scene.value:
            self._scene = self._job = _NOTHING
            self._scene = self._send(job.scene, job.scene)
        if job is not self._job.value:
            self._job = _NOTHING
            self._job = self._send(job, replace(cast(Any, job), scene=Scene()))
        copies = self._scene.copies, self._job.copies
        return self._client.submit(self._worker.do_unit, *copies, unit, pure=False)

    def _send(self, value: object, plain: object) -> "_Sent":
        copies = self._client.scatter(plain, broadcast=True, hash=False)
        return _Sent(value, copies)

    def _result(self, job: Job, unit: Unit, future: Any) -> np.ndarray:
        # Wait for a unit; do it again as long as only workers are lost
        for _ in range(_TRIES):
            try:
                sums: np.ndarray = future.result()
                return sums
            except ClerestoryError:
                raise
            except optional.losses(self._dask):
                # The copies of the scene may be gone with the workers
                self._wait_for_workers()
                self._scene = self._job = _NOTHING
                future = self._submit(job, unit)
        raise DeviceError(
            f"a unit of work was lost {_TRIES} times with its workers; look at their"
            " memory limits and logs"
        )

    def _wait_for_workers(self) -> None:
        until = time.monotonic() + _PATIENCE
        while not self.workers():
            if time.monotonic() > until:
                raise DeviceError(
                    f"the cluster at {self.address} has no workers; at least one"
                    " expected"
                )
            time.sleep(0.2)

    def _compare_versions(self) -> None:
        ours = self._worker.versions()
        for worker, theirs in self._client.run(self._worker.versions).items():
            for name, version in ours.items():
                if theirs[name] != version:
                    raise DeviceError(
                        f"worker {worker} has {name} {theirs[name]};"
                        f" {version} expected, as here"
                    )


@contextmanager
def executor_at(address: str | None) -> Iterator[Executor]:
    """Yield the cluster at an address, or this process where there is none."""
    if address is None:
        yield Local()
        return
    with Cluster(address) as cluster:
        yield cluster
