"""Daylight coefficients (C, C_d) and direct-sun coefficients (C_ds) of a study.

In the two-phase method, each window group is traced separately, as a BSDF surface, with
the other groups black; the results are summed. Room light reflected by the BSDF of
the traced group is included; reflection by the other groups is neglected.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from clerestory.engine.effort import Effort
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import blackened
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.matrix_equation import MatrixChain, WindowMatrices
from clerestory.phases.methods import METHODS
from clerestory.phases.separate_coefficients import (
    has_proxies,
    separate_coefficients,
)
from clerestory.phases.stored_coefficients import store_coefficients, store_sun
from clerestory.phases.sun_coefficients import sun_coefficients
from clerestory.phases.traced_matrices import daylight_coefficients
from clerestory.phases.unscattered_light import (
    unscattered_coefficients,
    unscattered_sun,
)
from clerestory.scene.model import BsdfSurface, Plastic, Scene
from clerestory.sky.sun_matrix import SunMatrix
from clerestory.study.job import COEFFICIENTS, STATE, SUN, Job
from clerestory.study.window_groups import state_label

# Material of the traced window group
_SHADE = "window shade"

# Default number of paths per sensor for C_ds
_SUN_SAMPLES = 1024

# C and, with the direct correction, C_d
_Coefficients = tuple[TransferMatrix, TransferMatrix | None]


def coefficients(job: Job, *, direct: bool) -> list[WindowMatrices]:
    """Return C of each window group and shade state, or of a scene with glazing.

    If `direct`, also return C_d, from the same paths.
    """
    if not job.inputs.groups:
        found = [[_traced(job, job.scene, direct=direct)]]
    else:
        found = [
            [
                _of_state(job, number, at, direct=direct)
                for at in range(len(group.states))
            ]
            for number, group in enumerate(job.inputs.groups)
        ]
    return [_matrices(states) for states in found]


def _matrices(states: Sequence[_Coefficients]) -> WindowMatrices:
    # C, and C_d if there is one, of a window group
    C, C_d = zip(*states, strict=True)
    dark = [matrix for matrix in C_d if matrix is not None]
    return WindowMatrices(MatrixChain(C), MatrixChain(tuple(dark)) if dark else None)


def stored_coefficients(
    job: Job, suns: SunMatrix | None, *, direct: bool
) -> WindowMatrices:
    """Return C, C_d and C_ds of a scene with glazing, in files of blocks of sensors.

    C_d if `direct`, C_ds if there are `suns`.
    """
    sensors, subdivision = job.inputs.sensors(), job.study.sky.subdivision
    effort = job.effort()
    key = fingerprint(
        "coefficients", job.scene_key, sensors, subdivision, direct, effort
    )
    found = store_coefficients(
        partial(job.blocks, "coefficients", key),
        job.scene,
        sensors=sensors,
        subdivision=subdivision,
        direct=direct,
        effort=effort,
        progress=job.display("daylight coefficients"),
    )
    chains = [MatrixChain((columns,)) for columns in found]
    sun = None
    if suns is not None:
        effort = _disc_effort(job)
        key = fingerprint("sun", job.scene_key, sensors, suns.directions, effort)
        columns = store_sun(
            partial(job.blocks, "sun", key),
            job.scene,
            sensors=sensors,
            suns=suns.directions,
            rows=found[0].views.blocks,
            effort=effort,
            progress=job.display("direct sun"),
        )
        sun = MatrixChain((columns,))
    return WindowMatrices(chains[0], chains[1] if direct else None, sun)


def direct_suns(job: Job, suns: SunMatrix) -> list[MatrixChain]:
    """Return C_ds of each window group and shade state, or of a scene with glazing."""
    if job.inputs.groups:
        return [
            MatrixChain(
                tuple(
                    _sun(job, number, at, suns=suns) for at in range(len(group.states))
                )
            )
            for number, group in enumerate(job.inputs.groups)
        ]
    sensors = job.inputs.sensors()
    trace = partial(unscattered_sun, job.scene, sensors=sensors, suns=suns.directions)
    return [
        MatrixChain((job.matrix("sun", trace, _disc_effort(job), shown="direct sun"),))
    ]


def _of_state(job: Job, number: int, at: int, *, direct: bool) -> _Coefficients:
    # C and C_d of one window group in a shade state, with the other groups black
    groups = job.inputs.groups
    chosen, state = groups[number], groups[number].states[at]
    up = chosen.inner.frame.up
    shade = BsdfSurface(_SHADE, state.fine, 0.0, up, peak=state.peak)
    black = Plastic("window black", np.zeros(3))
    surfaces = [
        replace(polygon, material=shade.name if each is chosen else black.name)
        for each in groups
        for polygon in each.inner.polygons
    ]
    materials = {shade.name: shade, black.name: black}
    panes = Scene(materials, tuple(surfaces), bands=job.scene.bands)
    return _traced(
        job,
        job.scene + panes,
        direct=direct,
        stream=COEFFICIENTS + number + STATE * at,
        windows=(_SHADE,),
        of=f"-{state_label(chosen, at)}",
    )


def _traced(
    job: Job,
    scene: Scene,
    *,
    direct: bool,
    stream: int = 0,
    windows: tuple[str, ...] = (),
    of: str = "",
) -> _Coefficients:
    # C and C_d of a scene; direct light is scattered at most by `windows`
    sensors, subdivision = job.inputs.sensors(), job.study.sky.subdivision
    effort, shown = job.effort(stream), f"daylight coefficients{of}"
    name = f"coefficients{of}"
    if direct and (windows or not has_proxies(scene)):
        both = partial(
            separate_coefficients,
            scene,
            sensors=sensors,
            subdivision=subdivision,
            windows=windows,
            **job.differentiated,
        )
        return job.pair((name, f"direct-{name}"), both, effort, shown=shown)
    C, C_d = (
        partial(trace, scene, sensors=sensors, subdivision=subdivision, **more)
        for trace, more in (
            (daylight_coefficients, job.differentiated),
            (unscattered_coefficients, {}),
        )
    )
    whole = job.matrix(name, C, effort, shown=shown)
    if not direct:
        return whole, None
    # Direct light passes proxies, of which other light meets the BSDF
    job = replace(job, direct=True)
    return whole, job.matrix(name, C_d, job.direct_effort(COEFFICIENTS), shown=shown)


def _sun_effort(job: Job, stream: int = 0) -> Effort:
    samples = job.study.sun.samples or _SUN_SAMPLES
    return job.direct_effort(SUN + stream, samples)


def _disc_effort(job: Job) -> Effort:
    # Number of rays in the study file, or the relative error that determines it
    error = job.effort().relative_error
    if job.study.sun.samples or error is None:
        return _sun_effort(job)
    return replace(job.direct_effort(SUN), relative_error=error)


def _sun(job: Job, number: int, at: int, *, suns: SunMatrix) -> TransferMatrix:
    group = job.inputs.groups[number]
    chosen, label, scene = group.states[at], state_label(group, at), job.scene
    if METHODS[job.study.method].facade and chosen.shade.surfaces:
        scene = scene + blackened(chosen.shade)
    trace = partial(
        sun_coefficients,
        scene,
        [each.inner for each in job.inputs.groups],
        group.name,
        chosen.fine,
        sensors=job.inputs.sensors(),
        suns=suns.directions,
        peak=chosen.peak,
    )
    effort = _sun_effort(job, number + STATE * at)
    return job.matrix(
        f"sun-{label}", trace, effort, shown=f"direct sun through {label}"
    )
