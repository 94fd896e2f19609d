"""Reciprocal of a scattering function that has no exact tabulated reciprocal.

The reciprocal of a rank 3 tensor tree is not a rank 3 tree. BSDF values of the
reciprocal are exact; integrals and samples use a grid of exit directions that is finer
than the tree cells.
"""

from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import (
    Directions,
    ExitIncident,
    Points2,
    Values,
    Vector,
)
from clerestory.bsdf.inverse_sampling import sample_square
from clerestory.bsdf.patch_overlap import opposite_patches
from clerestory.bsdf.scattering_function import CellValues, ScatteringFunction
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.shirley_chiu import cell_centres, directions_from_square

# The grid of exit directions has 2^n cells along each axis; n is the tree depth plus
# _FINER, limited to _COARSEST…_FINEST.
_FINER, _COARSEST, _FINEST = 2, 8, 10


@final
@dataclass(frozen=True, eq=False)
class ReciprocalFunction(ScatteringFunction):
    """A scattering function with incident and exit directions exchanged."""

    forward: ScatteringFunction  # original scattering function
    # Number of tree levels of `forward`; the smallest cells have edge 2^-halvings
    halvings: int

    def evaluate(self, incident: Directions, leaving: Directions) -> Values:
        return self.forward.evaluate(leaving, incident)

    def hemispherical(self, incident: Directions) -> Values:
        each = np.reshape(incident, (-1, 3))
        grid = self._grid()
        share = [np.pi * self._over(direction, grid).mean() for direction in each]
        return np.reshape(np.array(share), np.shape(incident)[:-1])

    def sample(self, incident: Directions, u: Points2) -> tuple[Directions, Values]:
        shape = np.shape(incident)[:-1]
        each, which = np.unique(
            np.reshape(incident, (-1, 3)), axis=0, return_inverse=True
        )
        which, u = which.ravel(), np.reshape(u, (-1, 2))
        leaving, density = np.empty((len(u), 3)), np.empty(len(u))
        grid = self._grid()
        for number, direction in enumerate(each):
            of = which == number
            value = self._over(direction, grid)
            leaving[of], density[of] = sample_square(value, u[of])
        return leaving.reshape(*shape, 3), density.reshape(shape)

    def resolution(self, incident: Directions, leaving: Directions) -> Values:
        return self.forward.resolution(leaving, incident)

    def cell_values(self, incident: Directions, leaving: Directions) -> CellValues:
        return self.forward.cell_values(leaving, incident)

    def average(self, exits: RingPartition, incidents: RingPartition) -> ExitIncident:
        table = self.forward.average(incidents, exits)
        opposite = np.ix_(opposite_patches(incidents), opposite_patches(exits))
        return np.ascontiguousarray(table[opposite].T)

    def extrema(self) -> tuple[float, float]:
        return self.forward.extrema()

    def reciprocal(self) -> ScatteringFunction:
        return self.forward

    def tabulated(self) -> ScatteringFunction:
        return self.forward.tabulated().reciprocal()

    def own_partitions(self) -> None:
        """Return None, because the function has no patches."""

    def _grid(self) -> Float[np.ndarray, "cells 3"]:
        # Directions to the centres of the grid cells in row-major order
        halvings = min(max(self.halvings + _FINER, _COARSEST), _FINEST)
        return directions_from_square(*cell_centres(halvings))

    def _over(self, incident: Vector, grid: Directions) -> Values:
        return self.evaluate(np.broadcast_to(incident, grid.shape), grid)
