"""Matrices of the pixels of one view, and pictures for given shade states.

V and V_d are traced once for all shade states. Direct-sun coefficients of a shade state
are traced when the state first occurs. Matrices are cached in half precision. If the
direct-sun coefficients of all states exceed the limit `keep_gb` of the study, the
coefficients are traced for each picture and not cached.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import Any, Literal

import numpy as np
from jaxtyping import Int

from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_equation import MatrixChain, Skies, States, WindowMatrices
from clerestory.phases.methods import METHODS
from clerestory.phases.picture_matrices import (
    Camera,
    SunPictures,
    picture_sun_coefficients,
    picture_view_matrices,
    sun_pictures,
)
from clerestory.phases.picture_series import (
    UncertainPicture,
    uncertain_pictures_over_time,
)
from clerestory.phases.stored_views import FEW, with_few_components
from clerestory.study.config_tables import ViewTable
from clerestory.study.job import DIRECT, STATE, SUN, Job
from clerestory.study.study_matrices import StudyMatrices

# Bytes per pixel and sun: three half-precision values and their errors
_PIXEL_BYTES = 12


@dataclass(frozen=True, eq=False)
class ViewMatrices:
    """Matrices of the pixels of one view, for all window groups and shade states.

    T and D are taken from the sensor matrices of the study.
    """

    job: Job
    table: ViewTable
    camera: Camera
    matrices: StudyMatrices
    windows: tuple[WindowMatrices, ...] = ()
    _suns: dict[tuple[int, int], SunPictures] = field(default_factory=dict)

    def pictures(
        self,
        states: States,
        skies: Skies,
        steps: Int[np.ndarray, " step"],
        *,
        errors: bool = False,
    ) -> Iterator[tuple[int, UncertainPicture]]:
        """Yield the index and the picture of each selected time step.

        Time steps with the same shade states follow each other, in order of time.
        Without `errors`, all errors are zero.
        """
        for alike in _combinations(states, steps):
            series = uncertain_pictures_over_time(
                self.windows,
                self.matrices.terms,
                self.camera,
                skies.select(alike),
                [np.asarray(state)[alike] for state in states],
                errors=errors,
            )
            yield from zip(alike.tolist(), series, strict=True)

    def order(
        self, states: States, steps: Int[np.ndarray, " step"]
    ) -> Int[np.ndarray, " step"]:
        """Return the indices of the time steps in the order of `pictures`."""
        return np.concatenate(_combinations(states, steps))

    def sun(self, number: int, state: int) -> SunPictures:
        """Return a function that computes C_ds of a group and shade state from suns."""
        if (number, state) not in self._suns:
            self._suns[number, state] = self._sun(number, state)
        return self._suns[number, state]

    def _sun(self, number: int, state: int) -> SunPictures:
        job, suns = self.job, self.matrices.suns
        group = job.inputs.groups[number]
        chosen = group.states[state]
        directions = np.zeros((0, 3)) if suns is None else suns.directions
        windows = [each.inner for each in job.inputs.groups]
        samples, stream = job.study.sun.picture_samples, SUN + number + STATE * state
        effort = job.direct_effort(stream, samples)
        scene = job.scene
        if METHODS[job.study.method].facade:
            scene = scene + chosen.shade
        where = scene, windows, group.name, chosen.fine, self.camera
        how: dict[str, Any] = {"suns": directions, "peak": chosen.peak}
        if self._bytes(len(directions)) > job.study.sun.keep_gb * 1e9:
            return sun_pictures(*where, **how, effort=effort)
        label = "-".join(filter(None, (self.table.label, group.name, chosen.name)))
        found = job.matrix(
            f"picture-sun-{label}",
            partial(_half_suns, *where, **how),
            effort,
            shown=f"direct sun in pictures, {label}",
        )
        parts = found.components
        return lambda asked: (
            found.values[:, :, asked],
            None if parts is None else parts[..., asked],
        )

    def _bytes(self, suns: int) -> int:
        # Size of the direct-sun coefficients of all views and shade states [bytes]
        inputs = self.job.inputs
        pixels = sum(len(camera) for camera in inputs.cameras)
        states = sum(len(group.states) for group in inputs.groups)
        return _PIXEL_BYTES * pixels * suns * states


def _half_suns(*where: Any, **how: Any) -> TransferMatrix:
    return _half(picture_sun_coefficients(*where, **how))


def _half_views(*where: Any, **how: Any) -> dict[str, TransferMatrix]:
    traced = picture_view_matrices(*where, **how)
    return {name: _half(matrix) for name, matrix in traced.items()}


def _half(matrix: TransferMatrix) -> TransferMatrix:
    # Half precision (three digits) suffices, as pixel noise is larger. If channels are
    # equal, as in grey rooms, only one is stored
    values, error = matrix.values, matrix.components
    if values.strides[0] == 0:
        values = values[:1]
        error = None if error is None else error[:, :1]
    return replace(
        matrix,
        values=values.astype(np.float16),
        components=None if error is None else error.astype(np.float16),
    )


def _combinations(
    states: States, steps: Int[np.ndarray, " step"]
) -> list[Int[np.ndarray, " alike"]]:
    # Indices of the time steps of each combination of shade states
    chosen = np.stack([np.asarray(state)[steps] for state in states], axis=1)
    return [
        steps[(chosen == combination).all(axis=1)]
        for combination in np.unique(chosen, axis=0)
    ]


def trace_views(job: Job, matrices: StudyMatrices) -> tuple[ViewMatrices, ...]:
    """Return the pixel matrices of all views, from the cache if possible."""
    return tuple(
        _view(job, matrices, table, camera)
        for table, camera in zip(job.study.view, job.inputs.cameras, strict=True)
    )


def _view(
    job: Job, matrices: StudyMatrices, table: ViewTable, camera: Camera
) -> ViewMatrices:
    def chains(part: Literal["whole", "direct"]) -> list[MatrixChain]:
        views = _view_matrices(job, table, camera, direct=part == "direct")
        found = []
        for group, window in zip(job.inputs.groups, matrices.windows, strict=True):
            chain = window.direct if part == "direct" else window.whole
            factors = chain.factors if chain else ()
            own = tuple(tuple(map(few, factor)) for factor in factors)
            found.append(MatrixChain((views[group.name],), own))
        return found

    @cache
    def few(matrix: TransferMatrix) -> TransferMatrix:
        # Few error components suffice for glare; equal matrices remain one object
        batches = 0 if matrix.components is None else len(matrix.components)
        return matrix if batches % FEW else with_few_components(matrix)

    view = ViewMatrices(job, table, camera, matrices)
    parts = {term.part for term in matrices.terms}
    none: list[MatrixChain | None] = [None] * len(matrices.windows)
    suns = [
        MatrixChain(tuple(_on_demand(view, n, at) for at in range(len(group.states))))
        for n, group in enumerate(job.inputs.groups)
    ]
    whole = chains("whole") if "whole" in parts else none
    direct = chains("direct") if "direct" in parts else none
    windows = map(WindowMatrices, whole, direct, suns if "sun" in parts else none)
    return replace(view, windows=tuple(windows))


def _on_demand(view: ViewMatrices, number: int, state: int) -> SunPictures:
    # Function that gives C_ds for given suns; C_ds is traced at the first call
    return lambda asked: view.sun(number, state)(asked)


def _view_matrices(
    job: Job, table: ViewTable, camera: Camera, *, direct: bool
) -> dict[str, TransferMatrix]:
    windows = [group.inner for group in job.inputs.groups]
    prefix = "direct-picture" if direct else "picture"
    return job.matrices(
        f"{prefix}-{table.label}",
        windows,
        partial(_half_views, job.scene, windows, camera, direct=direct),
        job.pixel_effort(table.samples, DIRECT * direct),
        shown=f"{prefix} matrices of {table.label}",
    )
