"""Jobs of transfer matrices, and the definitions of their relative errors.

    V  sensors or pixels × interior patches       ViewJob, PixelViewJob
    D  exterior patches × sky                     DaylightJob
    F  exterior patches × exterior patches of ports     FacadeJob
    C  sensors × sky                              CoefficientsJob
    T  patches × patches of a sample area         SlabJob

Jobs are plain data and need no compute device; `matrix_tracers` traces them.
"""

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.channels import channels_of
from clerestory.engine.controller import EstimatedJob
from clerestory.engine.derivative_sums import Places, values_of
from clerestory.engine.sums import Sums, variance
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.reinhart import SkyPartition
from clerestory.image.camera import PixelsOrCells
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

# Rows with a sum below this fraction of the mean sum need not reach the target error
_DARK = 0.01

# Sensors with less irradiance from windows or a sky of unit radiance need not reach it
# either [sr]: 0.5 % of that of an unobstructed sensor
_FAINT = 5e-3 * np.pi


@dataclass(frozen=True, eq=False, kw_only=True)
class MatrixJob(EstimatedJob):
    """A job whose rows are receivers, and whose columns are patches."""

    @property
    @abstractmethod
    def size(self) -> tuple[int, int]:
        """Numbers of rows and columns."""

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Numbers of rows, places (`derivative_sums`), columns and channels."""
        rows, columns = self.size
        return rows, self.places.count, columns, channels_of(self.scene)

    @property
    def places(self) -> Places:
        """Places of a row: batches, and those of the derivatives."""
        return Places(self.batches, len(self.derivatives))


@dataclass(frozen=True, eq=False, kw_only=True)
class _SensorJob(MatrixJob):
    # Job traced until the irradiance of each sensor, from windows or a sky of uniform
    # radiance, reaches the target relative error
    together: ClassVar[bool] = False
    spectral_paths: ClassVar[bool] = True

    sensors: Sensors

    def error(self, sums: Sums) -> Float[np.ndarray, " row"]:
        """Relative error of the irradiance of each sensor from all columns together."""
        return row_errors(values_of(sums, self.batches), least=_FAINT)


@dataclass(frozen=True, eq=False, kw_only=True)
class ViewJob(_SensorJob):
    """View matrix V: irradiance sensors × patches of all windows, window by window."""

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_view")

    windows: tuple[Window, ...]

    @property
    def size(self) -> tuple[int, int]:
        """Numbers of sensors and patches."""
        return len(self.sensors), patches_of(self.windows)


@dataclass(frozen=True, eq=False, kw_only=True)
class CoefficientsJob(_SensorJob):
    """Daylight coefficients C: irradiance sensors × sky patches.

    If `separate`, there are two columns for each patch: first those of direct light,
    then those of all other light. Direct light passes clear glass unscattered or, if
    `windows` names materials, meets only their surfaces.
    """

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_coefficients")

    sky: SkyPartition
    separate: bool = False
    windows: tuple[str, ...] = ()

    @property
    def size(self) -> tuple[int, int]:
        """Numbers of sensors and of columns."""
        return len(self.sensors), len(self.sky) * (2 if self.separate else 1)


@dataclass(frozen=True, eq=False, kw_only=True)
class _WindowJob(MatrixJob):
    # Job whose rows are the patches of a window on its outer side
    together: ClassVar[bool] = True
    spectral_paths: ClassVar[bool] = True

    window: Window

    def error(self, sums: Sums) -> float:
        """Relative error of the window irradiance from one sky patch or port patch.

        The error is the root mean square over all columns, so it applies to the sun in
        any sky patch, not only to a uniform sky.
        """
        projected = self.window.partition.projected_solid_angles()
        means = values_of(sums, self.batches).means()
        irradiance = np.einsum("r,rbcx->bcx", projected, means)
        return mean_error(irradiance, axis=0)


@dataclass(frozen=True, eq=False, kw_only=True)
class DaylightJob(_WindowJob):
    """Daylight matrix D: patches on the outer side of a window × sky patches."""

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_daylight")

    sky: SkyPartition

    @property
    def size(self) -> tuple[int, int]:
        """Numbers of patches of the window and of the sky."""
        return len(self.window.partition), len(self.sky)


@dataclass(frozen=True, eq=False, kw_only=True)
class FacadeJob(_WindowJob):
    """Facade matrix F: patches on the outer side of a window × patches of its ports.

    Ports are virtual surfaces that, with the wall, enclose the window and its shade.
    """

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_facade")

    ports: tuple[Window, ...]

    @property
    def size(self) -> tuple[int, int]:
        """Numbers of patches of the window and of the ports."""
        return len(self.window.partition), patches_of(self.ports)


@dataclass(frozen=True, eq=False, kw_only=True)
class PixelViewJob(MatrixJob):
    """View matrix V of pixels, or cells of the sphere: × patches of all windows.

    `light` is "direct" for light that comes straight from the windows or after one
    reflection at the first surface, "reflected" for all other light.
    """

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_pixel_view")
    together: ClassVar[bool] = False
    spectral_paths: ClassVar[bool] = True

    windows: tuple[Window, ...]
    camera: PixelsOrCells
    light: Literal["all", "direct", "reflected"] = "all"

    @property
    def size(self) -> tuple[int, int]:
        """Numbers of pixels and patches."""
        return len(self.camera), patches_of(self.windows)

    def error(self, sums: Sums) -> float:
        """RMS error of pixels for windows of equal radiance, relative to the mean."""
        return mean_error(values_of(sums, self.batches).collected(), axis=1)


@dataclass(frozen=True, eq=False, kw_only=True)
class SlabJob(MatrixJob):
    """Flux fractions of a sample area, from incident patches to leaving patches.

    The rows are the incident patches of the first side, then of the second. The columns
    are transmission patches, then reflection patches. The patch of a direction of
    travel is that of (x, y, |z|). An element is a fraction of the incident flux; the
    sum of a row is one minus the absorptance.

    Attributes
    ----------
    box : lower and upper corner of the slab; paths start on its end planes [m]
    sides : whether each traced side is the back, which faces the room
    incidents : indices of the incident patches
    stands_for : number of equivalent patches that each incident patch represents
    """

    tracer: ClassVar[tuple[str, str]] = ("sample_area_matrix", "prepare_slab")
    scalable: ClassVar[bool] = False  # `lower_slab` scales scene and box
    spectral_paths: ClassVar[bool] = True
    together: ClassVar[bool] = True

    box: Float[np.ndarray, "2 3"]
    partition: RingPartition
    periodic: bool
    sides: tuple[bool, ...]
    incidents: Int[np.ndarray, " incident"]
    stands_for: Int[np.ndarray, " incident"]

    @property
    def size(self) -> tuple[int, int]:
        """Numbers of incident patches and of leaving patches."""
        return len(self.sides) * len(self.incidents), 2 * len(self.partition)

    def error(self, sums: Sums) -> float:
        """RMS error of the BSDF over all pairs of patches, relative to the mean."""
        alike = self.stands_for / self.stands_for.mean()
        weight = np.tile(alike, len(self.sides))[:, None, None]
        measure = np.tile(self.partition.projected_solid_angles(), 2)
        values = sums.means() / measure[:, None]
        error = float(np.sqrt(np.mean(weight * variance(values, axis=1))))
        mean = float(np.mean(weight[..., None] * values))
        return error / mean if mean > 0 else 0.0


def patches_of(windows: tuple[Window, ...]) -> int:
    """Return the total number of patches of all windows."""
    return sum(len(window.partition) for window in windows)


def mean_error(values: np.ndarray, *, axis: int) -> float:
    """Return the ratio of the root mean square of standard errors to the mean value.

    `axis` is the index of the batch axis.
    """
    mean = float(values.mean())
    error = float(np.sqrt(np.mean(variance(values, axis=axis))))
    return error / mean if mean > 0 else 0.0


def row_errors(sums: Sums, *, least: float = 0.0) -> Float[np.ndarray, " row"]:
    """Return the relative standard error of the sum of each row.

    For sums below 1 % of the mean sum or below `least`, the error is relative to the
    larger of these.
    """
    irradiance = sums.collected()
    mean = irradiance.mean(axis=1)
    error = np.sqrt(variance(irradiance, axis=1))
    floor = np.maximum(mean, max(_DARK * mean.mean(), least))
    share: np.ndarray = error / np.where(floor > 0, floor, 1)
    return np.asarray(share.max(axis=-1))
