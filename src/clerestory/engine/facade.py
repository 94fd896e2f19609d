"""Job of façade matrices: from the outer side of a window to ports before it.

    F  exterior patches of the window × exterior patches of the ports     trace_facade

Nothing here needs a compute device; what traces the job lies in `launches`.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from clerestory.engine.estimate import (
    Effort,
    Estimate,
    Sums,
    all_or_none,
    estimate,
    trial_rows,
    variance,
)
from clerestory.engine.grey import channels_of
from clerestory.engine.work import Unit
from clerestory.scene.model import Scene
from clerestory.scene.window import Window


@dataclass(frozen=True, eq=False)
class FacadeJob:
    """From the outer side of a window's patches to those of ports before it."""

    tracer: ClassVar[tuple[str, str]] = ("launches", "prepare_facade")
    together: ClassVar[bool] = True

    scene: Scene
    window: Window
    ports: tuple[Window, ...]
    bounces: int | None
    seed: int
    batches: int
    device: Literal["cpu", "cuda"]

    @cached_property
    def shape(self) -> tuple[int, int, int, int]:
        """Rows, batches, columns and channels."""
        columns = sum(len(port.partition) for port in self.ports)
        rows = len(self.window.partition)
        return rows, self.batches, columns, channels_of(self.scene)

    @property
    def receivers(self) -> int:
        """Rows of the matrix."""
        return self.shape[0]

    def trial(self, paths: int) -> Unit:
        """Return a unit of rows spread over the matrix."""
        return trial_rows(self, paths)

    def unfinished(self, sums: Sums, aim: float) -> tuple[np.ndarray, float]:
        """Judge the window's irradiance from each patch of the ports."""
        projected = self.window.partition.projected_solid_angles()
        irradiance = np.einsum("r,rbcx->bcx", projected, sums.means())
        error = float(np.sqrt(np.mean(variance(irradiance, axis=0))))
        return all_or_none(sums, error, float(np.mean(irradiance)), aim)


def trace_facade(
    scene: Scene, window: Window, ports: tuple[Window, ...], effort: Effort
) -> Estimate:
    """Trace from a window's outer patches to all ports (columns: port by port).

    The relative error is the root mean square, over the ports' patches, of the error
    of the window's irradiance from one patch, relative to the mean patch.
    """
    walk = effort.bounces, effort.seed, effort.batches, effort.device
    return estimate(FacadeJob(scene, window, ports, *walk), effort)
