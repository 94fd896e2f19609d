"""Jobs that trace transfer matrices, and when their rows are good enough.

    V  sensors or pixels × interior patches     trace_view, trace_pixel_view
    D  exterior patches × sky                   trace_daylight
    C  sensors × sky                            trace_coefficients

Nothing here needs a compute device: the jobs are plain values, and what traces them
lies in `launches` and `view_pixels`.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np
from jaxtyping import Float

from clerestory.engine.channels import channels_of
from clerestory.engine.controller import (
    MatrixJob,
    all_or_none,
    estimate,
    variance,
)
from clerestory.engine.effort import Effort
from clerestory.engine.sums import BATCHES, Estimate, Sums
from clerestory.hemisphere.reinhart import SkyPartition
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.scene.window import Window

# Rows darker than this share of the mean row need not reach the relative error.
_DARK = 0.01


@dataclass(frozen=True, eq=False)
class ViewJob(MatrixJob):
    """From irradiance sensors to the patches of windows.

    Attributes
    ----------
    bounces : most gathers; None: no limit
    """

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_view")
    together: ClassVar[bool] = False

    scene: Scene
    windows: tuple[Window, ...]
    sensors: Sensors
    bounces: int | None
    seed: int
    batches: int
    device: Literal["cpu", "cuda"]

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Rows, batches, columns and channels."""
        rows, columns = len(self.sensors), patches_of(self.windows)
        return rows, self.batches, columns, channels_of(self.scene)

    def unfinished(self, sums: Sums, aim: float) -> tuple[np.ndarray, float]:
        """Judge each sensor's irradiance under windows of uniform radiance."""
        return dim_rows(sums, aim)


@dataclass(frozen=True, eq=False)
class CoefficientsJob(MatrixJob):
    """From irradiance sensors to the patches of the sky."""

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_coefficients")
    together: ClassVar[bool] = False

    scene: Scene
    sky: SkyPartition
    sensors: Sensors
    bounces: int | None
    seed: int
    batches: int
    device: Literal["cpu", "cuda"]

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Rows, batches, columns and channels."""
        rows, columns = len(self.sensors), len(self.sky)
        return rows, self.batches, columns, channels_of(self.scene)

    def unfinished(self, sums: Sums, aim: float) -> tuple[np.ndarray, float]:
        """Judge each sensor's irradiance under a uniform sky."""
        return dim_rows(sums, aim)


@dataclass(frozen=True, eq=False)
class DaylightJob(MatrixJob):
    """From the outer side of a window's patches to the patches of the sky."""

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_daylight")
    together: ClassVar[bool] = True

    scene: Scene
    window: Window
    sky: SkyPartition
    bounces: int | None
    seed: int
    batches: int
    device: Literal["cpu", "cuda"]

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Rows, batches, columns and channels."""
        rows, columns = len(self.window.partition), len(self.sky)
        return rows, self.batches, columns, channels_of(self.scene)

    def unfinished(self, sums: Sums, aim: float) -> tuple[np.ndarray, float]:
        """Judge the window's irradiance from each patch of the sky."""
        return window_irradiance(self.window, sums, aim)


@dataclass(frozen=True, eq=False)
class PixelViewJob(MatrixJob):
    """From the pixels of a view to the patches of windows.

    Attributes
    ----------
    columns, rows : size of the picture
    direct : whether paths stop at the first surface
    """

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_pixel_view")
    together: ClassVar[bool] = False

    scene: Scene
    windows: tuple[Window, ...]
    view: View
    columns: int
    rows: int
    direct: bool
    bounces: int | None
    seed: int
    batches: int
    device: Literal["cpu", "cuda"]

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Pixels, batches, columns and channels."""
        pixels, columns = self.columns * self.rows, patches_of(self.windows)
        return pixels, self.batches, columns, channels_of(self.scene)

    def unfinished(self, sums: Sums, aim: float) -> tuple[np.ndarray, float]:
        """Judge the mean pixel under windows of uniform radiance."""
        radiance = sums.collected()
        error = float(np.sqrt(np.mean(variance(radiance, axis=1))))
        return all_or_none(sums, error, float(radiance.mean()), aim)


def trace_view(
    scene: Scene, windows: tuple[Window, ...], sensors: Sensors, effort: Effort
) -> Estimate:
    """Trace from sensors to the patches of all windows (columns: window by window).

    The relative error of a row is that of the irradiance [W/m²] under windows of
    uniform radiance; every row goes on until it reaches it.
    """
    return estimate(view_job(scene, windows, sensors, effort), effort)


def view_job(
    scene: Scene, windows: tuple[Window, ...], sensors: Sensors, effort: Effort
) -> ViewJob:
    """Return the job of `trace_view`, to be traced block by block of sensors."""
    return ViewJob(scene, windows, sensors, *walk_of(effort))


def trace_coefficients(
    scene: Scene, sky: SkyPartition, sensors: Sensors, effort: Effort
) -> Estimate:
    """Trace from sensors to the patches of the sky.

    The relative error of a row is that of the irradiance under a uniform sky.
    """
    job = CoefficientsJob(scene, sky, sensors, *walk_of(effort))
    return estimate(job, effort)


def trace_daylight(
    scene: Scene, window: Window, sky: SkyPartition, effort: Effort
) -> Estimate:
    """Trace from the outer side of a window's patches to the patches of the sky.

    The relative error is the root mean square, over the sky's patches, of the error
    of the window's irradiance from one patch, relative to the mean patch: it holds
    for a sun that stands in any patch, not only for a uniform sky.
    """
    job = DaylightJob(scene, window, sky, *walk_of(effort))
    return estimate(job, effort)


def trace_pixel_view(
    scene: Scene,
    windows: tuple[Window, ...],
    view: View,
    columns: int,
    rows: int,
    effort: Effort,
    *,
    direct: bool,
) -> Estimate:
    """Trace from pixels to the patches of all windows (columns: window by window).

    The relative error is that of the mean pixel under windows of uniform radiance.
    """
    picture = view, columns, rows, direct
    job = PixelViewJob(scene, windows, *picture, *walk_of(effort))
    return estimate(job, effort)


def walk_of(
    effort: Effort,
) -> tuple[int | None, int, int, Literal["cpu", "cuda"]]:
    """Return what all jobs end with: bounces, seed, batches and device."""
    batches = effort.batches or BATCHES
    return effort.bounces, effort.seed, batches, effort.resolved_device()


def patches_of(windows: tuple[Window, ...]) -> int:
    """Return how many patches windows have in all."""
    return sum(len(window.partition) for window in windows)


def window_irradiance(
    window: Window, sums: Sums, aim: float
) -> tuple[np.ndarray, float]:
    """Return the judgement of a window's irradiance from each column, all as one."""
    projected = window.partition.projected_solid_angles()
    irradiance = np.einsum("r,rbcx->bcx", projected, sums.means())
    error = float(np.sqrt(np.mean(variance(irradiance, axis=0))))
    return all_or_none(sums, error, float(np.mean(irradiance)), aim)


def dim_rows(sums: Sums, aim: float) -> tuple[np.ndarray, float]:
    """Return the judgement of rows that go on until each reaches its own error."""
    irradiance: Float[np.ndarray, "row batch channel"] = sums.collected()
    mean = irradiance.mean(axis=1)
    error = np.sqrt(variance(irradiance, axis=1))
    floor = np.maximum(mean, _DARK * mean.mean())
    share = np.max(error / np.where(floor > 0, floor, 1), axis=-1)
    ratio = share / aim
    return ratio > 1, float(ratio.max(initial=0.0))
