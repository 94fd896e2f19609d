"""Trace what the pictures of one view need, and multiply them out for given states.

V and V_d of the pixels are traced once for all states. Direct suns are traced for each
state when it first acts. All are kept beside the other matrices as half-precision
numbers; those of suns only if all states' fit into what the study allows, else they are
forgotten as the pictures pass.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from jaxtyping import Int

from clerestory.image.picture import Picture
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.picture_matrices import (
    Camera,
    SunPictures,
    picture_sun_coefficients,
    picture_view_matrices,
    sun_pictures,
)
from clerestory.phases.picture_series import PicturePhases, kept, pictures_over_time
from clerestory.phases.shaded import ShadedWindow, States
from clerestory.phases.streamed import Opening
from clerestory.study.config_tables import ViewTable
from clerestory.study.job import DIRECT, STATE, SUN, Job
from clerestory.study.stored import Traced
from clerestory.study.traced import Skies

# Bytes of a pixel's coefficient for one sun: three half-precision numbers
_PIXEL_BYTES = 6


@dataclass(frozen=True, eq=False)
class ViewTracing:
    """Matrices of one view, for all states of all window groups.

    Attributes
    ----------
    whole : V of the pixels, T and D of each window group
    direct : V_d, T and D_d, in the five-phase method
    """

    job: Job
    table: ViewTable
    camera: Camera
    tracing: Traced
    whole: tuple[ShadedWindow, ...]
    direct: tuple[ShadedWindow, ...] = ()
    _suns: dict[tuple[int, int], SunPictures] = field(default_factory=dict)

    def pictures(
        self, states: States, skies: Skies, steps: Int[np.ndarray, " step"]
    ) -> Iterator[tuple[int, Picture]]:
        """Yield number and picture of each of some steps.

        Steps of one combination of states come together, in order of time.

        Parameters
        ----------
        states : number of the state at every step of the skies, per window group
        steps : numbers of the steps wanted
        """
        for combination, alike in _combinations(states, steps):
            suns = self.tracing.suns
            series = pictures_over_time(
                [self._phases(n, int(s)) for n, s in enumerate(combination)],
                self.camera,
                skies.whole.select(alike),
                sun_in_patches=skies.sun.select(alike) if suns and skies.sun else None,
                suns=suns.select(alike) if suns else None,
            )
            yield from zip(alike.tolist(), series, strict=True)

    def order(
        self, states: States, steps: Int[np.ndarray, " step"]
    ) -> Int[np.ndarray, " step"]:
        """Numbers of the steps in the order in which their pictures come."""
        return np.concatenate([alike for _, alike in _combinations(states, steps)])

    def _phases(self, number: int, state: int) -> PicturePhases:
        # One window group in one of its states
        whole = self.whole[number].at(state)
        if not self.direct:
            return PicturePhases(whole)
        direct = self.direct[number].at(state)
        return PicturePhases(whole, direct, self.sun(number, state))

    def sun(self, number: int, state: int) -> SunPictures:
        """Direct sun through one window group in one of its states, by suns."""
        if (number, state) not in self._suns:
            self._suns[number, state] = self._sun(number, state)
        return self._suns[number, state]

    def _sun(self, number: int, state: int) -> SunPictures:
        job, suns = self.job, self.tracing.suns
        group = job.inputs.groups[number]
        chosen = group.states[state]
        directions = np.zeros((0, 3)) if suns is None else suns.directions
        windows = [each.inner for each in job.inputs.groups]
        options: dict[str, Any] = {
            "peak": chosen.peak,
            "samples": job.study.sun.picture_samples,
            "seed": job.seed(SUN + number + STATE * state),
            "device": job.device,
        }
        where = (job.scene, windows, group.name, chosen.fine, self.camera)
        if self._bytes(len(directions)) > job.study.sun.keep_gb * 1e9:
            return sun_pictures(
                *where, suns=directions, executor=job.executor, **options
            )
        label = "-".join(filter(None, (self.table.label, group.name, chosen.name)))
        key = fingerprint(
            "picture sun", job.scene_key, windows, number, chosen.fine, self.camera,
            directions, options,
        )  # fmt: skip

        def make() -> TransferMatrix:
            progress = job.display(f"direct sun in pictures, {label}")
            traced = picture_sun_coefficients(
                *where,
                suns=directions,
                executor=job.executor,
                progress=progress,
                **options,
            )
            return _half(traced)

        return kept(job.matrix(f"picture-sun-{label}", key, make))

    def _bytes(self, suns: int) -> int:
        # What the direct suns of all views and states take
        inputs = self.job.inputs
        pixels = sum(len(camera) for camera in inputs.cameras)
        states = sum(len(group.states) for group in inputs.groups)
        return _PIXEL_BYTES * pixels * suns * states


def _half(matrix: TransferMatrix) -> TransferMatrix:
    # Three digits are enough for a pixel, whose noise is larger. Grey rooms have three
    # equal channels, which are one in memory: one is enough
    values = matrix.values
    alike = values.strides[0] == 0
    return replace(matrix, values=values[: 1 if alike else 3].astype(np.float16))


def _combinations(
    states: States, steps: Int[np.ndarray, " step"]
) -> list[tuple[np.ndarray, np.ndarray]]:
    # Combinations of states that occur, and their steps
    chosen = np.stack([np.asarray(state)[steps] for state in states], axis=1)
    return [
        (combination, steps[(chosen == combination).all(axis=1)])
        for combination in np.unique(chosen, axis=0)
    ]


def trace_views(job: Job, tracing: Traced) -> tuple[ViewTracing, ...]:
    """Return the matrices of all views; what was traced before is found again."""
    return tuple(
        _view(job, tracing, table, camera)
        for table, camera in zip(job.study.view, job.inputs.cameras, strict=True)
    )


def _view(job: Job, tracing: Traced, table: ViewTable, camera: Camera) -> ViewTracing:
    def windows(
        parts: Sequence[ShadedWindow | Opening], *, direct: bool
    ) -> tuple[ShadedWindow, ...]:
        views = _view_matrices(job, table, camera, direct=direct)
        return tuple(
            ShadedWindow(
                views[group.name],
                part.transmissions,
                replace(part.daylight, components=None),  # pictures tell no error
            )
            for group, part in zip(job.inputs.groups, parts, strict=True)
        )

    whole = windows(tracing.whole, direct=False)
    direct = () if tracing.suns is None else windows(tracing.direct, direct=True)
    return ViewTracing(job, table, camera, tracing, whole, direct)


def _view_matrices(
    job: Job, table: ViewTable, camera: Camera, *, direct: bool
) -> dict[str, TransferMatrix]:
    options = job.options(DIRECT * direct)
    del options["relative_error" if "relative_error" in options else "samples"]
    options |= {"samples": table.samples, "direct": direct}
    prefix = "direct-picture" if direct else "picture"
    inner = {f"{prefix}-{table.label}-{g.name}": g.inner for g in job.inputs.groups}
    key = fingerprint(
        "half picture", job.scene_key, list(inner.values()), camera, options
    )

    def make() -> dict[str, TransferMatrix]:
        progress = job.display(f"{prefix} matrices of {table.label}")
        traced = picture_view_matrices(
            job.scene,
            list(inner.values()),
            camera,
            executor=job.executor,
            progress=progress,
            **options,
        )
        return {name: _half(traced[window.name]) for name, window in inner.items()}

    found = job.matrices(list(inner), key, make)
    return {window.name: found[name] for name, window in inner.items()}
