"""Daylight coefficients (C, C_d) and direct-sun coefficients (C_ds) of a study.

In the two-phase method, each window group is traced separately, as a BSDF surface, with
the other groups black; the results are summed. Room light reflected by the group's
own BSDF is included; reflection by the other groups is neglected.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from clerestory.engine.effort import Effort
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.matrix_equation import MatrixChain
from clerestory.phases.methods import METHODS
from clerestory.phases.sun_coefficients import blackened, sun_coefficients
from clerestory.phases.traced_matrices import daylight_coefficients
from clerestory.phases.unscattered_light import (
    unscattered_coefficients,
    unscattered_sun,
)
from clerestory.scene.model import BsdfSurface, Plastic, Scene
from clerestory.sky.sun_matrix import SunMatrix
from clerestory.study.job import COEFFICIENTS, DIRECT, STATE, SUN, Job
from clerestory.study.kept_matrices import kept
from clerestory.study.window_groups import state_label


def coefficients(job: Job, *, direct: bool) -> list[MatrixChain]:
    """Return C of each window group and shade state, or of a scene with glazing.

    Parameters
    ----------
    direct : whether to return C_d, for direct light only
    """
    if not job.inputs.groups:
        unscattered = _unscattered(job) if direct else _traced(job, job.scene, "", 0)
        return [MatrixChain((unscattered,))]
    return [
        MatrixChain(
            tuple(
                _of_state(job, number, at, direct=direct)
                for at in range(len(group.states))
            )
        )
        for number, group in enumerate(job.inputs.groups)
    ]


def direct_suns(job: Job, suns: SunMatrix) -> list[MatrixChain]:
    """Return C_ds of each window group and shade state, or of a scene with glazing."""
    if not job.inputs.groups:
        return [MatrixChain((_unscattered_sun(job, suns),))]
    return [
        MatrixChain(
            tuple(_sun(job, number, at, suns) for at in range(len(group.states)))
        )
        for number, group in enumerate(job.inputs.groups)
    ]


def _of_state(job: Job, number: int, at: int, *, direct: bool) -> TransferMatrix:
    # Scene with one window group in the given state, and the other groups black
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
    stream = COEFFICIENTS + number + STATE * at + DIRECT * direct
    label = state_label(chosen, at)
    return _traced(job, job.scene + panes, label, stream, direct=direct)


def _traced(
    job: Job, scene: Scene, label: str, stream: int, *, direct: bool = False
) -> TransferMatrix:
    sensors, subdivision = job.inputs.sensors(), job.study.sky.subdivision
    scene_key = job.scene_key if scene is job.scene else fingerprint(scene)
    prefix, of = "direct-" if direct else "", f"-{label}" if label else ""
    return kept(
        job,
        f"{prefix}coefficients{of}",
        partial(daylight_coefficients, scene, sensors=sensors, subdivision=subdivision),
        ("coefficients", scene_key, sensors, subdivision),
        job.effort(stream),
        shown=f"{prefix}daylight coefficients{of}",
    )


def _unscattered(job: Job) -> TransferMatrix:
    sensors, subdivision = job.inputs.sensors(), job.study.sky.subdivision
    return kept(
        job,
        "direct-coefficients",
        partial(
            unscattered_coefficients,
            job.scene,
            sensors=sensors,
            subdivision=subdivision,
        ),
        ("unscattered", job.scene_key, sensors, subdivision),
        job.direct_effort(COEFFICIENTS + DIRECT),
        shown="direct daylight coefficients",
    )


def _unscattered_sun(job: Job, suns: SunMatrix) -> TransferMatrix:
    sensors = job.inputs.sensors()
    trace = partial(unscattered_sun, job.scene, sensors=sensors, suns=suns.directions)
    key = "unscattered sun", job.scene_key, sensors, suns.directions
    return kept(job, "sun", trace, key, _sun_effort(job, 0), shown="direct sun")


def _sun_effort(job: Job, stream: int) -> Effort:
    return job.direct_effort(SUN + stream, job.study.sun.samples)


def _sun(job: Job, number: int, at: int, suns: SunMatrix) -> TransferMatrix:
    group = job.inputs.groups[number]
    chosen, sensors = group.states[at], job.inputs.sensors()
    windows = [each.inner for each in job.inputs.groups]
    scene, scene_key = job.scene, job.scene_key
    if METHODS[job.study.method].facade and chosen.shade.surfaces:
        scene = scene + blackened(chosen.shade)
        scene_key = fingerprint(scene)
    label = state_label(group, at)
    return kept(
        job,
        f"sun-{label}",
        partial(
            sun_coefficients,
            scene,
            windows,
            group.name,
            chosen.fine,
            sensors=sensors,
            suns=suns.directions,
            peak=chosen.peak,
        ),
        (
            *("sun", scene_key, windows, number, chosen.fine, chosen.peak, sensors),
            suns.directions,
        ),
        _sun_effort(job, number + STATE * at),
        shown=f"direct sun through {label}",
    )
