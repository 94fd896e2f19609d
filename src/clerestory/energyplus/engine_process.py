"""Program of a child process that simulates a model with EnergyPlus' Python interface.

    python -m clerestory.energyplus.engine_process [convert] FOLDER

reads model and job from the folder and writes `values.npy`, one row for each output and
one column for each time step of a year; or converts `in.idf` to epJSON. The engine ends
its process after some errors, and keeps global state: it never runs in the process of
the caller. This module alone needs the extra `energy`.
"""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pyenergyplus.api import EnergyPlusAPI

from clerestory.energyplus.engine_run import (
    CONVERT,
    HOURS,
    IDF_FILE,
    JOB_FILE,
    MODEL_FILE,
    VALUES_FILE,
)

# Days before each month of a year of 365 days
_DAYS = (0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334)


class _Exchange:
    """Actuators and outputs of one run, handled at each time step."""

    def __init__(self, api: Any, job: Mapping[str, Any]) -> None:
        self.data, self.job = api.exchange, job
        self.per_hour = int(job["steps_per_hour"])
        steps = HOURS * self.per_hour
        self.sums = np.zeros((len(job["outputs"]), steps))
        self.counts = np.zeros(steps)
        self.actuators: list[tuple[int, list[float]]] = []
        self.outputs: list[tuple[int, Any]] = []
        self.failure = ""

    def ask(self, state: Any) -> None:
        for output in self.job["outputs"]:
            if output["key"] is not None:
                self.data.request_variable(state, output["name"], output["key"])

    def _find(self, state: Any) -> None:
        for each in self.job["actuators"]:
            names = each["component"], each["control"], each["key"]
            handle = self.data.get_actuator_handle(state, *names)
            if handle < 0:
                raise LookupError(f"{each['component']} {each['key']!r}")
            self.actuators.append((handle, self._settings(state, each)))
        for output in self.job["outputs"]:
            name, key = output["name"], output["key"]
            meter = key is None
            handle = (
                self.data.get_meter_handle(state, name)
                if meter
                else self.data.get_variable_handle(state, name, key)
            )
            read = self.data.get_meter_value if meter else self.data.get_variable_value
            self.outputs.append((handle, read))

    def _settings(self, state: Any, actuator: Mapping[str, Any]) -> list[float]:
        # Numbers as given, or handles of the constructions with the given names
        if not actuator["constructions"]:
            return list(actuator["values"])
        names = actuator["constructions"]
        handles = [self.data.get_construction_handle(state, name) for name in names]
        for name, handle in zip(names, handles, strict=True):
            if handle <= 0:
                raise LookupError(f"construction {name!r}")
        return [handles[number] for number in actuator["values"]]

    def _step(self, state: Any) -> int:
        day = _DAYS[self.data.month(state) - 1] + self.data.day_of_month(state) - 1
        part = self.data.zone_time_step_number(state) - 1
        part = part * self.per_hour // int(self.data.num_time_steps_in_hour(state))
        return int((day * 24 + self.data.hour(state)) * self.per_hour + part)

    def begin(self, state: Any) -> None:
        """Set the actuators at the begin of a time step."""
        if self.failure or not self.data.api_data_fully_ready(state):
            return
        try:
            if not self.outputs:
                self._find(state)
        except LookupError as error:
            self.failure = f"EnergyPlus has no {error.args[0]}"
            return
        step = self._step(state)
        for handle, values in self.actuators:
            self.data.set_actuator_value(state, handle, values[step])

    def end(self, state: Any) -> None:
        """Add the outputs at the end of a time step."""
        if not self.outputs or self.data.warmup_flag(state):
            return
        step = self._step(state)
        self.counts[step] += 1
        for row, (handle, read) in enumerate(self.outputs):
            self.sums[row, step] += read(state, handle) if handle >= 0 else np.nan

    def values(self) -> Any:
        """Return sums or means of the outputs; NaN in steps without simulation."""
        means = np.array([not output["sum"] for output in self.job["outputs"]])
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(
                self.counts == 0,
                np.nan,
                self.sums / np.where(means[:, None], self.counts, 1),
            )


def _tell(percent: int) -> None:
    sys.stdout.write(f"{percent}\n")
    sys.stdout.flush()


def simulate(folder: Path) -> str:
    """Run the job of a folder, and return the reason of a failure, or nothing."""
    job = json.loads((folder / JOB_FILE).read_text("utf-8"))
    api = EnergyPlusAPI()
    state = api.state_manager.new_state()
    exchange = _Exchange(api, job)
    exchange.ask(state)
    runtime = api.runtime
    # A construction that is set after this point takes effect one time step later
    runtime.callback_begin_zone_timestep_before_init_heat_balance(state, exchange.begin)
    runtime.callback_end_zone_timestep_after_zone_reporting(state, exchange.end)
    runtime.callback_progress(state, _tell)
    runtime.set_console_output_status(state, print_output=False)
    words = ["-d", str(folder), "-w", job["weather"], str(folder / MODEL_FILE)]
    status = runtime.run_energyplus(state, words)
    if exchange.failure or status:
        return exchange.failure or f"EnergyPlus ended with status {status}"
    np.save(folder / VALUES_FILE, exchange.values(), allow_pickle=False)
    return ""


def convert(folder: Path) -> str:
    """Convert `in.idf` of a folder; the engine then lacks weather, and fails."""
    api = EnergyPlusAPI()
    state = api.state_manager.new_state()
    api.runtime.set_console_output_status(state, print_output=False)
    api.runtime.run_energyplus(state, ["-c", "-d", str(folder), str(folder / IDF_FILE)])
    return (
        "" if (folder / MODEL_FILE).is_file() else "EnergyPlus does not read the model"
    )


if __name__ == "__main__":
    function = convert if sys.argv[1] == CONVERT else simulate
    sys.exit(function(Path(sys.argv[-1])) or 0)
