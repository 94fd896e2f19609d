"""Daylight coefficients (C, C_d) and direct-sun coefficients (C_ds) of a study.

In the two-phase method, each window group is traced separately, as a BSDF surface, with
the other groups black; the results are summed. Room light reflected by the BSDF of
the traced group is included; reflection by the other groups is neglected.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from clerestory.engine.effort import Effort
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import blackened
from clerestory.phases.matrix_equation import MatrixChain
from clerestory.phases.methods import METHODS
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


def coefficients(job: Job) -> list[MatrixChain]:
    """Return C of each window group and shade state, or of a scene with glazing.

    If `job.direct`, return C_d instead of C.
    """
    if job.inputs.groups:
        return _of_states(job, _of_state)
    return [MatrixChain((_traced(job, job.scene),))]


def direct_suns(job: Job, suns: SunMatrix) -> list[MatrixChain]:
    """Return C_ds of each window group and shade state, or of a scene with glazing."""
    if job.inputs.groups:
        return _of_states(job, partial(_sun, suns=suns))
    sensors = job.inputs.sensors()
    trace = partial(unscattered_sun, job.scene, sensors=sensors, suns=suns.directions)
    return [
        MatrixChain((job.matrix("sun", trace, _sun_effort(job), shown="direct sun"),))
    ]


def _of_states(
    job: Job, trace: Callable[[Job, int, int], TransferMatrix]
) -> list[MatrixChain]:
    # Traced matrices of every window group and shade state
    return [
        MatrixChain(tuple(trace(job, number, at) for at in range(len(group.states))))
        for number, group in enumerate(job.inputs.groups)
    ]


def _of_state(job: Job, number: int, at: int) -> TransferMatrix:
    # C of one window group in a given shade state, with the other groups black
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
    materials = {shade.name: shade, black.name: black}
    panes = Scene(materials, tuple(surfaces), bands=job.scene.bands)
    stream = COEFFICIENTS + number + STATE * at
    return _traced(job, job.scene + panes, stream, f"-{state_label(chosen, at)}")


def _traced(job: Job, scene: Scene, stream: int = 0, of: str = "") -> TransferMatrix:
    sensors, subdivision = job.inputs.sensors(), job.study.sky.subdivision
    unscattered = job.direct and not job.inputs.groups
    trace = partial(
        unscattered_coefficients if unscattered else daylight_coefficients,
        scene,
        sensors=sensors,
        subdivision=subdivision,
    )
    effort = job.direct_effort(COEFFICIENTS) if unscattered else job.effort(stream)
    shown = f"daylight coefficients{of}"
    return job.matrix(f"coefficients{of}", trace, effort, shown=shown)


def _sun_effort(job: Job, stream: int = 0) -> Effort:
    return job.direct_effort(SUN + stream, job.study.sun.samples)


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
