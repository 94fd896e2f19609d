"""Calibration of a study to measurements: expansion, fit, and checks by days.

The expansion is made again at the fitted values, until they change little. The
agreement on a day that was not used for the fit tells whether the calibration holds.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.comparison.calibration_model import CalibrationModel, calibration_model
from clerestory.comparison.mapping import read_measured_series
from clerestory.comparison.series import Series
from clerestory.comparison.series_comparison import Rules, matched_series
from clerestory.metrics.agreement import Agreement, agreement
from clerestory.phases.matrix_store import MatrixStore
from clerestory.progress import silent
from clerestory.scene.material_parameters import with_parameters
from clerestory.study.config import Study
from clerestory.study.illuminance_expansion import illuminance_expansion
from clerestory.study.inputs import Inputs, read_inputs
from clerestory.study.job import Display, Job
from clerestory.study.labels import sensor_labels
from clerestory.study.operated_study import operated
from clerestory.study.study_run import MATRIX_FOLDER
from clerestory.study.unknown_quantities import UnknownQuantities, unknown_quantities
from clerestory.uncertainty.calibration import calibrate, prediction_deviations, profile
from clerestory.uncertainty.posterior import Calibration

# Largest number of expansions, and change of a value in standard deviations of its
# posterior below which no further expansion is made
_ROUNDS, _CHANGE = 4, 0.2

# Half width of the range of 95 % in standard deviations
_RANGE = 1.96


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Agreement on one day, before and after a fit to all other days.

    Attributes
    ----------
    within : share of the measured values within the 95 % range of their predictions
    """

    day: np.datetime64
    count: int
    before: Agreement
    after: Agreement
    within: float


@dataclass(frozen=True, eq=False)
class CalibratedStudy:
    """Result of a calibration.

    Attributes
    ----------
    calibration : values and posterior of the quantities
    quantities : the quantities, with their values in the study
    model : measured values as a function of the quantities, near the fitted values
    before, after : simulated values of the pairs with the values of the study, and
        with the fitted values [lux]
    held_out : agreement on each day; empty for one day
    profiles : values and loss of each quantity
    rounds : number of expansions
    """

    calibration: Calibration
    quantities: UnknownQuantities
    model: CalibrationModel
    before: Float[np.ndarray, " pair"]
    after: Float[np.ndarray, " pair"]
    held_out: tuple[HeldOut, ...]
    profiles: tuple[tuple[np.ndarray, np.ndarray], ...]
    rounds: int

    __repr__ = brief

    @property
    def values(self) -> dict[str, float]:
        """Fitted value of each quantity."""
        names = [unknown.name for unknown in self.quantities.unknowns]
        return dict(zip(names, self.calibration.values.tolist(), strict=True))

    def agreements(self) -> tuple[Agreement, Agreement]:
        """Return the agreement before and after the calibration."""
        measured = self.model.measured
        return agreement(measured, self.before), agreement(measured, self.after)


def calibrate_study(
    study: Study,
    measured: str | Path,
    *,
    out: str | Path,
    rules: Rules | None = None,
    display: Display | None = None,
) -> CalibratedStudy:
    """Return the unknown quantities of a study with which it agrees best with data.

    Parameters
    ----------
    study : study with a table [uncertainty], whose distributions are the priors
    measured : mapping file, or CSV file of times and sensors
    out : folder for `matrices/`
    rules : selection of measured values, as in a comparison
    display : function that starts a progress display, as for `run_study`

    Raises
    ------
    InputError : no quantity, or no measured value at the simulated times and sensors
    """
    table = study.uncertainty
    require(
        table is not None, "the study has no unknown quantity; [uncertainty] expected"
    )
    assert table is not None
    rules, display = rules or Rules(), display or silent
    inputs = read_inputs(study)
    quantities = unknown_quantities(study, inputs, table.unknown, measured=True)
    series = read_measured_series(measured, near=_empty(inputs))
    inputs = _near_measurements(inputs, series)
    store = MatrixStore(Path(out) / MATRIX_FOLDER)
    job = Job(study, inputs, store, display)
    report = display("calibration")
    model = _model(job, quantities, series, rules)
    start = np.array([unknown.reference for unknown in quantities.unknowns])
    before, rounds = model.predict(start), 1
    found = _fit(model)
    values = found.values
    for number in range(1, _ROUNDS if quantities.materials else 1):
        report(number / _ROUNDS, f"expansion {number + 1}")
        model = _model(job, quantities, series, rules, near=_named(quantities, values))
        found, rounds = _fit(model), number + 1
        change = np.abs(found.values - values) / np.maximum(found.deviations, 1e-12)
        values = found.values
        if change.max() < _CHANGE:
            break
    profiles = tuple(
        profile(model.predict, model.measured, found, number)
        for number in range(len(found.unknowns))
    )
    held_out = tuple(_held_out(model, before))
    report(1.0, "done")
    after = model.predict(found.values)
    return CalibratedStudy(
        found, quantities, model, before, after, held_out, profiles, rounds
    )


def _fit(model: CalibrationModel) -> Calibration:
    return calibrate(
        model.predict,
        model.measured,
        model.unknowns,
        clusters=model.clusters(),
        common=model.common,
    )


def _held_out(model: CalibrationModel, before: np.ndarray) -> list[HeldOut]:
    # Fit to all days but one, and agreement on that day
    days = model.days
    count = int(days.max()) + 1
    found = []
    for day in range(count) if count > 1 else ():
        out = days == day
        fitted = _fit(model.of(~out))
        told = model.of(out)
        after, measured = told.predict(fitted.values), told.measured
        deviation = prediction_deviations(told.predict, fitted, told.common)
        date = model.pairs.times[out][0].astype("datetime64[D]")
        found.append(
            HeldOut(
                date,
                int(out.sum()),
                agreement(measured, before[out]),
                agreement(measured, after),
                float(np.mean(np.abs(measured - after) < _RANGE * deviation)),
            )
        )
    return found


def _named(quantities: UnknownQuantities, values: np.ndarray) -> dict[str, float]:
    names = [unknown.name for unknown in quantities.unknowns]
    return dict(zip(names, values.tolist(), strict=True))


def _model(
    job: Job,
    quantities: UnknownQuantities,
    series: Sequence[Series],
    rules: Rules,
    *,
    near: Mapping[str, float] | None = None,
) -> CalibrationModel:
    # The model of the measurements, expanded at the values of the study or near others
    if near is not None and quantities.materials:
        scene = with_parameters(job.scene, quantities.of_materials(dict(near)))
        job = replace(job, inputs=replace(job.inputs, scene=scene))
        quantities = replace(
            quantities,
            unknowns=tuple(
                replace(own, reference=near[own.name])
                if own.name in quantities.materials
                else own
                for own in quantities.unknowns
            ),
        )
    situation = operated(job)
    steps = np.arange(len(job.inputs.weather.times))
    expansion = illuminance_expansion(job, quantities, [situation], steps)
    simulated = _simulated(job.inputs, expansion.scenarios[0][0].value)
    return calibration_model(
        series,
        simulated,
        expansion,
        quantities,
        rules=rules,
        components=situation.error_components(),
    )


def _simulated(inputs: Inputs, values: np.ndarray) -> Series:
    weather = inputs.weather
    return Series(
        tuple(sensor_labels(inputs)),
        weather.times.astype("datetime64[s]"),
        values.astype(float),
        weather.step_minutes,
        weather.utc_offset_hours,
        position=inputs.sensors().position,
    )


def _empty(inputs: Inputs) -> Series:
    count = len(inputs.sensors())
    return _simulated(inputs, np.zeros((count, len(inputs.weather.times))))


def _near_measurements(inputs: Inputs, series: Sequence[Series]) -> Inputs:
    # Time steps of the days of the measurements, and of the days beside them
    weather = inputs.weather
    moved, _ = matched_series(series, _empty(inputs))
    days = [own.times.astype("datetime64[D]") for own in moved]
    known = np.unique(
        np.concatenate([*days, *(d + 1 for d in days), *(d - 1 for d in days)])
    )
    kept = np.isin(weather.times.astype("datetime64[D]"), known)
    first, last = weather.times[0], weather.times[-1]
    require(
        kept.any(),
        f"no measurement on a simulated day; times from {first} to {last} expected",
    )
    return replace(inputs, weather=weather.select(kept))
