"""Positions and directions of the sensors of a report."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int


@dataclass(frozen=True, eq=False)
class SensorPoints:
    """Where the sensors are.

    Attributes
    ----------
    names : one per sensor
    grids : name of the grid each belongs to
    position : points [m]
    direction : unit vectors they face
    """

    names: tuple[str, ...]
    grids: tuple[str, ...]
    position: Float[np.ndarray, "sensor 3"]
    direction: Float[np.ndarray, "sensor 3"]

    def __len__(self) -> int:
        return len(self.names)

    def by_grid(self) -> dict[str, Int[np.ndarray, " member"]]:
        """Return the numbers of the sensors of each grid, in the order of the grids."""
        grids = np.array(self.grids, dtype=object)
        return {name: np.flatnonzero(grids == name) for name in dict.fromkeys(grids)}
