"""Pictures over time: products of the matrices of pixels with skies and suns.

Each step's picture is yielded and forgotten; a few steps and some thousand pixels are
multiplied at a time, so that memory does not grow with the year.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from clerestory.errors import MatrixError
from clerestory.image.picture import Picture
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.picture_matrices import Camera, SunPictures
from clerestory.phases.three import WindowPhases
from clerestory.sky.patch_radiance import SkyMatrix, SkyResponse
from clerestory.sky.sun_matrix import SunMatrix

# Steps multiplied at a time: 640,000 pixels of 16 steps take 123 MB
_STEPS = 16

# Pixels multiplied at a time: their half-precision coefficients are widened for it
_PIXELS = 1 << 15


@dataclass(frozen=True, eq=False)
class PicturePhases:
    """What one window group brings to the equation of a picture.

    Attributes
    ----------
    whole : V, T and D, with all reflections
    direct : V_d, T and D_d; None in the three-phase method
    sun : C_ds by numbers of suns, see `sun_pictures` and `kept`; None in the
        three-phase method
    """

    whole: WindowPhases
    direct: WindowPhases | None = None
    sun: SunPictures | None = None


def kept(coefficients: TransferMatrix) -> SunPictures:
    """Return the direct-sun coefficients of a matrix that was traced before."""
    return lambda asked: np.asarray(coefficients.values[:, :, asked])


def pictures_over_time(
    windows: Sequence[PicturePhases],
    camera: Camera,
    sky: SkyMatrix,
    *,
    sun_in_patches: SkyMatrix | None = None,
    suns: SunMatrix | None = None,
) -> Iterator[Picture]:
    """Yield the picture of every time step, in order, a few of them in memory.

    With the direct phases of the windows this is the extended five-phase method,
    I = V T D S − V_d T D_d S_ds + (C_R-ds + C_F-ds) S_sun; without, the three-phase
    method.

    Parameters
    ----------
    sky : S of the steps wanted; see `SkyMatrix.select`
    sun_in_patches : S_ds of the same steps
    suns : S_sun of the same steps

    Raises
    ------
    MatrixError : matrices do not fit each other, or skies have different times
    """
    times = sky.times
    for other in (sun_in_patches, suns):
        if other is not None and not np.array_equal(other.times, times):
            raise MatrixError("the skies have different time steps; the same expected")
    five = any(window.sun is not None for window in windows)
    if five and (sun_in_patches is None or suns is None):
        raise MatrixError("five phases without the sun's own skies; both expected")
    for first in range(0, len(times), _STEPS):
        steps = slice(first, min(first + _STEPS, len(times)))
        light = _phases([w.whole for w in windows], sky.select(steps))
        if sun_in_patches is not None and suns is not None and five:
            direct = [w.direct for w in windows if w.direct is not None]
            light -= _phases(direct, sun_in_patches.select(steps))
            normal = suns.direct_normal[:, steps]
            for window in windows:
                if window.sun is not None:
                    light += _sunlit(window.sun, normal)
        for step in range(light.shape[2]):
            moment = np.datetime_as_string(times[first + step], unit="m")
            yield camera.picture(np.maximum(light[:, :, step], 0), f"TIME= {moment}")


def _phases(
    windows: Sequence[WindowPhases], sky: SkyMatrix
) -> Float[np.ndarray, "3 pixel time"]:
    # Σ V (T D S): what the windows send comes first, it is small
    total: Float[np.ndarray, "3 pixel time"] = np.zeros(())
    for window in windows:
        response = SkyResponse(window.transmission @ window.daylight, sky)
        sent = response.rgb().values
        total = total + _shown(window.view.values, sent.astype(np.float32))
    return total


def _shown(
    view: Float[np.ndarray, "channel pixel patch"],
    sent: Float[np.ndarray, "3 patch time"],
) -> Float[np.ndarray, "3 pixel time"]:
    # V X, some pixels at a time; grey rooms have one channel for all three
    pixels = view.shape[1]
    light = np.empty((3, pixels, sent.shape[2]), np.float32)
    for first in range(0, pixels, _PIXELS):
        some = slice(first, first + _PIXELS)
        wide = view[:, some].astype(np.float32)
        np.matmul(wide, sent, out=light[:, some])
    return light


def _sunlit(coefficients: SunPictures, normal: Any) -> np.ndarray:
    # Only the suns that shine in these steps
    shining = np.unique(normal.tocoo().coords[0])
    irradiance = normal.tocsr()[shining].toarray().astype(np.float32)
    light: np.ndarray = coefficients(shining) @ irradiance
    return light
