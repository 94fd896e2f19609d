"""Scattering function as a matrix from incident patches to exit patches.

Exit patch i is patch i of the exit partition, mirrored in z for light that leaves to
the outdoor side. Incident patch i contains the directions from which undeviated light
leaves through exit patch i on the other side; specularly reflected light leaves through
exit patch i on the same side.
"""

from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, ExitIncident, Indices, Points2, Values
from clerestory.brief_repr import brief
from clerestory.bsdf.inverse_sampling import choose_cells
from clerestory.bsdf.patch_overlap import opposite_patches, patches_in_patches
from clerestory.bsdf.scattering_function import CHUNK, CellValues, ScatteringFunction
from clerestory.checks import not_negative, require
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.patch_lookup import find_patches


@final
@dataclass(frozen=True, eq=False)
class ScatteringMatrix(ScatteringFunction):
    """One scattering function of a layer, in one channel, as a matrix of patches."""

    # BSDF from each incident patch to each exit patch [1/sr]
    values: Float[np.ndarray, "exit incident"]
    exits: RingPartition  # partition of the exit hemisphere
    incidents: RingPartition  # partition of the incident hemisphere
    # Standard error of each BSDF value [1/sr]; None if unknown
    standard_error: Float[np.ndarray, "exit incident"] | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        require(
            self.values.shape == (len(self.exits), len(self.incidents)),
            f"BSDF matrix has shape {self.values.shape}; {len(self.exits)} exit patches"
            f" by {len(self.incidents)} incident patches expected",
        )
        not_negative(self.values, "BSDF", unit="1/sr")

    def direct_hemispherical(self) -> Values:
        """Directional-hemispherical transmittance or reflectance per incident patch."""
        return np.asarray(self.exits.projected_solid_angles() @ self.values)

    def diffuse(self) -> float:
        """Hemispherical-hemispherical (diffuse) transmittance or reflectance."""
        weight = self.incidents.projected_solid_angles()
        return float(self.direct_hemispherical() @ weight / weight.sum())

    def flux_factors(self) -> ExitIncident:
        """Exit radiance per unit radiance in each incident patch."""
        return np.asarray(self.values * self.incidents.projected_solid_angles())

    def evaluate(self, incident: Directions, leaving: Directions) -> Values:
        incident, leaving = np.broadcast_arrays(incident, leaving)
        value = np.empty(incident.shape[:-1])
        flat, i, o = value.reshape(-1), incident.reshape(-1, 3), leaving.reshape(-1, 3)
        table, columns = self.values.ravel(), len(self.incidents)
        for start in range(0, len(flat), CHUNK):
            part = slice(start, start + CHUNK)
            place = find_patches(self.exits, o[part]).astype(np.int64) * columns
            place += find_patches(self.incidents, -i[part])
            flat[part] = np.take(table, place)
        return value

    def hemispherical(self, incident: Directions) -> Values:
        return np.asarray(self.direct_hemispherical()[self._enter(incident)])

    def sample(self, incident: Directions, u: Points2) -> tuple[Directions, Values]:
        shape = np.shape(incident)[:-1]
        enter, u = self._enter(np.reshape(incident, (-1, 3))), np.reshape(u, (-1, 2))
        flux = self.exits.projected_solid_angles()[:, None] * self.values
        first = enter * len(self.exits)
        chosen, rest, total = choose_cells(
            flux.T.ravel(), first, first + len(self.exits), u[..., 0]
        )
        patch = chosen - first
        leaving = self.exits.sample(patch, np.stack([rest, u[..., 1]], axis=-1))
        some = total > 0
        density = self.values[patch, enter] / np.where(some, total, 1)
        leaving = np.where(some[..., None], leaving, [0.0, 0.0, 1.0])
        density = np.where(some, density * leaving[:, 2], 0)
        return leaving.reshape(*shape, 3), density.reshape(shape)

    def resolution(self, incident: Directions, leaving: Directions) -> Values:
        leaving, _ = np.broadcast_arrays(leaving, incident)
        patch = find_patches(self.exits, leaving.reshape(-1, 3))
        size = self.exits.projected_solid_angles()[patch]
        return np.asarray(size.reshape(leaving.shape[:-1]))

    def cell_values(self, incident: Directions, leaving: Directions) -> CellValues:
        leaving, incident = np.broadcast_arrays(leaving, incident)
        patch = find_patches(self.exits, leaving.reshape(-1, 3)).astype(np.int64)
        patch = patch * len(self.incidents) + self._enter(incident).ravel()
        return CellValues(
            self.evaluate(incident, leaving),
            self.resolution(incident, leaving),
            patch.reshape(leaving.shape[:-1]),
        )

    def average(self, exits: RingPartition, incidents: RingPartition) -> ExitIncident:
        if exits.matches(self.exits) and incidents.matches(self.incidents):
            return self.values
        to = patches_in_patches(self.exits, exits)
        come = patches_in_patches(self.incidents, incidents)
        flux = come.T @ (to.T @ self.values).T
        measure = np.outer(
            exits.projected_solid_angles(), incidents.projected_solid_angles()
        )
        return np.asarray(flux.T / measure)

    def extrema(self) -> tuple[float, float]:
        return float(self.values.min()), float(self.values.max())

    def reciprocal(self) -> "ScatteringMatrix":
        incident = opposite_patches(self.exits)
        leaving = opposite_patches(self.incidents)
        return ScatteringMatrix(
            self.values[np.ix_(incident, leaving)].T, self.incidents, self.exits
        )

    def tabulated(self) -> "ScatteringMatrix":
        return self

    def own_partitions(self) -> tuple[RingPartition, RingPartition]:
        return self.exits, self.incidents

    def _enter(self, incident: Directions) -> Indices:
        patch = find_patches(self.incidents, -np.reshape(incident, (-1, 3)))
        return np.asarray(patch.reshape(np.shape(incident)[:-1]))
