"""Clusters of real processes on this machine: a dask scheduler and its workers."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import distributed

_START_TIME = 60.0


@dataclass
class LocalCluster:
    """A scheduler, and workers with one process each."""

    address: str
    folder: Path
    log: object
    workers: list[subprocess.Popen] = field(default_factory=list)

    def add_worker(self) -> None:
        """Start one more worker, of one thread."""
        options = [self.address, "--nthreads", "1", "--no-nanny"]
        self.workers.append(_start("worker", options, self.folder, self.log))

    def kill(self, number: int) -> None:
        """End a worker as the power supply would."""
        os.kill(self.workers[number].pid, signal.SIGKILL)
        self.workers[number].wait()


@contextmanager
def local_cluster(folder: Path, *, workers: int):
    """Yield a cluster that listens on this machine's own address."""
    file = folder / "scheduler.json"
    log = (folder / "cluster.log").open("w")
    options = ["--port", "0", "--scheduler-file", str(file)]
    scheduler = _start("scheduler", options, folder, log)
    found = LocalCluster("", folder, log)
    try:
        # The file appears before its text does
        _until(lambda: file.exists() and file.stat().st_size > 0)
        found.address = json.loads(file.read_text())["address"]
        for _ in range(workers):
            found.add_worker()
        with distributed.Client(found.address, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=_START_TIME)
        yield found
    finally:
        for process in (*found.workers, scheduler):
            process.kill()
        for process in (*found.workers, scheduler):
            process.wait(20)
        log.close()


def _start(what: str, options: list[str], folder: Path, log) -> subprocess.Popen:
    script = f"from distributed.cli.dask_{what} import main; main()"
    words = [sys.executable, "-c", script, "--host", "127.0.0.1", "--no-dashboard"]
    return subprocess.Popen([*words, *options], stdout=log, stderr=log, cwd=folder)


def _until(done) -> None:
    limit = time.monotonic() + _START_TIME
    while not done():
        if time.monotonic() > limit:
            raise TimeoutError("the cluster did not start")
        time.sleep(0.1)
