"""Windows with their shade states, and their matrices for pixels or cells.

T, D and BSDFs do not depend on the receivers: pictures and view points of one study
share them, each with view matrices and paths to the windows of its own.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.bsdf import Bsdf
from clerestory.matrix.transfer_matrix import TransferMatrix, require_matrix
from clerestory.phases.matrix_equation import MatrixChain, WindowMatrices
from clerestory.phases.sunlit import SunlitReceivers, in_sunlight
from clerestory.phases.window_paths import WindowPaths
from clerestory.scene.model import Scene
from clerestory.scene.window import Window


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


@dataclass(frozen=True, eq=False)
class ShadedWindow:
    """Window group and its shade states, the most open first."""

    window: Window
    states: tuple[ShadeState, ...]


def receiving_matrices(
    windows: Sequence[ShadedWindow],
    views: Mapping[str, TransferMatrix],
    paths: WindowPaths | None,
    suns: Float[np.ndarray, "sun 3"] | None,
    *,
    kind: type[np.floating] = np.float32,
) -> tuple[WindowMatrices, ...]:
    """Return the matrices of pixels or cells with given V, by window name.

    With `paths`, they include those of the direct correction under the suns; V_d is of
    floating-point numbers of a `kind`.
    """
    direct = {} if paths is None else paths.view_matrices(kind)
    found = []
    for shaded in windows:
        name, states = shaded.window.name, shaded.states
        whole = MatrixChain((views[name],), tuple(state.whole for state in states))
        if paths is None:
            found.append(WindowMatrices(whole))
            continue
        dark = MatrixChain((direct[name],), tuple(state.direct for state in states))
        sun = MatrixChain(
            tuple(_sunlit(paths, name, state, suns) for state in shaded.states)
        )
        found.append(WindowMatrices(whole, dark, sun))
    return tuple(found)


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
