"""Runs of EnergyPlus in child processes: conversion of models, and simulation."""

import importlib.util
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.files import is_file, read_bytes, read_text, write_text
from clerestory.progress import Progress

# Files in the folder of a child process
IDF_FILE, MODEL_FILE = "in.idf", "in.epJSON"
JOB_FILE, VALUES_FILE = "job.json", "values.npy"

# First word of the command that converts a model
CONVERT = "convert"

# Hours of the year that is simulated
HOURS = 8760


@dataclass(frozen=True, eq=False)
class Actuator:
    """Quantity of the model that is set at each time step.

    Attributes
    ----------
    component, control, key : names by EnergyPlus' list of actuators, such as "Lights",
        "Electricity Rate" and the name of the object
    values : number at each time step of the year, or number in `constructions`
    constructions : names of constructions, for "Construction State" of a "Surface"
    """

    component: str
    control: str
    key: str
    values: np.ndarray
    constructions: Sequence[str] = ()

    __repr__ = brief


@dataclass(frozen=True)
class Output:
    """Meter, without `key`, or variable of an object; `sum` over a step, or mean."""

    name: str
    key: str | None = None
    sum: bool = False


@dataclass(frozen=True, eq=False)
class AnnualRun:
    """Simulation of a year: model, weather file, actuators and outputs."""

    model: Mapping[str, Any]
    weather: Path
    actuators: Sequence[Actuator]
    outputs: Sequence[Output]
    steps_per_hour: int = 1
    source: str = field(default="", kw_only=True)

    __repr__ = brief


def simulate(
    run: AnnualRun, *, progress: Progress | None = None
) -> Float[np.ndarray, "output step"]:
    """Simulate a year, and return the outputs in each time step.

    Energy of meters is in joules, other quantities are in EnergyPlus' units. Steps that
    the run period of the model does not contain, and outputs that it does not have, are
    NaN.

    Raises
    ------
    InputError : EnergyPlus is not installed or refuses the model; the message is the
        engine's own
    """
    with _folder() as folder:
        write_text(folder / MODEL_FILE, json.dumps(run.model))
        job = {
            "weather": str(Path(run.weather).resolve()),
            "steps_per_hour": run.steps_per_hour,
            "actuators": [
                {**asdict(each), "values": np.asarray(each.values).tolist()}
                for each in run.actuators
            ],
            "outputs": [asdict(output) for output in run.outputs],
        }
        write_text(folder / JOB_FILE, json.dumps(job))
        _engine([str(folder)], folder, progress, source=run.source)
        return np.asarray(np.load(folder / VALUES_FILE, allow_pickle=False))


def convert_to_json(path: Path) -> str:
    """Return an IDF model as epJSON text, as EnergyPlus converts it.

    Raises
    ------
    InputError : EnergyPlus is not installed or refuses the model
    """
    with _folder() as folder:
        (folder / IDF_FILE).write_bytes(read_bytes(path))
        _engine([CONVERT, str(folder)], folder, None, source=str(path))
        return read_text(folder / MODEL_FILE)


@contextmanager
def _folder() -> Iterator[Path]:
    require(
        importlib.util.find_spec("pyenergyplus") is not None,
        'EnergyPlus is not installed; pip install "clerestory[energy]" expected',
    )
    with tempfile.TemporaryDirectory(prefix="clerestory-") as place:
        yield Path(place)


def _engine(
    words: Sequence[str], folder: Path, progress: Progress | None, *, source: str
) -> None:
    # The engine prints the completed percentage; a failure is the last line on stderr
    command = [sys.executable, "-m", "clerestory.energyplus.engine_process", *words]
    with (
        (folder / "messages").open("w+", encoding="utf-8") as said,
        subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=said, text=True, cwd=folder
        ) as child,
    ):
        try:
            for line in child.stdout or ():
                if progress and line.strip().isdigit():
                    progress(min(int(line), 100) / 100, "")
        except BaseException:
            child.kill()
            raise
        if status := child.wait():
            said.seek(0)
            last = said.read().strip().splitlines()[-1:]
            ended = f"EnergyPlus ended with status {status} and without a message"
            text = _reason(folder) or "".join(last) or ended
            raise InputError(text, file=source or None)


def _reason(folder: Path) -> str:
    # First severe or fatal message of EnergyPlus, with the lines that go on
    path = folder / "eplusout.err"
    lines = read_text(path).splitlines() if is_file(path) else []
    for number, line in enumerate(lines):
        kind, _, text = line.strip().strip("*").strip().partition("**")
        if kind.strip() in ("Severe", "Fatal"):
            more = (
                lines[number + 1].partition("~~~")[2] if number + 1 < len(lines) else ""
            )
            return " ".join(f"EnergyPlus: {text} {more.strip('* ')}".split())
    return ""
