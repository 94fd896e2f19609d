"""Tracing of the matrices of a study.

Matrices are read from the cache or traced. Each matrix is traced once for all time
steps, independently of the shade operation.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from clerestory.engine.effort import Effort
from clerestory.errors import InputError
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import blackened
from clerestory.phases.facade_matrices import facade_daylight, facade_matrices
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.matrix_equation import (
    MatrixChain,
    WindowMatrices,
    window_chain,
)
from clerestory.phases.methods import METHODS
from clerestory.phases.stored_views import (
    StoredColumns,
    store_views,
    stored_columns,
    with_few_components,
)
from clerestory.phases.traced_matrices import (
    daylight_matrices,
    daylight_matrix,
    view_matrices,
)
from clerestory.sky.sky_conditions import Spectrum
from clerestory.study.differentiated_materials import checked_materials
from clerestory.study.job import STATE, Job
from clerestory.study.memory_size import is_stored, most_sensors
from clerestory.study.study_coefficients import (
    coefficients,
    direct_suns,
    stored_coefficients,
)
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.study_skies import needs_direct, study_suns
from clerestory.study.window_groups import WindowGroup, state_label

# Offsets added to the random seed for façade matrices and for D of ports
FACADE, PORTS = 0x100000, 0x200000


def trace_study(job: Job, *, spectrum: Spectrum = "visible") -> StudyMatrices:
    """Return the sensor matrices of a study, from the cache if possible.

    `spectrum` is that of the irradiance of the suns.
    """
    study, direct = job.study, needs_direct(job.study)
    method, stored = METHODS[study.method], is_stored(study, job.inputs, direct=direct)
    rules = [window.control.rule for window in study.window if window.control]
    if "LM-83" in rules and not direct:
        raise InputError(
            f'rule "LM-83" with the {study.method} method requires direct light;'
            ' [sun] places = "exact" expected'
        )
    job = replace(job, derivatives=checked_materials(study, job.scene, stored=stored))
    weather = job.inputs.weather
    tables = study.sun.model_dump(), study.sky.model_dump(), study.scene.bands
    suns = job.recent.value(
        ("suns", study.corrected, fingerprint(tables), spectrum),
        lambda: study_suns(study, weather, spectrum=spectrum),
        of=(weather,),
    )
    black = job
    if job.inputs.groups:
        # Direct light is scattered by windows only: all other surfaces are black
        black = replace(job, inputs=replace(job.inputs, scene=blackened(job.scene)))
    if method.windows:
        windows = _windows(job, black, direct=direct, stored=stored)
    elif stored:
        windows = [stored_coefficients(job, suns, direct=direct)]
    else:
        windows = coefficients(job, direct=direct)
    if suns is not None and not stored:
        sunlit = zip(windows, direct_suns(black, suns), strict=True)
        windows = [replace(window, sun=sun) for window, sun in sunlit]
    if not stored:
        return StudyMatrices(study.terms, tuple(windows), suns, recent=job.recent)
    most = most_sensors(study, job.inputs, direct=direct)
    return StudyMatrices(
        study.terms, tuple(windows), suns, job.scratch, most, recent=job.recent
    )


def differentiated_matrices(job: Job, names: Sequence[str]) -> list[WindowMatrices]:
    """Return the matrices of all light, with derivatives by materials of the scene.

    View matrices are in memory. The direct light of a method has no derivatives by
    reflectances: it is scattered by windows only.

    Raises
    ------
    InputError : no such material, or derivatives that do not fit into memory
    """
    job = replace(job, derivatives=tuple(names))
    if not METHODS[job.study.method].windows:
        return coefficients(job, direct=False)
    return [WindowMatrices(chain) for chain in _window_chains(job, stored=False)]


def _windows(
    job: Job, black: Job, *, direct: bool, stored: bool
) -> list[WindowMatrices]:
    # V, T and D of each window, and V_d, T and D_d of the black scene
    whole = _window_chains(job, stored=stored)
    dark: Sequence[MatrixChain | None] = [None] * len(whole)
    if direct:
        dark = _window_chains(replace(black, direct=True), stored=stored)
    return list(map(WindowMatrices, whole, dark))


def _window_chains(job: Job, *, stored: bool) -> list[MatrixChain]:
    # V, T and D (or F D) of each window; V is traced for all windows together
    views: Sequence[TransferMatrix | StoredColumns] = _views(job, stored=stored)
    chains = []
    for number, (group, view) in enumerate(zip(job.inputs.groups, views, strict=True)):
        daylight = window_daylight(job, group, number)
        if stored:
            daylight = [with_few_components(matrix) for matrix in daylight]
        T = [state.transmission for state in group.states]
        chains.append(window_chain(view, T, daylight * (len(T) // len(daylight))))
    return chains


def _views(job: Job, *, stored: bool) -> Sequence[TransferMatrix | StoredColumns]:
    sensors, effort = job.inputs.sensors(), job.effort()
    windows = [group.inner for group in job.inputs.groups]
    if job.direct:
        # The path from the sensor to the window counts as one bounce
        effort = replace(effort, bounces=1)
    if not stored:
        trace = partial(
            view_matrices, job.scene, windows, sensors=sensors, **job.differentiated
        )
        found = job.matrices("view", windows, trace, effort, shown="view matrices")
        return list(found.values())
    key = fingerprint("views", job.scene_key, windows, sensors, effort)
    views = store_views(
        partial(job.blocks, f"{job.prefix}views", key),
        job.scene,
        windows,
        sensors=sensors,
        effort=effort,
        progress=job.display(f"{job.prefix}view matrices"),
    )
    return stored_columns(views, windows)


def window_daylight(job: Job, group: WindowGroup, number: int) -> list[TransferMatrix]:
    """Return D, common to all shade states, or F D of each shade state."""
    if METHODS[job.study.method].facade and group.ports:
        D = _port_daylight(job, group, number)
        states = range(len(group.states))
        return [facade_daylight(_facade(job, group, number, at), D) for at in states]
    # The random seed differs between windows, and from the seed of view matrices
    subdivision = job.study.sky.subdivision
    matrix = job.matrix(
        f"daylight-{group.name}",
        partial(
            daylight_matrix,
            job.scene,
            group.outer,
            subdivision=subdivision,
            **job.differentiated,
        ),
        _outside_effort(job, 1 + number),
        shown=f"daylight matrix of {group.name}",
    )
    return [matrix]


def _outside_effort(job: Job, stream: int) -> Effort:
    effort = job.effort(stream)
    return replace(effort, bounces=0) if job.direct else effort


def _port_daylight(
    job: Job, group: WindowGroup, number: int
) -> dict[str, TransferMatrix]:
    # D of each port, traced without the exterior shade
    subdivision = job.study.sky.subdivision
    return job.matrices(
        f"daylight-{group.name}",
        group.ports,
        partial(
            daylight_matrices,
            job.scene,
            group.ports,
            subdivision=subdivision,
            **job.differentiated,
        ),
        _outside_effort(job, PORTS + STATE * number),
        shown=f"daylight matrices of the ports of {group.name}",
    )


def _facade(
    job: Job, group: WindowGroup, number: int, at: int
) -> dict[str, TransferMatrix]:
    # F of each port, with the exterior shade in one state
    shade, label = group.states[at].shade, state_label(group, at)
    scene = job.scene + (blackened(shade) if job.direct else shade)
    return job.matrices(
        f"facade-{label}",
        group.ports,
        partial(facade_matrices, scene, group.outer, group.ports, **job.differentiated),
        _outside_effort(job, FACADE + number + STATE * at),
        shown=f"façade matrices of {label}",
    )
