"""Matrices of the pixels of one view, and pictures for given shade states.

V is traced once for all shade states, and stored in half precision. The paths from
pixels to the windows, of which V_d and the direct sunlight of all shade states are
computed, are traced in each run: this takes seconds, and files of them are large.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeVar

import numpy as np
from jaxtyping import Int

from clerestory.engine.cost_estimate import Plan
from clerestory.image.camera import Camera
from clerestory.image.picture import Picture
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_equation import MatrixChain, Skies, States, WindowMatrices
from clerestory.phases.methods import METHODS
from clerestory.phases.picture_matrices import (
    picture_view_matrices,
    reflected_view_matrices,
)
from clerestory.phases.picture_series import (
    UncertainPixels,
    luminance_over_time,
    pictures_over_time,
    uncertain_luminance_over_time,
)
from clerestory.phases.pixel_blocks import PixelBlocks
from clerestory.phases.shaded_windows import (
    ShadedWindow,
    ShadeState,
    receiving_matrices,
)
from clerestory.phases.window_paths import WindowPaths, picture_window_paths
from clerestory.study.config_tables import ViewTable
from clerestory.study.job import DIRECT, Job
from clerestory.study.study_matrices import StudyMatrices

# Kind of the pictures of a series
_Series = TypeVar("_Series", Picture, np.ndarray, UncertainPixels)


@dataclass(frozen=True, eq=False)
class ViewMatrices:
    """Matrices of the pixels of one view, for all window groups and shade states.

    T and D are taken from the sensor matrices of the study. `blocks` are the matrices
    of blocks of pixels with their errors; see `PixelBlocks.divided`.
    """

    job: Job
    table: ViewTable
    camera: Camera
    matrices: StudyMatrices
    windows: tuple[WindowMatrices, ...] = ()
    blocks: tuple[WindowMatrices, ...] = ()

    def pictures(
        self, states: States, skies: Skies, steps: Int[np.ndarray, " step"]
    ) -> Iterator[tuple[int, Picture]]:
        """Yield the index and the picture of each selected time step.

        Time steps with the same shade states follow each other, in order of time.
        """
        return self._series(pictures_over_time, states, skies, steps)

    def luminance(
        self, states: States, skies: Skies, steps: Int[np.ndarray, " step"]
    ) -> Iterator[tuple[int, np.ndarray]]:
        """Yield the index and the luminance of each time step; see `pictures`."""
        return self._series(luminance_over_time, states, skies, steps)

    def uncertain_luminance(
        self, states: States, skies: Skies, steps: Int[np.ndarray, " step"]
    ) -> Iterator[tuple[int, UncertainPixels]]:
        """Yield index, luminance and its errors of each time step; see `pictures`."""
        make = partial(uncertain_luminance_over_time, of_blocks=self.blocks)
        return self._series(make, states, skies, steps)

    def _series(
        self,
        make: Callable[..., Iterator[_Series]],
        states: States,
        skies: Skies,
        steps: Int[np.ndarray, " step"],
    ) -> Iterator[tuple[int, _Series]]:
        for alike in _combinations(states, steps):
            series = make(
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
        """Return the indices of the time steps in the order of `pictures`."""
        return np.concatenate(_combinations(states, steps))


def half_views(traced: dict[str, TransferMatrix]) -> dict[str, TransferMatrix]:
    """Return view matrices in half precision, with one channel if all are equal."""
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
    found: list[ViewMatrices] = []
    for table, camera in zip(job.study.view, job.inputs.cameras, strict=True):
        like = found[0] if found else None
        found.append(trace_view(job, matrices, table, camera, like=like))
    return tuple(found)


def trace_view(
    job: Job,
    matrices: StudyMatrices,
    table: ViewTable,
    camera: Camera,
    *,
    like: ViewMatrices | None = None,
) -> ViewMatrices:
    """Return the pixel matrices of a view, from the cache if possible.

    `like` is another view of the study, whose tables of sunlight are used again.
    """
    sunlit = any(term.part == "sun" for term in matrices.terms)
    views = _view_matrices(job, table, camera, reflected=sunlit)
    windows = receiving_matrices(
        shaded_windows(job, matrices),
        views,
        _paths(job, table, camera) if sunlit else None,
        None if matrices.suns is None else matrices.suns.directions,
        kind=np.float16,
        like=like.windows if like and sunlit else None,
    )
    if isinstance(job.executor, Plan):
        # In a dry run, where copies of blank matrices would take memory
        return ViewMatrices(job, table, camera, matrices, windows, windows)
    parts = PixelBlocks.of(camera.rows, camera.columns).divided(windows)
    return ViewMatrices(job, table, camera, matrices, *parts)


def shaded_windows(job: Job, matrices: StudyMatrices) -> tuple[ShadedWindow, ...]:
    """Return the window groups with the matrices of their shade states."""
    facade = METHODS[job.study.method].facade

    def factors(chain: MatrixChain | None, at: int) -> tuple[TransferMatrix, ...]:
        return chain.factors[at] if chain else ()

    return tuple(
        ShadedWindow(
            group.inner,
            tuple(
                ShadeState(
                    whole=factors(window.whole, at),
                    direct=factors(window.direct, at),
                    bsdf=state.fine,
                    peak=state.peak,
                    shade=state.shade if facade else None,
                )
                for at, state in enumerate(group.states)
            ),
        )
        for group, window in zip(job.inputs.groups, matrices.windows, strict=True)
    )


def _view_matrices(
    job: Job, table: ViewTable, camera: Camera, *, reflected: bool
) -> dict[str, TransferMatrix]:
    # V, or V - V_d
    windows = [group.inner for group in job.inputs.groups]
    traced = _traced_reflected if reflected else _traced_views
    return job.matrices(
        f"picture-{table.label}{'-reflected' * reflected}",
        windows,
        partial(traced, job.scene, windows, camera),
        job.pixel_effort(table.samples),
        shown=f"picture matrices of {table.label}",
    )


def _traced_views(*where: Any, **how: Any) -> dict[str, TransferMatrix]:
    return half_views(picture_view_matrices(*where, **how))


def _traced_reflected(*where: Any, **how: Any) -> dict[str, TransferMatrix]:
    return half_views(reflected_view_matrices(*where, **how))


def _paths(job: Job, table: ViewTable, camera: Camera) -> WindowPaths:
    effort = job.direct_effort(DIRECT, job.study.sun.picture_samples)
    windows = [group.inner for group in job.inputs.groups]
    return picture_window_paths(
        job.scene,
        windows,
        camera,
        effort=effort,
        progress=job.display(f"direct light in {table.label}"),
    )
