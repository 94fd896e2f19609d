"""Illuminance through each window group in each of its shade states.

The matrix equation is a sum over window groups. From these parts, the illuminance with
any operation of the shades follows by addition, without tracing or matrix products.
"""

from collections.abc import Callable, Sequence

import h5netcdf  # type: ignore[import-untyped]
import numpy as np
import xarray as xr

from clerestory.files import replace_path
from clerestory.phases.hourly_file import hourly_variable
from clerestory.phases.matrix_equation import Skies, States
from clerestory.study.control_inputs import ControlInputs
from clerestory.study.study_matrices import StudyMatrices

BY_STATE = "illuminance_by_state"
_AXES = ("sensor", "window", "state_number", "time")
_UNITS = {"units": "lux"}

# Sensors whose illuminance is computed at a time, if memory suffices
_ROWS = 1024


def results_by_state(signals: ControlInputs) -> xr.Dataset:
    """Return `illuminance_by_state` [lux] of a study whose file requests it.

    The axes are (sensor, window, state_number, time); the values are NaN where a window
    group has fewer states. Values of large studies are in a file.
    """
    if not signals.study.output.by_state:
        return xr.Dataset()
    groups, matrices = signals.inputs.groups, signals.matrices
    counts = [len(group.states) for group in groups]
    sensors, steps = len(signals.inputs.sensors()), len(signals.times)
    shape = (sensors, len(counts), max(counts), steps)
    if matrices.folder is None:
        values = np.full(shape, np.nan, np.float32)
        _fill(values.__setitem__, matrices, signals.skies, counts, sensors)
        return xr.Dataset({BY_STATE: (_AXES, values, _UNITS)})
    path = matrices.folder / "by_state.nc"
    with replace_path(path) as made, h5netcdf.File(made, "w") as stored:
        stored.dimensions = dict(zip(_AXES, shape, strict=True))
        variable = hourly_variable(stored, BY_STATE, _AXES)
        variable.attrs.update(_UNITS)
        _fill(variable.__setitem__, matrices, signals.skies, counts, sensors)
    return xr.open_dataset(path, engine="h5netcdf", cache=False)


def every_state(counts: Sequence[int], steps: int) -> list[States]:
    """Return the operations with all window groups in their first, second … state.

    `counts` are the numbers of states; a group with fewer states is in its last one.

    >>> [[int(group[0]) for group in states] for states in every_state([1, 3], 2)]
    [[0, 0], [0, 1], [0, 2]]
    """
    return [
        [np.full(steps, min(state, count - 1)) for count in counts]
        for state in range(max(counts, default=0))
    ]


def operated_illuminance(by_state: xr.DataArray, states: States) -> np.ndarray:
    """Return the illuminance (sensor, time) [lux] with the given shade states.

    `states` are the index of the shade state at each time step, per window group.

    >>> parts = np.array([[[[100.0, 90.0], [10.0, 9.0]]]])  # one window, two states
    >>> parts = xr.DataArray(parts, dims=_AXES)
    >>> operated_illuminance(parts, [np.array([0, 1])]).tolist()
    [[100.0, 9.0]]
    """
    total = np.zeros((by_state.sizes["sensor"], by_state.sizes["time"]))
    for number, state in enumerate(states):
        part = by_state[:, number].values
        total += np.take_along_axis(part, state[None, None, :], axis=1)[:, 0]
    return total


def _fill(
    put: Callable[[tuple[slice, int, int], np.ndarray], None],
    matrices: StudyMatrices,
    skies: Skies,
    counts: list[int],
    sensors: int,
) -> None:
    # Blocks of sensors, as view matrices and hourly values may be in files
    most = min(_ROWS, matrices.most_sensors or _ROWS)
    for first in range(0, sensors, most):
        rows = np.arange(first, min(first + most, sensors))
        for group, count in enumerate(counts):
            part = matrices.reduced([group], rows)
            for state in range(count):
                always = [np.full(len(skies.times), state)]
                lux = part.illuminance(skies, always)["illuminance"].values
                put((slice(rows[0], rows[-1] + 1), group, state), lux)
