"""Run of a study with one phase method, from input files to results.

A restarted run gives bitwise identical results: each traced matrix is stored as soon
as it is complete, everything else is computed again, and results.nc is written last.
"""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from clerestory.engine.work_units import Executor
from clerestory.files import make_folder
from clerestory.metrics.compliance import assess
from clerestory.metrics.standards import standards_named
from clerestory.phases.matrix_equation import Skies, States
from clerestory.phases.matrix_store import Store
from clerestory.phases.recent_values import RecentValues
from clerestory.progress import silent
from clerestory.spectral.band_sets import gives
from clerestory.study.annual_view_grids import Hours, study_view_grids
from clerestory.study.annual_views import (
    PICTURE_FOLDER,
    glare_function,
    study_views,
)
from clerestory.study.compliance_inputs import compliance_inputs
from clerestory.study.compliance_table import compliance_table
from clerestory.study.config import Study
from clerestory.study.control_inputs import ControlInputs
from clerestory.study.electric_lighting import lighting
from clerestory.study.energy_model import EnergyModel, energy_model
from clerestory.study.energy_simulation import annual_energy
from clerestory.study.glazed_grid_points import grid_points
from clerestory.study.illuminance_by_state import every_state, results_by_state
from clerestory.study.input_checks import warn_of_inputs
from clerestory.study.input_files import content_hashes
from clerestory.study.inputs import read_inputs
from clerestory.study.job import Display, Job
from clerestory.study.labels import (
    label_results,
    melanopic_days_with,
    melanopic_results,
)
from clerestory.study.light_spectra import light_spectra
from clerestory.study.luminaire_matrices import trace_lamps
from clerestory.study.outputs import write_tables
from clerestory.study.results import Results, read_results, save_results
from clerestory.study.run_facts import run_facts
from clerestory.study.run_log import RunLog
from clerestory.study.sensitivity_results import sensitivity_results
from clerestory.study.shade_operation import ShadeOperation, operate
from clerestory.study.study_matrices import HOURLY_FILE, StudyMatrices
from clerestory.study.study_skies import study_skies
from clerestory.study.study_tracing import trace_study
from clerestory.study.total_uncertainty import total_uncertainty
from clerestory.study.unknown_quantities import unknown_quantities
from clerestory.study.view_grid_pictures import write_worst_pictures
from clerestory.study.view_grid_points import (
    Positions,
    grid_glare_function,
    trace_positions,
)
from clerestory.study.view_matrices import trace_views
from clerestory.warning_log import WarningLog

# Temporary folder for hourly values that do not fit into memory
SCRATCH_FOLDER = "unfinished"


def run_method(
    study: Study,
    *,
    out: Path,
    store: Store,
    display: Display,
    executor: Executor,
    states: States | None = None,
    warning_log: WarningLog | None = None,
    recent: RecentValues | None = None,
) -> Results:
    """Run a study with its first method and write the results into a folder.

    Without `states`, the control rules of the study choose the shade states.
    `warning_log` is shared by the runs with all methods, `recent` by all variants.
    """
    log = RunLog(warnings=warning_log or WarningLog())
    recent = recent or RecentValues()
    with log.phase("read"):
        inputs = read_inputs(study, recent=recent)
        model, files = energy_model(study, inputs), content_hashes(study)
        if study.uncertainty is not None:
            # Refuse wrong quantities before anything is traced
            unknown_quantities(study, inputs, study.uncertainty.unknown)
        title_block = study.report.title_block()
    with log.phase("check"):
        warn_of_inputs(study, inputs, recent=recent)
    with _scratch_folder(out) as scratch:
        job = Job(
            study,
            inputs,
            store,
            display,
            executor=executor,
            scratch=scratch,
            recent=recent,
        )
        data = _simulate(job, log, states, model, out=out)
        if model is not None:
            with log.phase("energy"):
                data = data.merge(annual_energy(job, model, data))
        with log.phase("write"):
            write_tables(study, Results(data), out)
        facts = run_facts(job, files, data, log)
        if title_block:
            facts["report"] = title_block.facts()
        results, hourly = Results(data, facts), scratch / HOURLY_FILE
        in_files = any(scratch.iterdir())
        save_results(results, out, hourly=hourly if hourly.exists() else None)
        if in_files:
            # Read hourly values from results.nc, as the scratch folder is deleted
            data.close()
            results = read_results(out)
    return results


def _simulate(
    job: Job,
    log: RunLog,
    states: States | None,
    model: EnergyModel | None,
    *,
    out: Path,
) -> xr.Dataset:
    study, inputs, display = job.study, job.inputs, job.display
    with log.phase("trace"):
        matrices = trace_study(job)
        views = trace_views(job, matrices)
        lamps = trace_lamps(job)
    with log.phase("sky"):
        skies = study_skies(study, inputs, matrices.suns, recent=job.recent)
    points = grid_points(replace(job, display=silent), matrices, skies)
    with log.phase("view grids"):
        trace_positions(points, display)
    with log.phase("control"):
        largest_dgp = (
            glare_function(views, skies, display=display),
            grid_glare_function(points, display=display),
        )
        signals = ControlInputs(
            study, inputs, matrices, skies, *largest_dgp, job, lamps, model
        )
        acts = operate(signals) if states is None else ShadeOperation(list(states))
    with log.phase("multiply"):
        hourly = matrices.illuminance(
            skies, acts.states, progress=display("multiply"), sun_apart=True
        )
        electric = lighting(
            lamps,
            hourly,
            rows=[inputs.rows(zone.table.grid) for zone in lamps.zones],
            occupied=signals.occupied,
            step_hours=signals.step_minutes / 60,
        )
    by_state = study.output.by_state
    counts = [len(group.states) for group in inputs.groups]
    with log.phase("pictures"):
        glare = study_views(
            views,
            skies,
            acts.states,
            lamps=lamps,
            output=_output(electric, skies),
            every_state=every_state(counts, len(signals.times)) if by_state else (),
            out=out,
            display=display,
        )
    with log.phase("view grids"):
        grids = _view_grids(points, signals, acts.states, out=out, display=display)
    with log.phase("metrics"):
        parts = [electric, glare, grids, compliance_inputs(study, inputs, matrices)]
        parts += _melanopic(matrices, signals, acts.states, electric)
        parts.append(sensitivity_results(signals, acts.states, hourly))
        lux = hourly["illuminance"]
        parts.append(light_spectra(signals, acts.states, lux, electric))
        parts.append(results_by_state(signals))
        if signals.building is not None:
            parts.append(signals.building.results())
        data = label_results(hourly, parts, signals, acts)
    with log.phase("compliance"):
        if study.compliance is not None:
            standards = standards_named(study.compliance.standards)
            data = data.merge(compliance_table(assess(data, standards)))
    with log.phase("uncertainty"):
        return data.merge(total_uncertainty(job, signals, acts.states, data))


def _melanopic(
    matrices: StudyMatrices,
    signals: ControlInputs,
    states: States,
    electric: xr.Dataset,
) -> list[xr.Dataset]:
    # Melanopic light of the sky and the sun, if the bands give it, and days with that
    # of luminaires added
    if not gives(signals.skies.whole.bands, "melanopic"):
        return []
    hourly = matrices.melanopic_edi(signals.skies, states)
    hours = signals.step_minutes / 60
    found = [melanopic_results(hourly, signals.occupied, step_hours=hours)]
    if "electric_melanopic_edi" in electric:
        added = electric["electric_melanopic_edi"]
        found.append(
            melanopic_days_with(hourly, added, signals.occupied, step_hours=hours)
        )
    return found


def _view_grids(
    points: Positions,
    signals: ControlInputs,
    states: States,
    *,
    out: Path,
    display: Display,
) -> xr.Dataset:
    # Annual glare of the view grids, and pictures of their worst moments
    job, skies = points.job, signals.skies
    if not job.inputs.view_grids:
        return xr.Dataset()
    counts = [len(group.states) for group in job.inputs.groups]
    found = study_view_grids(
        job.inputs.view_grids,
        points.glare,
        states,
        every_state=every_state(counts, len(signals.times)),
        hours=Hours(
            signals.times,
            np.flatnonzero(skies.whole.diffuse.max(axis=0) > 0),
            signals.occupied,
        ),
        folder=job.scratch,
        display=display,
    )
    if job.inputs.groups:
        write_worst_pictures(
            job,
            signals.matrices,
            skies,
            states,
            found=found,
            folder=out / PICTURE_FOLDER,
        )
    return found


@contextmanager
def _scratch_folder(out: Path) -> Iterator[Path]:
    # Empty folder, without files of an interrupted run; deleted at the end
    folder = out / SCRATCH_FOLDER
    shutil.rmtree(folder, ignore_errors=True)
    try:
        yield make_folder(folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _output(electric: xr.Dataset, skies: Skies) -> np.ndarray:
    # Dimming level 0…1 of each lighting zone at each time step
    if "dimming" not in electric:
        return np.zeros((0, len(skies.whole.times)))
    return np.asarray(electric["dimming"].values)
