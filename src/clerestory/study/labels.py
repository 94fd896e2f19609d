"""Results of a run as one xarray dataset."""

from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr
from jaxtyping import Bool

from clerestory.metrics.melanopic import melanopic_metrics
from clerestory.metrics.sensor_metrics import sensor_metrics
from clerestory.metrics.space import DIRECT
from clerestory.metrics.spatial_metrics import hours_above
from clerestory.spectral.band_errors import band_errors
from clerestory.spectral.band_sets import gives
from clerestory.study.control_inputs import ControlInputs
from clerestory.study.drawing import layer_drawing, room_drawing, window_drawing
from clerestory.study.inputs import Inputs
from clerestory.study.results import sensor_names
from clerestory.study.shade_operation import ShadeOperation
from clerestory.threads import computed_in_threads

# Sensors per block in the computation of metrics: replicates of 8760 hours of a block
# take 200 MB
_SENSORS = 512


def sensor_labels(inputs: Inputs) -> list[str]:
    """Names of all sensors of a study."""
    grids = inputs.grids.items()
    return [name for grid, s in grids for name in sensor_names(grid, len(s))]


def label_results(
    hourly: xr.Dataset,
    parts: Sequence[xr.Dataset],
    signals: ControlInputs,
    acts: ShadeOperation,
) -> xr.Dataset:
    """Return all results of a run as one dataset; see `Results`.

    The datasets `parts` contain results on electric lighting, glare and sunlight, and
    melanopic light.
    """
    study, inputs, hours = signals.study, signals.inputs, signals.occupied
    sensors = inputs.sensors()
    grids = np.repeat(list(inputs.grids), [len(s) for s in inputs.grids.values()])
    labelled = hourly.assign_coords(
        sensor=np.array(sensor_labels(inputs)),
        grid=("sensor", grids),
        position=(("sensor", "xyz"), sensors.position),
        direction=(("sensor", "xyz"), sensors.direction),
    )
    data = xr.merge(
        [
            labelled.assign(occupied=("time", hours)),
            _metrics(labelled, hours, target_lux=study.metrics.target_lux),
            room_drawing(inputs.scene),
            window_drawing([group.inner for group in inputs.groups]),
            layer_drawing(inputs.groups),
            _states(signals, acts),
            _direct_sun(hourly, signals, hours),
            *(part.drop_vars("sensor", errors="ignore") for part in parts),
        ],
        combine_attrs="drop_conflicts",
        join="outer",
        compat="no_conflicts",
    )
    return data.assign_attrs(
        title=study.title,
        method=study.method,
        place=inputs.weather.place,
        latitude_deg=inputs.weather.latitude_deg,
        longitude_deg=inputs.weather.longitude_deg,
        utc_offset_hours=inputs.weather.utc_offset_hours,
        step_minutes=inputs.weather.step_minutes,
        rotation_deg=study.sky.rotation_deg,
        study=study.to_json(),
        **_band_errors(inputs),
    )


def _band_errors(inputs: Inputs) -> dict[str, str]:
    # Error of the bands in words; nothing for RGB
    bands = inputs.scene.bands
    if not gives(bands, "melanopic"):
        return {}
    return {"band_errors": str(band_errors(bands, inputs.spectra))}


def melanopic_results(
    hourly: xr.Dataset, hours: Bool[np.ndarray, " time"], *, step_hours: float
) -> xr.Dataset:
    """Return hourly melanopic EDI, its standard error, and its metrics by sensor."""
    found = hourly[["illuminance", "standard_error"]].rename(
        illuminance="melanopic_edi", standard_error="melanopic_edi_error"
    )
    parts = [
        melanopic_metrics(hourly.isel(sensor=block), hours, step_hours=step_hours)
        for block in _blocks(hourly)
    ]
    return found.merge(_joined(parts)).assign_attrs(parts[0].attrs)


def melanopic_days_with(
    hourly: xr.Dataset,
    electric: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    step_hours: float,
) -> xr.Dataset:
    """Return the shares of days with daylight and electric light, as `total_…`."""
    total = hourly.assign(illuminance=hourly["illuminance"] + electric)
    days = [
        f"{name}{ending}"
        for name in ("melanopic_days", "low_melanopic_days")
        for ending in ("", "_error", "_components")
    ]
    found = melanopic_results(total, hours, step_hours=step_hours)[days]
    return found.rename({name: f"total_{name}" for name in days})


def _blocks(hourly: xr.Dataset) -> Iterator[slice]:
    # Blocks of sensors, as hourly results may be in a file
    for first in range(0, hourly.sizes["sensor"], _SENSORS):
        yield slice(first, first + _SENSORS)


def _metrics(
    hourly: xr.Dataset, hours: Bool[np.ndarray, " time"], *, target_lux: float
) -> xr.Dataset:
    def of_block(block: slice) -> xr.Dataset:
        return sensor_metrics(hourly.isel(sensor=block), hours, target_lux=target_lux)

    return _joined(list(computed_in_threads(of_block, _blocks(hourly))))


def _joined(parts: Sequence[xr.Dataset]) -> xr.Dataset:
    # Metrics of all sensors from those of blocks of sensors
    return xr.concat(
        parts,
        "sensor",
        data_vars="minimal",
        coords="minimal",
        compat="override",
        join="exact",
        combine_attrs="override",
    )


def _states(signals: ControlInputs, acts: ShadeOperation) -> xr.Dataset:
    # Shade states and control inputs; empty if each window has only one state
    groups = signals.inputs.groups
    if all(len(group.states) == 1 for group in groups):
        return xr.Dataset()
    most = max(len(group.states) for group in groups)
    names = [
        [state.name for state in group.states] + [""] * (most - len(group.states))
        for group in groups
    ]
    rules = [group.control.rule if group.control else "fixed" for group in groups]
    numbers = range(len(groups))
    axes = ("window", "time")
    found = xr.Dataset(
        {
            "state": (axes, np.stack(acts.states).astype(np.int8)),
            "state_name": (("window", "state_number"), np.array(names, dtype=str)),
            "control": ("window", np.array(rules, dtype=str)),
            "facade_irradiance": (
                axes,
                _single([signals.irradiance(n) for n in numbers]),
                {"units": "W/m2"},
            ),
            "profile_angle": (
                axes,
                _single([signals.profile(n) for n in numbers]),
                {"units": "rad"},
            ),
        },
        coords={"time": signals.times},
    )
    if acts.kept is not None:
        found["rule_kept"] = ("time", acts.kept)
    return found


def _direct_sun(
    hourly: xr.Dataset, signals: ControlInputs, hours: Bool[np.ndarray, " time"]
) -> xr.Dataset:
    # Direct sun illuminance with all shades in state 0, if direct light was traced and
    # it is not among the hourly results
    matrices, name = signals.matrices, DIRECT["illuminance"]
    if not matrices.has_direct:
        return xr.Dataset()
    found, data = xr.Dataset(), hourly
    if name not in hourly:
        steps = len(signals.times)
        opened = [np.zeros(steps, dtype=np.int64) for _ in signals.inputs.groups]
        data = matrices.direct_illuminance(signals.skies, opened).rename(DIRECT)
        found = data.drop_vars(["sensor", "time"]).drop_attrs(deep=False)
        found = found.assign_coords(time=signals.times)
    if matrices.suns is None:
        return found  # ASE needs the sun at its true position
    step_hours = signals.step_minutes / 60
    sun = [
        hours_above(data[name].isel(sensor=block), hours, step_hours=step_hours)
        for block in _blocks(data)
    ]
    found["sun_hours"] = xr.concat(sun, "sensor").variable
    return found


def _single(rows: Sequence[np.ndarray]) -> np.ndarray:
    return np.stack(rows).astype(np.float32)
