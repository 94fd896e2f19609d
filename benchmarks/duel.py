"""Two programs side by side at equal error: time × variance, interleaved, medians."""

import datetime
import importlib.metadata
import os
import platform
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import pyradiance

import clerestory
from clerestory.engine.device import resolve
from clerestory.errors import DeviceError

_HOME = Path(pyradiance.__file__).parent
ENVIRONMENT = {
    **os.environ,
    "PATH": f"{_HOME / 'bin'}:{os.environ['PATH']}",
    "RAYPATH": f".:{_HOME / 'lib'}",
}


@dataclass(frozen=True)
class Contender:
    """One way to make the matrix.

    Attributes
    ----------
    name : for the table
    make : returns the matrix (row, column) of one channel for a run's number
    peer : whether it is the other program
    """

    name: str
    make: Callable[[int], np.ndarray]
    peer: bool = False


def devices() -> list[Literal["cpu", "cuda"]]:
    """Return the compute devices of this machine."""
    try:
        return ["cpu", resolve("cuda")]
    except DeviceError:
        return ["cpu"]


def on(device: str) -> str:
    """Return what a contender's name says of its device."""
    return " on the GPU" if device == "cuda" else ""


def radiance(command: str, folder: Path, stdin: str | None = None) -> np.ndarray:
    """Run rfluxmtx and return the first channel of its matrix."""
    done = subprocess.run(
        command,
        shell=True,
        cwd=folder,
        env=ENVIRONMENT,
        input=stdin,
        capture_output=True,
        text=True,
        check=True,
    )
    rows = [np.array(line.split(), float) for line in done.stdout.splitlines() if line]
    return np.array([row for row in rows if len(row)]).reshape(len(rows), -1, 3)[..., 0]


def duel(
    title: str, contenders: list[Contender], reference: np.ndarray, *, runs: int
) -> str:
    """Run all contenders in turns and return a Markdown table.

    The error is the root mean square over all coefficients over their mean. One run
    of each comes first and does not count: it compiles kernels.
    """
    seconds = {c.name: [] for c in contenders}
    errors = {c.name: [] for c in contenders}
    for contender in contenders:
        contender.make(0)
    for number in range(1, runs + 1):
        for contender in contenders:
            start = time.perf_counter()
            matrix = contender.make(number)
            seconds[contender.name].append(time.perf_counter() - start)
            error = np.sqrt(np.mean((matrix - reference) ** 2)) / reference.mean()
            errors[contender.name].append(error)

    return table(title, contenders, seconds, errors)


def table(
    title: str,
    contenders: list[Contender],
    seconds: dict[str, list[float]],
    errors: dict[str, list[float]],
) -> str:
    """Return a Markdown table of the seconds and errors of each contender's runs."""
    cost = {
        c.name: np.median(seconds[c.name]) * np.mean(np.square(errors[c.name]))
        for c in contenders
    }
    runs = len(seconds[contenders[0].name])
    peers = [c for c in contenders if c.peer]
    heads = [f"× {c.name}" for c in peers]
    lines = [f"### {title}", "", f"{stamp()}; medians of {runs} runs in turns.", ""]
    lines.append("| | seconds | error | " + " | ".join(heads) + " |")
    lines.append("|---|---|---|" + "---|" * len(heads))
    for c in contenders:
        ratios = [f"{cost[p.name] / cost[c.name]:.1f}" for p in peers]
        time_text = f"{np.median(seconds[c.name]):.3f}"
        error_text = f"{np.sqrt(np.mean(np.square(errors[c.name]))):.4f}"
        lines.append(
            f"| {c.name} | {time_text} | {error_text} | {' | '.join(ratios)} |"
        )
    return "\n".join(lines)


def stamp() -> str:
    """Return date, machine class and versions."""
    others = ("mitsuba", "drjit", "pyradiance")
    versions = ", ".join(
        [f"clerestory {clerestory.__version__}"]
        + [f"{name} {importlib.metadata.version(name)}" for name in others]
    )
    today = datetime.datetime.now(tz=datetime.UTC).date()
    return f"{today}, {os.cpu_count()} cores {platform.machine()}, {versions}"
