"""View matrices and direct-sun coefficients of the pixels of a picture.

    V      pixels × interior patches   picture_view_matrices
    V_d    pixels × interior patches   picture_view_matrices(direct=True)
    C_ds   pixels × suns               picture_sun_coefficients

V is pixel radiance per patch radiance, C_ds is pixel radiance per direct normal
irradiance [1/sr]. V_d and C_ds include light straight from the window and light
reflected once in the room. In the notation of the extended five-phase method, C_ds is
C_F-ds + C_R-ds, and V_d includes the surface reflectances (both material maps).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np
from jaxtyping import Float, Int

from clerestory.bands import RGB, Bands
from clerestory.bsdf.bsdf import Bsdf
from clerestory.checks import require
from clerestory.engine.controller import estimate
from clerestory.engine.direct_sun_jobs import PixelSunJob, trace_pixel_sun
from clerestory.engine.effort import EffortKeywords
from clerestory.engine.matrix_jobs import PixelViewJob
from clerestory.image.picture import Picture
from clerestory.matrix.axis import pixel_axis, sun_axis
from clerestory.matrix.transfer_matrix import Entries, TransferMatrix
from clerestory.phases.sun_coefficients import sun_effort, window_number
from clerestory.phases.traced_matrices import (
    matrix_effort,
    patch_axes,
    require_distinct,
    warn_if_short,
)
from clerestory.scene.model import Scene
from clerestory.scene.view import View
from clerestory.scene.window import Window

# Number of batches of paths per pixel; two, to save memory: half of their difference is
# the error component of a pixel
_BATCHES = 2

# Default number of paths per pixel and sun
_SUN_SAMPLES = 16


@dataclass(frozen=True, eq=False)
class Camera:
    """View and size of a picture."""

    view: View
    columns: int
    rows: int

    def __post_init__(self) -> None:
        message = (
            f"a picture of {self.columns} × {self.rows} pixels; 1 to 2^24 expected"
        )
        require(min(self.columns, self.rows) >= 1 and len(self) <= 1 << 24, message)

    def __len__(self) -> int:
        return self.columns * self.rows

    def picture(
        self,
        radiance: Float[np.ndarray, "band pixel"],
        *header: str,
        bands: Bands = RGB,
    ) -> Picture:
        """Return the picture of the given pixel radiances."""
        pixels = np.moveaxis(radiance, 0, -1).reshape(self.rows, self.columns, -1)
        values = pixels.astype(np.float32)
        return Picture(values, view=self.view, header=header, bands=bands)


def picture_view_matrices(
    scene: Scene,
    windows: Sequence[Window],
    camera: Camera,
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
    require_distinct(windows)
    effort = matrix_effort(picture_view_matrices, keywords)
    job = PixelViewJob(
        scene=scene,
        windows=tuple(windows),
        view=camera.view,
        columns=camera.columns,
        rows=camera.rows,
        direct=direct,
        **effort.job_options(_BATCHES),
    )
    estimated = estimate(job, replace(effort, components=True))
    warn_if_short(estimated, "view matrix of the picture", effort)
    assert estimated.components is not None
    found, first, pixels = {}, 0, pixel_axis(len(camera))
    for name, columns in patch_axes(windows, "interior").items():
        own = slice(first, first + columns.size)
        parts = estimated.values[..., own], estimated.components[..., own]
        values, components = (_in_bands(part, scene.bands) for part in parts)
        # The two components are opposite; one of them is the error
        error = components[:1] * np.float32(math.sqrt(2))
        found[name] = TransferMatrix(values, pixels, columns, error, scene.bands)
        first = own.stop
    return found


def _in_bands(values: np.ndarray, bands: Bands) -> np.ndarray:
    # Repeat the single channel of grey rooms in all bands
    shape = *values.shape[:-3], len(bands), *values.shape[-2:]
    return np.broadcast_to(values.astype(np.float32), shape)


# Function that returns the coefficients of given suns, and their error component
SunPictures = Callable[[Int[np.ndarray, " sun"]], Entries]


def sun_pictures(
    scene: Scene,
    windows: Sequence[Window],
    window: str,
    bsdf: Bsdf,
    camera: Camera,
    *,
    suns: Float[np.ndarray, "sun 3"],
    peak: bool = False,
    **keywords: Unpack[EffortKeywords],
) -> SunPictures:
    """Return a function that traces direct-sun coefficients of a picture on demand.

    The function takes indices of `suns`, since the coefficients of all suns of a year
    do not fit into memory. See `picture_sun_coefficients`.
    """
    effort = sun_effort(sun_pictures, keywords, samples=_SUN_SAMPLES)
    number = window_number(windows, window, bsdf, suns)
    require(
        scene.bands == RGB or not bsdf.in_colour("transmission_front"),
        f"the BSDF is in {RGB}, the scene in {scene.bands}; a BSDF that is the same in"
        " all bands expected",
        file=bsdf.source,
    )
    behind = suns @ windows[number].frame.normal < 0
    job = PixelSunJob(
        scene=scene,
        windows=tuple(windows),
        number=number,
        bsdf=bsdf,
        view=camera.view,
        columns=camera.columns,
        rows=camera.rows,
        suns=suns,
        peak=peak,
        samples=effort.samples or _SUN_SAMPLES,
        **effort.job_options(_BATCHES),
    )

    # Nothing is traced yet, but a dry run records the job
    accepted = effort.executor.accepts(job, effort.goal)

    def coefficients(asked: np.ndarray) -> Entries:
        shape = len(scene.bands), len(camera), len(asked)
        if not accepted:
            nothing = np.broadcast_to(np.zeros((shape[0], 1, 1), np.float32), shape)
            return nothing, nothing[None]
        lit = behind[asked]
        values = np.zeros(shape, np.float32)
        error = np.zeros((1, *shape), np.float32)
        if lit.any():
            one, other = trace_pixel_sun(job, asked[lit], effort)
            values[..., lit] = (one + other) / 2
            error[..., lit] = (one - other) / 2
        return values, error

    return coefficients


def picture_sun_coefficients(
    scene: Scene,
    windows: Sequence[Window],
    window: str,
    bsdf: Bsdf,
    camera: Camera,
    *,
    suns: Float[np.ndarray, "sun 3"],
    peak: bool = False,
    **keywords: Unpack[EffortKeywords],
) -> TransferMatrix:
    """Direct-sun coefficients of a picture [1/sr].

    Pixel radiance per direct normal irradiance: the sun seen through the window
    (C_F-ds) plus sunlight reflected once in the room (C_R-ds). See `sun_coefficients`
    for the parameters; `samples` is the number of paths per pixel and sun.
    """
    effort = sun_effort(picture_sun_coefficients, keywords, samples=_SUN_SAMPLES)
    trace = sun_pictures(
        scene, windows, window, bsdf, camera, suns=suns, peak=peak, effort=effort
    )
    values, error = trace(np.arange(len(suns)))
    axes = pixel_axis(len(camera)), sun_axis(len(suns))
    return TransferMatrix(values, *axes, error, scene.bands)
