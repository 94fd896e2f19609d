"""Tracing of the matrices that a study asks for.

Matrices of an earlier run are found again. Each is traced once for all time steps,
whatever state of the shades acts when.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from clerestory import __version__
from clerestory.errors import InputError
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.facade_matrices import facade_daylight, facade_matrices
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    WindowMatrices,
    window_chain,
)
from clerestory.phases.methods import METHODS
from clerestory.phases.pooled import with_few_components
from clerestory.phases.stored_views import StoredColumns, store_views, stored_columns
from clerestory.phases.sun_coefficients import blackened, sun_coefficients
from clerestory.phases.traced_matrices import (
    daylight_coefficients,
    daylight_matrices,
    daylight_matrix,
    view_matrices,
)
from clerestory.scene.model import BsdfSurface, Plastic, Scene
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import SunMatrix, patch_suns, sun_matrix
from clerestory.sky.weather import Weather
from clerestory.study.config import Study
from clerestory.study.job import COEFFICIENTS, DIRECT, STATE, SUN, Job
from clerestory.study.memory_size import is_stored, most_sensors
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.window_groups import WindowGroup

# Random numbers of façade matrices and of the daylight matrices of their ports
FACADE, PORTS = 0x100000, 0x200000


def study_skies(study: Study, weather: Weather, suns: SunMatrix | None) -> Skies:
    """Return the skies that the method of a study multiplies."""
    make = partial(
        sky_matrix,
        weather,
        subdivision=study.sky.subdivision,
        ground_reflectance=study.sky.ground_reflectance,
        rotation_deg=study.sky.rotation_deg,
    )
    return Skies(make(), make(include="sun") if needs_direct(study) else None, suns)


def needs_direct(study: Study) -> bool:
    """Whether direct light is traced apart: direct correction, or LM-83's rule."""
    rules = [window.control.rule for window in study.window if window.control]
    return study.corrected or (METHODS[study.method].windows and "LM-83" in rules)


def study_suns(study: Study, weather: Weather) -> SunMatrix | None:
    """Return the suns of the direct correction; None for methods without it."""
    table, rotation = study.sun, study.sky.rotation_deg
    if not study.corrected:
        return None
    if table.places == "patches":
        return patch_suns(weather, rotation_deg=rotation)
    return sun_matrix(weather, tolerance_deg=table.tolerance_deg, rotation_deg=rotation)


def trace_study(job: Job) -> StudyMatrices:
    """Return the matrices of a study; those of an earlier run are not traced again.

    Raises
    ------
    InputError : a rule asks for light that the method does not know
    """
    study, direct = job.study, needs_direct(job.study)
    method, stored = METHODS[study.method], is_stored(study, job.inputs, direct=direct)
    rules = [window.control.rule for window in study.window if window.control]
    if "LM-83" in rules and not direct:
        raise InputError(
            f'rule "LM-83" by the {study.method} method with the sun in patches, which'
            " does not know direct light; the sun at its exact place expected"
        )
    suns = study_suns(study, job.inputs.weather)
    black = replace(job, inputs=replace(job.inputs, scene=blackened(job.scene)))
    make = partial(_window_chains, stored=stored) if method.windows else _coefficients
    whole = make(job, direct=False)
    none: list[MatrixChain | None] = [None] * len(whole)
    dark = make(black, direct=True) if direct else none
    sun = _suns(black, suns) if suns is not None else none
    windows = tuple(map(WindowMatrices, whole, dark, sun))
    terms = method.terms(corrected=study.corrected)
    if not stored:
        return StudyMatrices(terms, windows, suns)
    most = most_sensors(study, job.inputs, direct=direct)
    return StudyMatrices(terms, windows, suns, job.scratch, most)


def _window_chains(job: Job, *, direct: bool, stored: bool) -> list[MatrixChain]:
    # V, T and D, or F D; all views are traced at once, each daylight matrix on its own
    trace = _stored_views if stored else _views
    views: Sequence[TransferMatrix | StoredColumns] = trace(job, direct=direct)
    chains = []
    for number, (group, view) in enumerate(zip(job.inputs.groups, views, strict=True)):
        daylight = _daylight(job, group, number, direct=direct)
        if stored:
            daylight = [with_few_components(matrix) for matrix in daylight]
        T = [state.transmission for state in group.states]
        chains.append(window_chain(view, T, daylight * (len(T) // len(daylight))))
    return chains


def _prefix(direct: bool) -> str:
    return "direct-" if direct else ""


def _view_options(job: Job, *, direct: bool) -> dict[str, Any]:
    options = job.options(DIRECT * direct)
    if direct:
        options["bounces"] = 1  # the gather at the sensor itself
    return options


def _views(job: Job, *, direct: bool) -> list[TransferMatrix]:
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
    return [kept[name] for name in inner]


def _stored_views(job: Job, *, direct: bool) -> Sequence[StoredColumns]:
    sensors, options = job.inputs.sensors(), _view_options(job, direct=direct)
    windows = [group.inner for group in job.inputs.groups]
    views = store_views(
        job,
        job.scene,
        windows,
        name=f"{_prefix(direct)}views",
        key=fingerprint("views", job.scene_key, windows, sensors, options),
        sensors=sensors,
        executor=job.executor,
        progress=job.display(f"{_prefix(direct)}view matrices"),
        **options,
    )
    return stored_columns(views, windows)


def _daylight(
    job: Job, group: WindowGroup, number: int, *, direct: bool
) -> list[TransferMatrix]:
    # D, shared by all states, or F D of each of them
    options: dict[str, Any] = {"bounces": 0} if direct else {}
    if METHODS[job.study.method].facade and group.ports:
        D = _port_daylight(job, group, number, direct=direct)
        return [
            facade_daylight(_facade(job, group, number, at, direct=direct), D)
            for at in range(len(group.states))
        ]
    # Each window has a seed of its own, apart from that of the view matrices
    options = job.options(stream=1 + number + DIRECT * direct) | options
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

    return [job.matrix(name, key, make)]


def _port_daylight(
    job: Job, group: WindowGroup, number: int, *, direct: bool
) -> dict[str, TransferMatrix]:
    # D of each port, without the shade before the window
    options = job.options(stream=PORTS + STATE * number + DIRECT * direct)
    if direct:
        options["bounces"] = 0
    options["subdivision"] = job.study.sky.subdivision
    ports = {f"{_prefix(direct)}daylight-{group.name}-{p.name}": p for p in group.ports}
    key = fingerprint("ports", job.scene_key, list(ports.values()), options)

    def make() -> dict[str, TransferMatrix]:
        traced = daylight_matrices(
            job.scene,
            list(ports.values()),
            executor=job.executor,
            progress=job.display(
                f"{_prefix(direct)}daylight matrices of the ports of {group.name}"
            ),
            **options,
        )
        return {name: traced[port.name] for name, port in ports.items()}

    kept = job.matrices(list(ports), key, make)
    return {port.name: kept[name] for name, port in ports.items()}


def _facade(
    job: Job, group: WindowGroup, number: int, at: int, *, direct: bool
) -> dict[str, TransferMatrix]:
    # F of each port, through one state of the exterior shade
    state = group.states[at]
    options = job.options(stream=FACADE + number + STATE * at + DIRECT * direct)
    if direct:
        options["bounces"] = 0
    shade = blackened(state.shade) if direct else state.shade
    label = f"{_prefix(direct)}facade-{_label(group, at)}"
    ports = {f"{label}-{port.name}": port for port in group.ports}
    key = fingerprint(
        "facade", job.scene_key, shade, group.outer, list(ports.values()), options
    )

    def make() -> dict[str, TransferMatrix]:
        traced = facade_matrices(
            job.scene + shade,
            group.outer,
            list(ports.values()),
            executor=job.executor,
            progress=job.display(f"{_prefix(direct)}façade matrices of {label}"),
            **options,
        )
        return {name: traced[port.name] for name, port in ports.items()}

    kept = job.matrices(list(ports), key, make)
    return {port.name: kept[name] for name, port in ports.items()}


def _label(group: WindowGroup, at: int) -> str:
    return "-".join(filter(None, (group.name, group.states[at].name)))


def _suns(job: Job, suns: SunMatrix) -> list[MatrixChain]:
    # C_ds of each window in each of its states
    return [
        MatrixChain(
            tuple(_sun(job, group, number, at, suns) for at in range(len(group.states)))
        )
        for number, group in enumerate(job.inputs.groups)
    ]


def _sun(
    job: Job, group: WindowGroup, number: int, at: int, suns: SunMatrix
) -> TransferMatrix:
    chosen, sensors = group.states[at], job.inputs.sensors()
    windows = [each.inner for each in job.inputs.groups]
    scene, scene_key = job.scene, job.scene_key
    if METHODS[job.study.method].facade and chosen.shade.surfaces:
        scene = scene + blackened(chosen.shade)
        scene_key = fingerprint(__version__, scene)
    options: dict[str, Any] = {
        "samples": job.study.sun.samples,
        "peak": chosen.peak,
        "seed": job.seed(SUN + number + STATE * at),
        "device": job.device,
    }
    key = fingerprint(
        "sun", scene_key, windows, number, chosen.fine, sensors, suns.directions,
        options,
    )  # fmt: skip
    label = _label(group, at)

    def make() -> TransferMatrix:
        return sun_coefficients(
            scene,
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


def _coefficients(job: Job, *, direct: bool) -> list[MatrixChain]:
    # Two-phase method: light passes one window group at a time, a surface of its BSDF,
    # while the others are black; the sum over the groups is the room's. What the own
    # shade reflects back into the room is part of it, what the others' reflect is not
    groups = job.inputs.groups
    if not groups:
        matrix = _traced(job, job.scene, "coefficients", 0, direct=direct)
        return [MatrixChain((matrix,))]
    return [
        MatrixChain(
            tuple(
                _state_coefficients(job, number, at, direct=direct)
                for at in range(len(group.states))
            )
        )
        for number, group in enumerate(groups)
    ]


def _state_coefficients(
    job: Job, number: int, at: int, *, direct: bool
) -> TransferMatrix:
    # The scene with one window in one state, and the others black
    groups = job.inputs.groups
    chosen, state = groups[number], groups[number].states[at]
    up = chosen.inner.frame.up
    shade = BsdfSurface("window shade", state.fine, 0.0, up, peak=state.peak)
    black = Plastic("window black", np.zeros(3))
    surfaces = [
        replace(polygon, material=shade.name if each is chosen else black.name)
        for each in groups
        for polygon in each.inner.polygons
    ]
    panes = Scene({shade.name: shade, black.name: black}, tuple(surfaces))
    name = f"coefficients-{_label(chosen, at)}"
    stream = COEFFICIENTS + number + STATE * at
    return _traced(job, job.scene + panes, name, stream, direct=direct)


def _traced(
    job: Job, scene: Scene, name: str, stream: int, *, direct: bool
) -> TransferMatrix:
    sensors, options = job.inputs.sensors(), job.options(stream + DIRECT * direct)
    options["subdivision"] = job.study.sky.subdivision
    scene_key = job.scene_key if scene is job.scene else fingerprint(__version__, scene)
    key = fingerprint("coefficients", scene_key, sensors, options)
    name = _prefix(direct) + name

    def make() -> TransferMatrix:
        progress = job.display(name.replace("coefficients", "daylight coefficients"))
        return daylight_coefficients(
            scene,
            sensors=sensors,
            executor=job.executor,
            progress=progress,
            **options,
        )

    return job.matrix(name, key, make)
