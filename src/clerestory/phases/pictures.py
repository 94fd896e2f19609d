"""Pictures by matrices: view matrices of pixels, direct suns, and their products.

    V      pixels × interior patches   picture_view_matrices
    V_d    the same, direct            picture_view_matrices(direct=True)
    C_ds   pixels × suns               picture_sun_coefficients

Coefficients are radiance per unit radiance of patches, and radiance per direct normal
irradiance of suns [1/sr]. In the direct parts light reaches the eye from a window
itself or from the one surface that it shines on: C_F-ds and C_R-ds of the extended
five-phase method are one matrix here, as V_d times both material maps is.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Unpack

import numpy as np
from jaxtyping import Float, Int

from clerestory.bsdf.bsdf import Bsdf
from clerestory.engine.device import Device
from clerestory.engine.sunlit import PixelSunJob, trace_pixel_sun
from clerestory.engine.traces import trace_pixel_view
from clerestory.engine.work import Executor, Goal, Local
from clerestory.errors import InputError, MatrixError
from clerestory.image.picture import Picture
from clerestory.matrix.axis import pixel_axis, sun_axis, window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.sun import check_window
from clerestory.phases.three import WindowPhases
from clerestory.phases.trace import Progress, Tracing, matrix_effort, warn_if_short
from clerestory.scene.model import Scene
from clerestory.scene.view import View
from clerestory.scene.window import Window
from clerestory.sky.matrix import SkyMatrix, SkyResponse
from clerestory.sky.suns import SunMatrix

# Batches of a pixel: enough to judge its error, few enough for memory
_BATCHES = 4

# Steps multiplied at a time: 640,000 pixels of 16 steps take 123 MB
_STEPS = 16

# Pixels multiplied at a time: their half-precision coefficients are widened for it
_PIXELS = 1 << 15


@dataclass(frozen=True, eq=False)
class Camera:
    """A view and the size of its picture.

    Raises
    ------
    InputError : no pixels, or too many of them
    """

    view: View
    columns: int
    rows: int

    def __post_init__(self) -> None:
        if self.columns < 1 or self.rows < 1 or len(self) > 1 << 24:
            raise InputError(
                f"a picture of {self.columns} × {self.rows} pixels; 1 to 2^24 expected"
            )

    def __len__(self) -> int:
        return self.columns * self.rows

    def picture(self, radiance: Float[np.ndarray, "3 pixel"], *header: str) -> Picture:
        """Return the picture with the given radiance of its pixels."""
        pixels = np.moveaxis(radiance, 0, -1).reshape(self.rows, self.columns, 3)
        return Picture(pixels.astype(np.float32), view=self.view, header=header)


def picture_view_matrices(
    scene: Scene,
    windows: Sequence[Window],
    camera: Camera,
    *,
    direct: bool = False,
    **tracing: Unpack[Tracing],
) -> dict[str, TransferMatrix]:
    """View matrices of a picture by window name: radiance of pixels per patch's.

    Parameters
    ----------
    scene : what light meets on its way from the windows to the eye, without them
    windows : polygons whose front faces the room
    direct : V_d instead of V: nothing but the windows, and what they shine on
    samples : paths per pixel
    relative_error : instead of samples: root mean square of the pixels' standard
        errors to reach under windows of uniform radiance, over their mean
    bounces : most diffuse reflections, as Radiance's -ab; no limit by default

    The other parameters are those of `view_matrix`.
    """
    names = [window.name for window in windows]
    if not names or len(set(names)) < len(names):
        raise InputError(f"windows {names}; at least one, and different names expected")
    effort = replace(matrix_effort(**tracing), batches=_BATCHES, components=False)
    estimate = trace_pixel_view(
        scene,
        tuple(windows),
        camera.view,
        camera.columns,
        camera.rows,
        effort,
        direct=direct,
    )
    warn_if_short(estimate, "view matrix of the picture", effort)
    found, first = {}, 0
    for window in windows:
        columns = window_axis("interior", window.partition, window.name)
        part = estimate.values[:, :, first : first + columns.size]
        values = _three(part.astype(np.float32))
        found[window.name] = TransferMatrix(values, pixel_axis(len(camera)), columns)
        first += columns.size
    return found


SunPictures = Callable[
    [Int[np.ndarray, " sun"]], Float[np.ndarray, "channel pixel sun"]
]


def sun_pictures(
    scene: Scene,
    windows: Sequence[Window],
    window: str,
    bsdf: Bsdf,
    camera: Camera,
    *,
    suns: Float[np.ndarray, "sun 3"],
    peak: bool = False,
    samples: int = 16,
    seed: int = 0,
    device: Device = "auto",
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> SunPictures:
    """Return a function that traces direct-sun coefficients of a picture when asked.

    It takes numbers of suns and returns their coefficients; see
    `picture_sun_coefficients`. A year has thousands of suns, more than memory holds.
    """
    number = check_window(windows, window, bsdf, suns, samples)
    behind = suns @ windows[number].frame.normal < 0
    where = executor or Local()
    job = PixelSunJob(
        scene,
        tuple(windows),
        number,
        bsdf,
        camera.view,
        camera.columns,
        camera.rows,
        suns,
        peak=peak,
        samples=samples,
        seed=seed,
        device=where.resolve(device),
    )

    # Nothing is traced yet, but a plan takes note
    accepted = where.accepts(job, Goal(samples))

    def coefficients(asked: np.ndarray) -> np.ndarray:
        shape = 3, len(camera), len(asked)
        if not accepted:
            return np.broadcast_to(np.float32(0), shape)
        values = np.zeros(shape, np.float32)
        lit = behind[asked]
        if lit.any():
            chosen = asked[lit]
            values[..., lit] = trace_pixel_sun(
                job, chosen, executor=where, progress=progress
            )
        return values

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
    samples: int = 16,
    seed: int = 0,
    device: Device = "auto",
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> TransferMatrix:
    """Direct-sun coefficients of a picture: radiance per normal irradiance [1/sr].

    What the window shows of the sun (C_F-ds) and what the room's surfaces reflect of
    it (C_R-ds). See `sun_coefficients` for the parameters.

    Parameters
    ----------
    samples : paths per pixel and sun
    """
    trace = sun_pictures(
        scene, windows, window, bsdf, camera, suns=suns, peak=peak, samples=samples,
        seed=seed, device=device, executor=executor, progress=progress,
    )  # fmt: skip
    values = trace(np.arange(len(suns)))
    return TransferMatrix(values, pixel_axis(len(camera)), sun_axis(len(suns)))


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


def _three(values: Float[np.ndarray, "channel row column"]) -> np.ndarray:
    # Pictures have three channels; grey rooms have three equal ones
    return np.broadcast_to(values, (3, *values.shape[1:]))
