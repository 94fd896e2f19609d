"""Lobes at incident directions and the transport plans between them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.gonio.incident_mesh import Mesh
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.optimal_transport import Plan


@dataclass(frozen=True, eq=False)
class Network:
    """Lobes at the vertices of a mesh, and transport plans along the mesh edges.

    Attributes
    ----------
    mesh : mesh of incident directions
    lobes : lobes at each incident direction of the mesh
    plans : transport plan of each edge
    quadrant : signs of x and y in the measured part of the hemisphere
    """

    mesh: Mesh
    lobes: tuple[Lobes, ...]
    plans: tuple[Plan, ...]
    quadrant: Float[np.ndarray, "2"]

    def plans_of(self, triangle: int) -> tuple[Plan, Plan, Plan]:
        """Plans from A to B, from A to C and from B to C of a triangle."""
        a, b, c = self.mesh.triangles[triangle]
        return self._plan(a, b), self._plan(a, c), self._plan(b, c)

    def known_plans(self) -> dict[bytes, Plan]:
        """Transport plans by edge key, for reuse in `join`."""
        ends = self.mesh.vertices[self.mesh.edges]
        return dict(zip(map(edge_key, ends), self.plans, strict=True))

    def _plan(self, start: int, end: int) -> Plan:
        edges = self.mesh.edges
        return self.plans[int(np.flatnonzero((edges == [start, end]).all(axis=1))[0])]


def edge_key(ends: Float[np.ndarray, "2 3"]) -> bytes:
    """Identifier of a mesh edge, from the incident directions at both ends."""
    return np.round(ends, 9).tobytes()
