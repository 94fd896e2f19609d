"""How a trace scales over the workers of a cluster on this machine.

    python benchmarks/cluster.py [--workers 1 2 3] [--triangles 20000] [--runs 1]
        [--write FILE]

Workers are real processes that speak TCP, of one thread of Dr.Jit each. As long as
there are cores for all, each is kept to one, as if it were a machine of its own; more
workers than cores share all cores. The efficiency is the rate of n workers over that
of one times the cores that they have, n at most. The scheduler and the process that
asks for the matrix run on the same cores and have no part in that. The same view matrix
must come out of all of them, to the bit. Every worker has the scene and its kernels
before the clock starts.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

import distributed
import numpy as np
from hall import facade, sensors_of, shell, space_frame

import clerestory as cl
from clerestory.cluster.cluster import _GRAIN
from clerestory.scene.model import Plastic

_WORKER = """
import os
os.sched_setaffinity(0, {cores})
from clerestory.engine.device import load
load("cpu")
import drjit
drjit.set_thread_count(1)
from distributed.cli.dask_worker import main
main()
"""
_SCHEDULER = "from distributed.cli.dask_scheduler import main; main()"
_QUIET = ["--host", "127.0.0.1", "--no-dashboard"]


@contextmanager
def cluster_of(workers: int, folder: Path):
    """Yield the address of a scheduler with so many workers."""
    file = folder / f"scheduler{workers}.json"
    log = (folder / f"cluster{workers}.log").open("w")
    cores = sorted(os.sched_getaffinity(0))

    def start(script: str, *words: str) -> subprocess.Popen:
        command = [sys.executable, "-c", script, *_QUIET, *words]
        return subprocess.Popen(command, stdout=log, stderr=log, cwd=folder)

    started = [start(_SCHEDULER, "--port", "0", "--scheduler-file", str(file))]
    try:
        for number in range(workers):
            own = {cores[number]} if workers <= len(cores) else set(cores)
            script = _WORKER.format(cores=own)
            words = ["--nthreads", "1", "--no-nanny", "--scheduler-file", str(file)]
            started.append(start(script, *words))
        with distributed.Client(scheduler_file=str(file), timeout=60) as client:
            client.wait_for_workers(workers, timeout=60)
            address = client.scheduler.address
        yield address
    finally:
        for process in started:
            process.kill()
            process.wait()
        log.close()


def hall(triangles: int) -> tuple[cl.Scene, list[cl.Window], cl.Sensors]:
    """Return a hall with four windows and 400 sensors."""
    walls, windows = facade(4)
    grey = Plastic("grey", np.full(3, 0.5))
    surfaces = (*shell(), *walls, space_frame(triangles))
    return cl.Scene({"grey": grey}, surfaces), windows, sensors_of(400)


def seconds_of(trace, runs: int) -> tuple[float, np.ndarray]:
    """Return the median time of some runs, and the matrix."""
    taken = []
    for _ in range(runs):
        start = time.perf_counter()
        found = trace()
        taken.append(time.perf_counter() - start)
    return float(np.median(taken)), found


def main() -> None:
    """Trace with one worker and with more; print and write how the rate grows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--triangles", type=int, default=20_000)
    parser.add_argument("--samples", type=int, default=1 << 16)
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    scene, windows, sensors = hall(options.triangles)
    goal = {"sensors": sensors, "seed": 1, "device": "cpu"}
    paths = len(sensors) * options.samples
    cores = len(os.sched_getaffinity(0))

    def trace(place: cl.Cluster, samples: int) -> np.ndarray:
        found = cl.view_matrices(
            scene, windows, executor=place, samples=samples, **goal
        )
        return np.concatenate([m.values for m in found.values()], axis=-1)

    lines = [f"### A view matrix on a cluster, {paths * 1e-6:.0f} million paths", ""]
    lines += [
        f"{datetime.now(tz=UTC).date()}, {cores} cores, workers of one thread each,"
        f" clerestory {cl.__version__}, load {os.getloadavg()[0]:.1f} before; medians"
        f" of {options.runs} runs of {-(-paths // _GRAIN.paths)} units.",
        "",
        "| workers | cores | seconds | million paths a s | efficiency | same bits |",
        "|---|---|---|---|---|---|",
    ]
    first: tuple[float, np.ndarray] | None = None
    with tempfile.TemporaryDirectory() as folder:
        for workers in options.workers:
            with (
                cluster_of(workers, Path(folder)) as address,
                cl.Cluster(address) as cluster,
            ):
                # An eighth of the work first: each worker builds and compiles
                trace(cluster, options.samples // 8)
                taken, found = seconds_of(
                    lambda: trace(cluster, options.samples), options.runs
                )
            busy = min(workers, cores)
            first = first or (taken * busy, found)
            share = first[0] / (taken * busy)
            same = "yes" if np.array_equal(found, first[1]) else "NO"
            rate = paths / taken * 1e-6
            figures = f"{taken:.1f} | {rate:.2f} | {share:.0%} | {same}"
            row = f"| {workers} | {busy} | {figures} |"
            lines.append(row)
            print(row, flush=True)
    text = "\n".join(lines) + "\n"
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
