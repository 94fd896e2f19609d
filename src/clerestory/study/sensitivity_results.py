"""Changes of the metrics of a study for other reflectances of its materials."""

import xarray as xr

from clerestory.metrics.metric_changes import metric_changes
from clerestory.phases.matrix_equation import States
from clerestory.study.control_inputs import ControlInputs
from clerestory.study.glare_sensitivity import glare_sensitivity


def sensitivity_results(
    signals: ControlInputs, states: States, hourly: xr.Dataset
) -> xr.Dataset:
    """Return the changes of the metrics; empty if the study does not ask for them.

    `hourly` has the illuminance in the shade states `states`, with its errors.
    """
    study, matrices = signals.study, signals.matrices
    if study.sensitivity is None:
        return xr.Dataset()
    grids = signals.inputs.grids.items()
    derivatives = matrices.illuminance_derivatives(signals.skies, states, second="own")
    light = metric_changes(
        hourly,
        derivatives,
        signals.occupied,
        [name for name, sensors in grids for _ in range(len(sensors))],
        step=study.sensitivity.step,
        target_lux=study.metrics.target_lux,
    )
    return light.merge(glare_sensitivity(signals, states))
