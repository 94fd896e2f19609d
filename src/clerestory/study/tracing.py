"""Trace what the sensors of a study need, or find it again from an earlier run.

Nothing here depends on which state of a shade acts when: every matrix is traced once,
and rules choose among what is known.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from clerestory.errors import InputError
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.pooled import with_few_components
from clerestory.phases.shaded import ShadedWindow
from clerestory.phases.stored_views import StoredViews, store_views
from clerestory.phases.streamed import Opening
from clerestory.phases.sun import blackened, sun_coefficients
from clerestory.phases.trace import daylight_matrix, view_matrices
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import SunMatrix, patch_suns, sun_matrix
from clerestory.sky.weather import Weather
from clerestory.study.coefficients import trace_coefficients
from clerestory.study.config import Study
from clerestory.study.job import DIRECT, STATE, SUN, Job
from clerestory.study.memory_size import is_stored, most_sensors
from clerestory.study.stored import StoredTracing, Traced
from clerestory.study.traced import Skies, Tracing
from clerestory.study.window_groups import WindowGroup


def study_skies(study: Study, weather: Weather) -> Skies:
    """Return the skies that the method of a study asks for."""
    make = partial(
        sky_matrix,
        weather,
        subdivision=study.sky.subdivision,
        ground_reflectance=study.sky.ground_reflectance,
        rotation_deg=study.sky.rotation_deg,
    )
    return Skies(make(), make(include="sun") if needs_direct(study) else None)


def needs_direct(study: Study) -> bool:
    """Whether direct light is traced apart: five-phase method, or LM-83's rule."""
    rules = [window.control.rule for window in study.window if window.control]
    return study.method == "5-phase" or (study.method == "3-phase" and "LM-83" in rules)


def trace_study(job: Job) -> Traced:
    """Return the matrices of a study; those of an earlier run are not traced again.

    Raises
    ------
    InputError : a rule asks for what the method does not know
    """
    study, direct = job.study, needs_direct(job.study)
    stored = is_stored(study, job.inputs, direct=direct)
    if study.method == "2-phase":
        if any(w.control and w.control.rule == "LM-83" for w in study.window):
            raise InputError(
                'rule "LM-83" by the two-phase method, which does not know direct'
                " light; the three- or five-phase method expected"
            )
        return Tracing(coefficients=trace_coefficients(job))
    if stored:
        return _stored(job, direct=direct)
    whole = _windows(job, direct=False)
    if not direct:
        return Tracing(whole=whole)
    black = _blackened(job)
    dark = _windows(black, direct=True)
    if study.method != "5-phase":
        return Tracing(whole=whole, direct=dark)
    suns = study_suns(study, job.inputs.weather)
    sun = tuple(
        tuple(_sun(black, group, number, state, suns) for state in range(count))
        for number, group in enumerate(job.inputs.groups)
        for count in (len(group.states),)
    )
    return Tracing(whole=whole, direct=dark, sun=sun, suns=suns)


def study_suns(study: Study, weather: Weather) -> SunMatrix:
    """Return the suns of the five-phase method."""
    table, rotation = study.sun, study.sky.rotation_deg
    if table.places == "patches":
        return patch_suns(weather, rotation_deg=rotation)
    return sun_matrix(weather, tolerance_deg=table.tolerance_deg, rotation_deg=rotation)


def _blackened(job: Job) -> Job:
    # What the five-phase method takes away and puts back is traced in the dark
    inputs = replace(job.inputs, scene=blackened(job.scene))
    return replace(job, inputs=inputs)


def _windows(job: Job, *, direct: bool) -> tuple[ShadedWindow, ...]:
    # All views are traced at once, each daylight matrix on its own
    views = _views(job, direct=direct)
    return tuple(
        ShadedWindow(
            views[group.name],
            tuple(state.transmission for state in group.states),
            _daylight(job, group, number, direct=direct),
        )
        for number, group in enumerate(job.inputs.groups)
    )


def _stored(job: Job, *, direct: bool) -> StoredTracing:
    # The same matrices, views in files
    views = _stored_views(job, direct=False)
    whole = _openings(job, direct=False)
    most = most_sensors(job.study, job.inputs, direct=direct)
    if not direct:
        return StoredTracing(job.scratch, most, views, whole)
    black = _blackened(job)
    return StoredTracing(
        job.scratch,
        most,
        views,
        whole,
        _stored_views(black, direct=True),
        _openings(black, direct=True),
    )


def _openings(job: Job, *, direct: bool) -> tuple[Opening, ...]:
    return tuple(
        Opening(
            tuple(state.transmission for state in group.states),
            with_few_components(_daylight(job, group, number, direct=direct)),
        )
        for number, group in enumerate(job.inputs.groups)
    )


def _prefix(direct: bool) -> str:
    return "direct-" if direct else ""


def _sun(
    job: Job, group: WindowGroup, number: int, state: int, suns: SunMatrix
) -> TransferMatrix:
    chosen, sensors = group.states[state], job.inputs.sensors()
    windows = [each.inner for each in job.inputs.groups]
    options: dict[str, Any] = {
        "samples": job.study.sun.samples,
        "peak": chosen.peak,
        "seed": job.seed(SUN + number + STATE * state),
        "device": job.device,
    }
    key = fingerprint(
        "sun", job.scene_key, windows, number, chosen.fine, sensors, suns.directions,
        options,
    )  # fmt: skip
    label = f"{group.name}-{chosen.name}" if chosen.name else group.name

    def make() -> TransferMatrix:
        return sun_coefficients(
            job.scene,
            windows,
            group.name,
            chosen.fine,
            sensors=sensors,
            suns=suns.directions,
            executor=job.executor,
            progress=job.display(f"direct sun through {label}"),
            **options,
        )

    return job.matrix(f"sun-{label}", key, make)


def _view_options(job: Job, *, direct: bool) -> dict[str, Any]:
    options = job.options(DIRECT * direct)
    if direct:
        options["bounces"] = 1  # the gather at the sensor itself
    return options


def _views(job: Job, *, direct: bool) -> dict[str, TransferMatrix]:
    sensors, options = job.inputs.sensors(), _view_options(job, direct=direct)
    groups: Sequence[WindowGroup] = job.inputs.groups
    inner = {f"{_prefix(direct)}view-{group.name}": group.inner for group in groups}
    key = fingerprint("view", job.scene_key, list(inner.values()), sensors, options)

    def make() -> dict[str, TransferMatrix]:
        traced = view_matrices(
            job.scene,
            list(inner.values()),
            sensors=sensors,
            executor=job.executor,
            progress=job.display(f"{_prefix(direct)}view matrices"),
            **options,
        )
        return {name: traced[window.name] for name, window in inner.items()}

    kept = job.matrices(list(inner), key, make)
    return {window.name: kept[name] for name, window in inner.items()}


def _stored_views(job: Job, *, direct: bool) -> StoredViews:
    sensors, options = job.inputs.sensors(), _view_options(job, direct=direct)
    windows = [group.inner for group in job.inputs.groups]
    name = f"{_prefix(direct)}views"
    return store_views(
        job,
        job.scene,
        windows,
        name=name,
        key=fingerprint("views", job.scene_key, windows, sensors, options),
        sensors=sensors,
        executor=job.executor,
        progress=job.display(f"{_prefix(direct)}view matrices"),
        **options,
    )


def _daylight(
    job: Job, group: WindowGroup, number: int, *, direct: bool
) -> TransferMatrix:
    # Each window has a seed of its own, apart from that of the view matrices
    options = job.options(stream=1 + number + DIRECT * direct)
    if direct:
        options["bounces"] = 0
    options["subdivision"] = job.study.sky.subdivision
    key = fingerprint("daylight", job.scene_key, group.outer, options)
    name = f"{_prefix(direct)}daylight-{group.name}"

    def make() -> TransferMatrix:
        progress = job.display(f"{_prefix(direct)}daylight matrix of {group.name}")
        return daylight_matrix(
            job.scene,
            group.outer,
            executor=job.executor,
            progress=progress,
            **options,
        )

    return job.matrix(name, key, make)
