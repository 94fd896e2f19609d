"""Interpolated scattering function of a goniophotometer measurement.

The function has no patches or cells; the fitted lobes limit its angular resolution.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np
from jaxtyping import Float, Int

from clerestory.array_types import (
    Directions,
    ExitIncident,
    Points2,
    Values,
    Vector,
)
from clerestory.bsdf.inverse_sampling import sample_square
from clerestory.bsdf.patch_overlap import patches_in_cells
from clerestory.bsdf.reciprocal_function import ReciprocalFunction
from clerestory.bsdf.scattering_function import CellValues, ScatteringFunction
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.gonio.angles import directions_over_disc, undeviated, upper_hemisphere
from clerestory.gonio.displacement_interpolation import (
    Particles,
    displace,
    edge_particles,
    triangle_particles,
)
from clerestory.gonio.flux_interpolation import Flux, flux_surface
from clerestory.gonio.incident_mesh import Place, flat_weights, locate
from clerestory.gonio.lobe_motion import mean_motion, with_unmatched_lobes
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.optimal_transport import Network
from clerestory.gonio.raster import Raster
from clerestory.gonio.symmetry import Symmetry, fold
from clerestory.gonio.tree_export import to_tree
from clerestory.hemisphere.partition import RingPartition

# The grid for sampling and patch averages has 2^6 × 2^6 cells; the smallest Klems patch
# contains forty cells.
_GATHER = 6

# Numbers of rings and azimuths of incident directions in a patch average.
_PATCH_RINGS, _PATCH_AZIMUTHS = 2, 4

# log2 of the number of cells along each axis of reciprocal and tabulated functions.
_HALVINGS = 6


@final
@dataclass(frozen=True, eq=False)
class Interpolant(ScatteringFunction):
    """Scattering function interpolated between measured incident directions."""

    # Lobes at the measured directions, and transport plans between them
    network: Network
    symmetry: Symmetry  # symmetry of the layer

    @cached_property
    def mean_motion(self) -> float:
        """Mean ratio of lobe displacement to displacement of the undeviated direction.

        The ratio is 1 for a clear pane and 0 for a diffuser; it is used to extrapolate
        lobe centres outside the measured incident directions.
        """
        return mean_motion(self.network)

    @cached_property
    def _moving(self) -> Network:
        return with_unmatched_lobes(self.network, mean_motion=self.mean_motion)

    @cached_property
    def _flux(self) -> Flux:
        return flux_surface(
            self.network.mesh,
            np.array([lobes.total for lobes in self.network.lobes]),
            symmetry=self.symmetry,
            quadrant=self.network.quadrant,
        )

    @cached_property
    def _particles(self) -> dict[tuple[bool, int], Particles]:
        return {}

    @cached_property
    def _tree(self) -> ScatteringTree:
        return to_tree(self, halvings=_HALVINGS)

    def __reduce__(self) -> tuple[type, tuple[Network, Symmetry]]:
        return Interpolant, (self.network, self.symmetry)

    def lobes(self, incident: Vector) -> Lobes:
        """Lobes of the scattered light for one incident direction."""
        return next(self.lobes_of(incident[None]))

    def lobes_of(self, incident: Directions) -> Iterator[Lobes]:
        """Lobes of the scattered light for each incident direction."""
        source = upper_hemisphere(np.asarray(incident, dtype=float))
        source = source / np.linalg.norm(source, axis=1, keepdims=True)
        folded, matrices = fold(source, self.symmetry, self.network.quadrant)
        place = locate(self.network.mesh, folded)
        total = self._flux.at(folded)
        for k, matrix in enumerate(matrices):
            yield self._at(place, k, folded[k], float(total[k])).transformed(matrix)

    def evaluate(self, incident: Directions, leaving: Directions) -> Values:
        incident, leaving = np.broadcast_arrays(incident, leaving)
        shape = incident.shape[:-1]
        source = incident.reshape(-1, 3)
        exits = upper_hemisphere(leaving.reshape(-1, 3))
        value = np.empty(len(source))
        for group, lobes in self._grouped(source):
            value[group] = lobes.evaluate(exits[group])
        return value.reshape(shape)

    def hemispherical(self, incident: Directions) -> Values:
        source = np.reshape(incident, (-1, 3))
        share = np.empty(len(source))
        for group, lobes in self._grouped(source):
            share[group] = lobes.total
        return share.reshape(np.shape(incident)[:-1])

    def sample(self, incident: Directions, u: Points2) -> tuple[Directions, Values]:
        source, u = np.reshape(incident, (-1, 3)), np.reshape(u, (-1, 2))
        leaving, density = np.empty((len(source), 3)), np.empty(len(source))
        raster = Raster.of(_GATHER)
        for group, lobes in self._grouped(source):
            grid = raster.cells(lobes)
            leaving[group], density[group] = sample_square(grid, u[group])
        shape = np.shape(incident)[:-1]
        return leaving.reshape(*shape, 3), density.reshape(shape)

    def resolution(self, incident: Directions, leaving: Directions) -> Values:
        """Projected solid angle of the cells of the sampling grid [sr]."""
        shape = np.broadcast_shapes(np.shape(incident), np.shape(leaving))[:-1]
        return np.full(shape, np.pi * 0.25**_GATHER)

    def cell_values(self, incident: Directions, leaving: Directions) -> CellValues:
        """Values, and numbers that all differ: each pair is interpolated by itself."""
        value, size = (f(incident, leaving) for f in (self.evaluate, self.resolution))
        return CellValues(value, size, np.arange(value.size).reshape(value.shape))

    def average(self, exits: RingPartition, incidents: RingPartition) -> ExitIncident:
        into = patches_in_cells(exits, _GATHER)
        raster = Raster.of(_GATHER)
        # Stratified points: rings of equal area, with staggered azimuths
        ring, turn = np.indices((_PATCH_RINGS, _PATCH_AZIMUTHS)).reshape(2, -1)
        first = (ring + 0.5) / _PATCH_RINGS
        u = np.stack([first, (turn + first) / _PATCH_AZIMUTHS], axis=-1)
        patch = np.repeat(np.arange(len(incidents)), len(u))
        source = incidents.sample(patch, np.tile(u, (len(incidents), 1)))
        table = np.zeros((len(exits), len(incidents)))
        for k, lobes in enumerate(self.lobes_of(undeviated(source))):
            table[:, patch[k]] += into @ raster.cells(lobes)
        measure = exits.projected_solid_angles()[:, None] * len(u)
        return np.asarray(table / measure)

    def extrema(self) -> tuple[float, float]:
        """Zero, and the largest BSDF over the measured incident directions [1/sr]."""
        peaks = [
            lobes.evaluate(lobes.strongest()[None]).max()
            for lobes in self.network.lobes
        ]
        return 0.0, float(max(peaks))

    def reciprocal(self) -> ScatteringFunction:
        return ReciprocalFunction(self, halvings=_HALVINGS)

    def tabulated(self) -> ScatteringTree:
        """Tensor tree with 2^6 cells along each axis; calculated once."""
        return self._tree

    def own_partitions(self) -> None:
        """Return None, because an interpolant has no patches."""

    def _at(self, place: Place, k: int, wanted: Vector, total: float) -> Lobes:
        mesh, lobes = self.network.mesh, self._moving.lobes
        number, s, t = int(place.simplex[k]), float(place.s[k]), float(place.t[k])
        on_edge = bool(place.on_edge[k])
        corner = (mesh.edges if on_edge else mesh.triangles)[number]
        parts = lobes[corner[0]], lobes[corner[1]], lobes[corner[-1]]
        # Cache the lobe matches of a triangle or an edge
        particles = self._particles.get((on_edge, number))
        if particles is None:
            particles = (
                edge_particles(self._moving.plans[number])
                if on_edge
                else triangle_particles(*self._moving.plans_of(number))
            )
            self._particles[on_edge, number] = particles
        weights, middle = flat_weights(mesh.vertices[corner], place.found[k])
        found = displace(particles, parts, s=s, t=t, weights=weights, total=total)
        if on_edge:
            # Move lobes in proportion to the offset of the direction from the edge
            shift = (middle - wanted[:2]) * self.mean_motion
            centre = directions_over_disc(found.centre[:, :2] + shift)
            found = replace(found, centre=centre) if np.hypot(*shift) >= 1e-9 else found
        return found

    def _grouped(
        self, source: Float[np.ndarray, "directions 3"]
    ) -> Iterator[tuple[Int[np.ndarray, " group"], Lobes]]:
        # Group equal directions, which have the same lobes
        unique, which = np.unique(source, axis=0, return_inverse=True)
        order = np.argsort(which.ravel(), kind="stable")
        limits = np.searchsorted(which.ravel()[order], np.arange(len(unique) + 1))
        for k, lobes in enumerate(self.lobes_of(unique)):
            yield order[limits[k] : limits[k + 1]], lobes
