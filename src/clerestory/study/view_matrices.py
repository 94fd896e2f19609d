"""Trace what the pictures of one view need, and multiply them out for given states.

V and V_d of the pixels are traced once for all states. Direct suns are traced for each
state when it first acts. All are kept beside the other matrices as half-precision
numbers; those of suns only if all states' fit into what the study allows, else they are
forgotten as the pictures pass.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Literal

import numpy as np
from jaxtyping import Float, Int

from clerestory.image.picture import Picture
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    States,
    WindowMatrices,
)
from clerestory.phases.methods import METHODS
from clerestory.phases.picture_matrices import (
    Camera,
    SunPictures,
    picture_sun_coefficients,
    picture_view_matrices,
    sun_pictures,
)
from clerestory.phases.picture_series import pictures_over_time
from clerestory.study.config_tables import ViewTable
from clerestory.study.job import DIRECT, STATE, SUN, Job
from clerestory.study.kept_matrices import kept, kept_together
from clerestory.study.study_matrices import StudyMatrices

# Bytes of a pixel's coefficient for one sun: three half-precision numbers
_PIXEL_BYTES = 6


@dataclass(frozen=True, eq=False)
class ViewMatrices:
    """Matrices of one view, for all states of all window groups.

    Attributes
    ----------
    matrices : of the sensors, whose T and D are those of the pixels
    windows : V of the pixels, T and D of each window group; V_d, T, D_d and direct suns
        with the direct correction
    """

    job: Job
    table: ViewTable
    camera: Camera
    matrices: StudyMatrices
    windows: tuple[WindowMatrices, ...] = ()
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
        for alike in _combinations(states, steps):
            series = pictures_over_time(
                self.windows,
                self.matrices.terms,
                self.camera,
                skies.select(alike),
                [np.asarray(state)[alike] for state in states],
            )
            yield from zip(alike.tolist(), series, strict=True)

    def order(
        self, states: States, steps: Int[np.ndarray, " step"]
    ) -> Int[np.ndarray, " step"]:
        """Numbers of the steps in the order in which their pictures come."""
        return np.concatenate(_combinations(states, steps))

    def sun_of(
        self, number: int, state: int, asked: Int[np.ndarray, " sun"]
    ) -> Float[np.ndarray, "channel pixel sun"]:
        """Direct-sun coefficients of some suns, traced or read when first asked for."""
        return self.sun(number, state)(asked)

    def sun(self, number: int, state: int) -> SunPictures:
        """Direct sun through one window group in one of its states, by suns."""
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
        where = (scene, windows, group.name, chosen.fine, self.camera)
        if self._bytes(len(directions)) > job.study.sun.keep_gb * 1e9:
            return sun_pictures(
                *where, suns=directions, peak=chosen.peak, effort=effort
            )
        label = "-".join(filter(None, (self.table.label, group.name, chosen.name)))

        def trace(**how: Any) -> TransferMatrix:
            peak = chosen.peak
            return _half(
                picture_sun_coefficients(*where, suns=directions, peak=peak, **how)
            )

        found = kept(
            job,
            f"picture-sun-{label}",
            trace,
            (
                *("picture sun", job.scene_key, chosen.shade, number, *where[1:]),
                *(chosen.peak, directions),
            ),
            effort,
            shown=f"direct sun in pictures, {label}",
        )
        return lambda asked: found.values[:, :, asked]

    def _bytes(self, suns: int) -> int:
        # What the direct suns of all views and states take
        inputs = self.job.inputs
        pixels = sum(len(camera) for camera in inputs.cameras)
        states = sum(len(group.states) for group in inputs.groups)
        return _PIXEL_BYTES * pixels * suns * states


def _half(matrix: TransferMatrix) -> TransferMatrix:
    # Three digits are enough for a pixel, whose noise is larger. The channels of grey
    # rooms are equal and one in memory: one is enough
    values = matrix.values
    alike = values.strides[0] == 0
    return replace(matrix, values=(values[:1] if alike else values).astype(np.float16))


def _combinations(
    states: States, steps: Int[np.ndarray, " step"]
) -> list[Int[np.ndarray, " alike"]]:
    # Steps of each combination of states that occurs
    chosen = np.stack([np.asarray(state)[steps] for state in states], axis=1)
    return [
        steps[(chosen == combination).all(axis=1)]
        for combination in np.unique(chosen, axis=0)
    ]


def trace_views(job: Job, matrices: StudyMatrices) -> tuple[ViewMatrices, ...]:
    """Return the matrices of all views; what was traced before is found again."""
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
            found.append(MatrixChain((views[group.name],), factors))
        return found

    view = ViewMatrices(job, table, camera, matrices)
    parts = {term.part for term in matrices.terms}
    none: list[MatrixChain | None] = [None] * len(matrices.windows)
    suns = [
        MatrixChain(
            tuple(partial(view.sun_of, n, at) for at in range(len(group.states)))
        )
        for n, group in enumerate(job.inputs.groups)
    ]
    whole = chains("whole")
    direct = chains("direct") if "direct" in parts else none
    windows = map(WindowMatrices, whole, direct, suns if "sun" in parts else none)
    return replace(view, windows=tuple(windows))


def _view_matrices(
    job: Job, table: ViewTable, camera: Camera, *, direct: bool
) -> dict[str, TransferMatrix]:
    effort = job.pixel_effort(table.samples, DIRECT * direct)
    prefix = "direct-picture" if direct else "picture"
    windows = [group.inner for group in job.inputs.groups]

    def trace(**how: Any) -> dict[str, TransferMatrix]:
        traced = picture_view_matrices(job.scene, windows, camera, direct=direct, **how)
        return {name: _half(matrix) for name, matrix in traced.items()}

    return kept_together(
        job,
        f"{prefix}-{table.label}",
        windows,
        trace,
        ("half picture", job.scene_key, windows, camera, direct),
        effort,
        shown=f"{prefix} matrices of {table.label}",
    )
