"""Positions and directions of the sensors of a report."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int


@dataclass(frozen=True, eq=False)
class SensorPoints:
    """Positions and directions of sensors.

    Attributes
    ----------
    names : names of the sensors
    grids : name of the grid of each sensor
    position : position of each sensor [m]
    direction : unit normal of each sensor
    """

    names: tuple[str, ...]
    grids: tuple[str, ...]
    position: Float[np.ndarray, "sensor 3"]
    direction: Float[np.ndarray, "sensor 3"]

    def __len__(self) -> int:
        return len(self.names)

    def by_grid(self) -> dict[str, Int[np.ndarray, " member"]]:
        """Return the indices of the sensors of each grid, in the order of the grids."""
        grids = np.array(self.grids, dtype=object)
        return {name: np.flatnonzero(grids == name) for name in dict.fromkeys(grids)}
