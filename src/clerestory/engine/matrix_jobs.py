"""Jobs of transfer matrices, and the definitions of their relative errors.

    V  sensors or pixels × interior patches       ViewJob, PixelViewJob
    D  exterior patches × sky                     DaylightJob
    F  exterior patches × exterior patches of ports     FacadeJob
    C  sensors × sky                              CoefficientsJob

Jobs are plain values and need no compute device; `matrix_tracers` traces them.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from jaxtyping import Float

from clerestory.engine.channels import channels_of
from clerestory.engine.controller import EstimatedJob
from clerestory.engine.sums import Sums, variance
from clerestory.hemisphere.reinhart import SkyPartition
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.scene.window import Window

# Rows below this fraction of the mean row need not reach the relative error
_DARK = 0.01


@dataclass(frozen=True, eq=False, kw_only=True)
class _SensorJob(EstimatedJob):
    # Rows of sensors; each is traced until the irradiance from windows or a sky of
    # uniform radiance reaches the relative error
    together: ClassVar[bool] = False

    sensors: Sensors

    def error(self, sums: Sums) -> Float[np.ndarray, " row"]:
        """Relative error of each sensor's irradiance, summed over all columns."""
        return row_errors(sums)


@dataclass(frozen=True, eq=False, kw_only=True)
class ViewJob(_SensorJob):
    """From irradiance sensors to window patches (columns: window by window)."""

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_view")

    windows: tuple[Window, ...]

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Rows, batches, columns and channels."""
        rows, columns = len(self.sensors), patches_of(self.windows)
        return rows, self.batches, columns, channels_of(self.scene)


@dataclass(frozen=True, eq=False, kw_only=True)
class CoefficientsJob(_SensorJob):
    """From irradiance sensors to the patches of the sky."""

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_coefficients")

    sky: SkyPartition

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Rows, batches, columns and channels."""
        rows, columns = len(self.sensors), len(self.sky)
        return rows, self.batches, columns, channels_of(self.scene)


@dataclass(frozen=True, eq=False, kw_only=True)
class _WindowJob(EstimatedJob):
    # Rows of a window's patches on the outer side
    together: ClassVar[bool] = True

    window: Window

    def error(self, sums: Sums) -> float:
        """Error of the window's irradiance from one column, relative to the mean.

        The root mean square over the columns: it applies to the sun in any patch, not
        only to a uniform sky.
        """
        projected = self.window.partition.projected_solid_angles()
        irradiance = np.einsum("r,rbcx->bcx", projected, sums.means())
        return mean_error(irradiance, axis=0)


@dataclass(frozen=True, eq=False, kw_only=True)
class DaylightJob(_WindowJob):
    """From the outer side of a window's patches to the patches of the sky."""

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_daylight")

    sky: SkyPartition

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Rows, batches, columns and channels."""
        rows, columns = len(self.window.partition), len(self.sky)
        return rows, self.batches, columns, channels_of(self.scene)


@dataclass(frozen=True, eq=False, kw_only=True)
class FacadeJob(_WindowJob):
    """From the outer side of a window's patches to the patches of its ports.

    Ports are virtual surfaces that, with the wall, enclose the window and its shade.
    """

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_facade")

    ports: tuple[Window, ...]

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Rows, batches, columns and channels."""
        rows, columns = len(self.window.partition), patches_of(self.ports)
        return rows, self.batches, columns, channels_of(self.scene)


@dataclass(frozen=True, eq=False, kw_only=True)
class PixelViewJob(EstimatedJob):
    """From the pixels of a view to the patches of windows.

    Attributes
    ----------
    columns, rows : size of the picture
    direct : whether paths end at the first surface
    """

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_pixel_view")
    together: ClassVar[bool] = False

    windows: tuple[Window, ...]
    view: View
    columns: int
    rows: int
    direct: bool

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Pixels, batches, columns and channels."""
        pixels, columns = self.columns * self.rows, patches_of(self.windows)
        return pixels, self.batches, columns, channels_of(self.scene)

    def error(self, sums: Sums) -> float:
        """Relative error of the mean pixel under windows of uniform radiance."""
        return mean_error(sums.collected(), axis=1)


def patches_of(windows: tuple[Window, ...]) -> int:
    """Return the total number of patches of all windows."""
    return sum(len(window.partition) for window in windows)


def mean_error(values: np.ndarray, *, axis: int) -> float:
    """Return the ratio of the root mean square of standard errors to the mean value.

    Parameters
    ----------
    axis : index of the batch axis
    """
    mean = float(values.mean())
    error = float(np.sqrt(np.mean(variance(values, axis=axis))))
    return error / mean if mean > 0 else 0.0


def row_errors(sums: Sums) -> Float[np.ndarray, " row"]:
    """Return the relative error of each row, summed over its columns.

    For rows below 1 % of the mean row, the error is relative to 1 % of the mean row.
    """
    irradiance = sums.collected()
    mean = irradiance.mean(axis=1)
    error = np.sqrt(variance(irradiance, axis=1))
    floor = np.maximum(mean, _DARK * mean.mean())
    share: np.ndarray = error / np.where(floor > 0, floor, 1)
    return np.asarray(share.max(axis=-1))
