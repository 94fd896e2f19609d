"""View matrices of the pixels of a picture.

    V         pixels × interior patches   picture_view_matrices
    V_d       pixels × interior patches   picture_view_matrices(direct=True)
    V - V_d   pixels × interior patches   reflected_view_matrices

V is pixel radiance per patch radiance. V_d includes light straight from the window and
light reflected once in the room. In the notation of the extended five-phase method, it
includes the surface reflectances (both material maps).
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, Unpack

import numpy as np

from clerestory.bands import Bands
from clerestory.checks import require
from clerestory.engine.controller import estimate
from clerestory.engine.effort import Effort, EffortKeywords
from clerestory.engine.matrix_jobs import PixelViewJob
from clerestory.image.camera import PixelsOrCells
from clerestory.matrix.axis import pixel_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.separate_coefficients import has_proxies
from clerestory.phases.traced_matrices import (
    Differentiated,
    matrix_effort,
    patch_axes,
    require_distinct,
    split_columns,
    warn_if_short,
)
from clerestory.scene.material_parameters import material_parameters
from clerestory.scene.model import Scene
from clerestory.scene.window import Window

# Number of batches of paths per pixel; two, to save memory: half of their difference is
# the error component of a pixel
_BATCHES = 2

# Number of batches of matrices with derivatives, each with its error component
_DIFFERENTIATED = 8


def picture_view_matrices(
    scene: Scene,
    windows: Sequence[Window],
    camera: PixelsOrCells,
    *,
    direct: bool = False,
    **keywords: Unpack[EffortKeywords],
) -> dict[str, TransferMatrix]:
    """View matrices of a picture, by window name: pixel radiance per patch radiance.

    Parameters
    ----------
    direct : whether to trace V_d (at most one reflection in the room) instead of V
    samples : number of paths per pixel
    relative_error : instead of samples: target RMS of the pixels' standard errors for
        windows of uniform radiance, relative to the mean pixel radiance

    The other parameters are those of `view_matrix`.
    """
    effort = matrix_effort(picture_view_matrices, keywords)
    return _traced(scene, windows, camera, "direct" if direct else "all", effort)


def reflected_view_matrices(
    scene: Scene,
    windows: Sequence[Window],
    camera: PixelsOrCells,
    **keywords: Unpack[EffortKeywords],
) -> dict[str, TransferMatrix]:
    """View matrices of light that is not direct, V - V_d; see `picture_view_matrices`.

    V as the sum of this matrix and of V_d has the same random error as V_d, which
    thus cancels in V T D S - V_d T D_d S_ds.
    """
    effort = matrix_effort(reflected_view_matrices, keywords)
    if not has_proxies(scene):
        return _traced(scene, windows, camera, "reflected", effort)
    # A proxy transmits direct light by its geometry, other light by its BSDF
    whole = _traced(scene, windows, camera, "all", effort)
    direct = _traced(scene, windows, camera, "direct", effort)
    return {name: _difference(whole[name], direct[name]) for name in whole}


def differentiated_view_matrices(
    scene: Scene,
    windows: Sequence[Window],
    camera: PixelsOrCells,
    *,
    derivatives: Differentiated,
    reflected: bool = False,
    **keywords: Unpack[EffortKeywords],
) -> dict[str, TransferMatrix]:
    """View matrices of a picture with derivatives, and the errors of all batches.

    Parameters
    ----------
    derivatives : names of materials, or "all"; see `view_matrix`
    reflected : whether to trace V - V_d instead of V

    The other parameters are those of `picture_view_matrices`.
    """
    effort = matrix_effort(differentiated_view_matrices, keywords)
    require_distinct(windows)
    refused = reflected and has_proxies(scene)
    require(
        not refused, "derivatives of pictures through proxies; a scene without expected"
    )
    job = PixelViewJob(
        scene=scene,
        windows=tuple(windows),
        camera=camera,
        light="reflected" if reflected else "all",
        derivatives=material_parameters(scene, derivatives),
        **effort.job_options(_DIFFERENTIATED),
    )
    estimated = estimate(job, replace(effort, components=True))
    warn_if_short(estimated, "view matrix of the picture", effort)
    columns = patch_axes(windows, "interior")
    return split_columns(estimated, pixel_axis(len(camera)), columns, scene.bands)


def _difference(whole: TransferMatrix, direct: TransferMatrix) -> TransferMatrix:
    assert whole.components is not None
    assert direct.components is not None
    components = whole.components - direct.components
    return replace(whole, values=whole.values - direct.values, components=components)


def _traced(
    scene: Scene,
    windows: Sequence[Window],
    camera: PixelsOrCells,
    light: Literal["all", "direct", "reflected"],
    effort: Effort,
) -> dict[str, TransferMatrix]:
    require_distinct(windows)
    job = PixelViewJob(
        scene=scene,
        windows=tuple(windows),
        camera=camera,
        light=light,
        **effort.job_options(_BATCHES),
    )
    estimated = estimate(job, replace(effort, components=True))
    warn_if_short(estimated, "view matrix of the picture", effort)
    assert estimated.components is not None
    # The two components are opposite; one of them is the error
    whole, one = estimated.values, estimated.components[:1].copy()
    one *= np.float32(math.sqrt(2))
    # Large matrices are released as soon as they are copied
    del estimated
    whole = whole.astype(np.float32)
    found, first, pixels = {}, 0, pixel_axis(len(camera))
    for name, columns in patch_axes(windows, "interior").items():
        own = slice(first, first + columns.size)
        values, error = (
            _in_bands(part[..., own], scene.bands) for part in (whole, one)
        )
        found[name] = TransferMatrix(values, pixels, columns, error, scene.bands)
        first = own.stop
    return found


def _in_bands(values: np.ndarray, bands: Bands) -> np.ndarray:
    # Repeat the single channel of grey rooms in all bands
    shape = *values.shape[:-3], len(bands), *values.shape[-2:]
    return np.broadcast_to(values, shape)
