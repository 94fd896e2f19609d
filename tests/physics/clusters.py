"""Clusters of real processes on this machine: a dask scheduler and its workers."""

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import clerestory as cl

_START_TIME = 60.0


@dataclass
class LocalCluster:
    """A scheduler, and workers with one process each."""

    address: str
    workers: list[subprocess.Popen]

    def kill(self, number: int) -> None:
        """End a worker as the power supply would."""
        os.kill(self.workers[number].pid, signal.SIGKILL)
        self.workers[number].wait()


@contextmanager
def local_cluster(folder: Path, *, workers: int):
    """Yield a cluster that listens on this machine's own address."""
    file = folder / "scheduler.json"
    log = (folder / "cluster.log").open("w")
    common = {"stdout": log, "stderr": log, "cwd": folder}
    script = "from distributed.cli.dask_{0} import main; main()"
    listen = ["--host", "127.0.0.1", "--no-dashboard"]
    scheduler = subprocess.Popen(
        [sys.executable, "-c", script.format("scheduler"), *listen]
        + ["--port", "0", "--scheduler-file", str(file)],
        **common,
    )
    started = []
    try:
        _until(file.exists)
        for _ in range(workers):
            options = ["--nthreads", "1", "--no-nanny", "--scheduler-file", str(file)]
            words = [sys.executable, "-c", script.format("worker"), *listen, *options]
            started.append(subprocess.Popen(words, **common))
        found = LocalCluster(_address(file), started)
        with cl.Cluster(found.address) as cluster:
            _until(lambda: cluster.workers() == workers)
        yield found
    finally:
        for process in (*started, scheduler):
            process.terminate()
        for process in (*started, scheduler):
            process.wait(20)
        log.close()


def _address(file: Path) -> str:
    import json

    return json.loads(file.read_text())["address"]


def _until(done) -> None:
    limit = time.monotonic() + _START_TIME
    while not done():
        if time.monotonic() > limit:
            raise TimeoutError("the cluster did not start")
        time.sleep(0.1)
