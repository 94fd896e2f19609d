"""Windows with their shade states, and their matrices for pixels or cells.

T, D and BSDFs do not depend on the receivers: pictures and view points of one study
share them, each with view matrices and paths to the windows of its own.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from jaxtyping import Float

from clerestory.argument_types import checked_fields
from clerestory.brief_repr import brief
from clerestory.bsdf.bsdf import Bsdf
from clerestory.matrix.transfer_matrix import TransferMatrix, require_matrix
from clerestory.phases.matrix_equation import MatrixChain, Receiving, WindowMatrices
from clerestory.phases.stored_views import FEW, with_few_components
from clerestory.phases.sunlit import SunlitReceivers, in_sunlight
from clerestory.phases.window_paths import WindowPaths
from clerestory.scene.model import Scene
from clerestory.scene.window import Window


@checked_fields
@dataclass(frozen=True, eq=False, kw_only=True)
class ShadeState:
    """Light transport from sky and sun through a window in one shade state.

    Attributes
    ----------
    whole : T and D (or F D)
    direct : T and D_d (or F_d D_d), for the direct correction
    bsdf : BSDF at full resolution, for the direct correction; `peak` tells whether its
        direct transmission is extracted
    shade : exterior shade of this state
    """

    whole: tuple[TransferMatrix, ...]
    direct: tuple[TransferMatrix, ...] = ()
    bsdf: Bsdf | None = None
    peak: bool = False
    shade: Scene | None = None

    __repr__ = brief


@checked_fields
@dataclass(frozen=True, eq=False)
class ShadedWindow:
    """Window group and its shade states, the most open first."""

    window: Window
    states: tuple[ShadeState, ...]

    __repr__ = brief


def receiving_matrices(
    windows: Sequence[ShadedWindow],
    views: Mapping[str, TransferMatrix],
    paths: WindowPaths | None,
    suns: Float[np.ndarray, "sun 3"] | None,
    *,
    kind: type[np.floating] = np.float32,
    like: Sequence[WindowMatrices] | None = None,
) -> tuple[WindowMatrices, ...]:
    """Return the matrices of pixels or cells, by window name.

    `views` are V. With `paths`, they are V - V_d, and the matrices include those of the
    direct correction under the suns; the errors of V_d are of a `kind` of numbers. T,
    F and D have the few error components that suffice for glare. `like` are matrices of
    other receivers of the same windows under the same suns, whose tables of sunlight
    are used again.
    """

    @cache
    def few(matrix: TransferMatrix) -> TransferMatrix:
        # Equal matrices remain one object
        batches = 0 if matrix.components is None else len(matrix.components)
        return matrix if batches % FEW else with_few_components(matrix)

    def chain(
        view: TransferMatrix, factors: Iterable[tuple[TransferMatrix, ...]]
    ) -> MatrixChain:
        return MatrixChain((view,), tuple(tuple(map(few, each)) for each in factors))

    direct = {} if paths is None else paths.view_matrices(kind)
    found = []
    for number, shaded in enumerate(windows):
        name, states = shaded.window.name, shaded.states
        factors = [state.whole for state in states]
        if paths is None:
            found.append(WindowMatrices(chain(views[name], factors)))
            continue
        whole = chain(_sum(views[name], direct[name]), factors)
        known = like[number].sun if like else None
        sun = MatrixChain(
            tuple(_sunlit(paths, name, each, suns) for each in states)
            if known is None
            else tuple(_again(each, paths) for each in known.receiving)
        )
        dark = chain(direct[name], (state.direct for state in states))
        found.append(WindowMatrices(whole, dark, sun))
    return tuple(found)


def _sum(reflected: TransferMatrix, direct: TransferMatrix) -> TransferMatrix:
    # V of the same paths as V_d, so that its error cancels in V T D S - V_d T D_d S_ds
    values, error = reflected.values, reflected.components
    assert error is not None
    assert direct.components is not None
    # Grey rooms: one channel
    if len(direct.values) == 1:
        values, error = values[:1], error[:, :1]
    # Numbers in half precision are added in single precision, which is faster
    parts = (values, direct.values), (error, direct.components)
    total, components = (np.add(*part, dtype=np.float32) for part in parts)
    return replace(reflected, values=total, components=components)


def _sunlit(
    paths: WindowPaths,
    window: str,
    state: ShadeState,
    suns: Float[np.ndarray, "sun 3"] | None,
) -> SunlitReceivers:
    require_matrix(
        state.bsdf is not None and state.direct,
        f'a state of window "{window}" has no BSDF or no direct matrices; both expected'
        " for the direct correction",
    )
    assert state.bsdf is not None
    room = paths.job.scene
    return in_sunlight(
        paths,
        window,
        state.bsdf,
        suns=np.zeros((0, 3)) if suns is None else suns,
        peak=state.peak,
        scene=None if state.shade is None else room + state.shade,
    )


def _again(matrix: Receiving, paths: WindowPaths) -> SunlitReceivers:
    assert isinstance(matrix, SunlitReceivers)
    return matrix.of(paths)
