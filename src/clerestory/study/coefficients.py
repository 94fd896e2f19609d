"""The two-phase method in studies: daylight coefficients, window by window.

Light comes in through one window group at a time, a surface of its BSDF, while the
others are black; the sum over the groups is the room's. So every state of every group
is traced once, and any combination is a sum. What the group's own shade reflects back
into the room is part of it, what the others' reflect is not.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from clerestory import __version__
from clerestory.matrix.transfer_matrix import TransferMatrix, illuminance_dataset
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.shaded import States
from clerestory.phases.traced_matrices import daylight_coefficients
from clerestory.phases.two import two_phase
from clerestory.progress import Progress
from clerestory.scene.model import BsdfSurface, Plastic, Scene
from clerestory.sky.patch_radiance import SkyMatrix
from clerestory.study.job import COEFFICIENTS, STATE, Job
from clerestory.study.window_groups import WindowGroup, WindowState


@dataclass(frozen=True, eq=False)
class TwoPhases:
    """Daylight coefficients of each window group in each of its states.

    A scene that has its glass is one group with one state.
    """

    groups: tuple[tuple[TransferMatrix, ...], ...]

    def illuminance(
        self, sky: SkyMatrix, states: States, *, progress: Progress | None = None
    ) -> xr.Dataset:
        """Illuminance [lux] over (sensor, time), with its standard error."""
        if len(self.groups) == 1 and len(self.groups[0]) == 1:
            return two_phase(self.groups[0][0], sky, progress=progress)
        sensors = self.groups[0][0].rows
        shape = (sensors.size, len(sky.times))
        lux, variance = np.zeros(shape, np.float32), np.zeros(shape, np.float32)
        for matrices, state in zip(self.groups, states, strict=True):
            for number, matrix in enumerate(matrices):
                steps = np.flatnonzero(state == number)
                if len(steps):
                    part = two_phase(matrix, sky.select(steps), progress=progress)
                    lux[:, steps] += part["illuminance"].values
                    variance[:, steps] += part["standard_error"].values ** 2
        return illuminance_dataset(
            lux, np.sqrt(variance), sensors=sensors, times=sky.columns
        )


def trace_coefficients(job: Job) -> TwoPhases:
    """Return the coefficients; those of an earlier run are not traced again."""
    groups = job.inputs.groups
    if not groups:
        return TwoPhases(((_traced(job, job.scene, "coefficients", 0),),))
    return TwoPhases(
        tuple(
            tuple(_state(job, number, at) for at in range(len(group.states)))
            for number, group in enumerate(groups)
        )
    )


def _state(job: Job, number: int, at: int) -> TransferMatrix:
    # Coefficients of one window group in one state
    group = job.inputs.groups[number]
    state = group.states[at]
    name = "-".join(filter(None, ("coefficients", group.name, state.name)))
    scene = _open_one(job.scene, job.inputs.groups, number, state)
    return _traced(job, scene, name, COEFFICIENTS + number + STATE * at)


def _traced(job: Job, scene: Scene, name: str, stream: int) -> TransferMatrix:
    sensors, options = job.inputs.sensors(), job.options(stream)
    options["subdivision"] = job.study.sky.subdivision
    scene_key = job.scene_key if scene is job.scene else fingerprint(__version__, scene)
    key = fingerprint("coefficients", scene_key, sensors, options)

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


def _open_one(
    scene: Scene, groups: Sequence[WindowGroup], number: int, state: WindowState
) -> Scene:
    # The scene with one window in one state, and the others black
    chosen = groups[number].inner
    shade = BsdfSurface(
        "window shade", state.fine, 0.0, chosen.frame.up, peak=state.peak
    )
    black = Plastic("window black", np.zeros(3))
    surfaces = [
        replace(polygon, material=shade.name if at == number else black.name)
        for at, group in enumerate(groups)
        for polygon in group.inner.polygons
    ]
    windows = Scene({shade.name: shade, black.name: black}, tuple(surfaces))
    return scene + windows
