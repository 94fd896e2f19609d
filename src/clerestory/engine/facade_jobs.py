"""Job of façade matrices: from the outer side of a window to ports before it.

    F  exterior patches of the window × exterior patches of the ports     trace_facade

Nothing here needs a compute device; what traces the job lies in `launches`.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from clerestory.engine.channels import channels_of
from clerestory.engine.controller import MatrixJob, estimate
from clerestory.engine.effort import Effort
from clerestory.engine.matrix_jobs import patches_of, walk_of, window_irradiance
from clerestory.engine.sums import Estimate, Sums
from clerestory.scene.model import Scene
from clerestory.scene.window import Window


@dataclass(frozen=True, eq=False)
class FacadeJob(MatrixJob):
    """From the outer side of a window's patches to those of ports before it."""

    tracer: ClassVar[tuple[str, str]] = ("matrix_tracers", "prepare_facade")
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
        rows, columns = len(self.window.partition), patches_of(self.ports)
        return rows, self.batches, columns, channels_of(self.scene)

    def unfinished(self, sums: Sums, aim: float) -> tuple[np.ndarray, float]:
        """Judge the window's irradiance from each patch of the ports."""
        return window_irradiance(self.window, sums, aim)


def trace_facade(
    scene: Scene, window: Window, ports: tuple[Window, ...], effort: Effort
) -> Estimate:
    """Trace from a window's outer patches to all ports (columns: port by port).

    The relative error is the root mean square, over the ports' patches, of the error
    of the window's irradiance from one patch, relative to the mean patch.
    """
    return estimate(FacadeJob(scene, window, ports, *walk_of(effort)), effort)
