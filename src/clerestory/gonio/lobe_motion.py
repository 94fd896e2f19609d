"""How lobes turn with the incident light, as the plans between them show.

How the light of a lobe turns shows where it has partners: along the edges of its
vertex, and of lobes nearby. What these say together is a matrix from the turn of the
incident light to that of the lobe, both in the disc below the hemisphere.
"""

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Indices, Points2, Values, Vector2
from clerestory.gonio.angles import above, straight_on
from clerestory.gonio.lobes import Lobes, angles_among
from clerestory.gonio.transport_network import Network

# Lobes within so many of their radii turn alike.
_ALIKE = 3.0

# Weight of the mean turn of all lobes against that of the lobe's own moves, as a
# share of the squared turn that its own moves would have if all its light had them.
_PRIOR = 0.05

# Lobes wider than this say nothing about where light turns [rad].
_WIDE = 0.5


def followed(network: Network) -> float:
    """How far lobes follow where light goes straight on, over all plans; -1…1."""
    along, squared = 0.0, 0.0
    for (a, b), plan in zip(network.mesh.edges, network.plans, strict=True):
        ends = straight_on(network.mesh.vertices[[a, b]])
        turn = (ends[1] - ends[0])[:2]
        start, end = network.lobes[a], network.lobes[b]
        move = (end.centre[plan.target] - start.centre[plan.source])[:, :2]
        # Sharp lobes show where light goes, wide ones are noise of the grid
        flux = np.minimum(plan.sent, plan.received)
        weight = flux / (start.radius[plan.source] * end.radius[plan.target])
        along += float(weight @ (move @ turn))
        squared += float(weight.sum() * (turn @ turn))
    return float(np.clip(along / squared, -1, 1)) if squared > 0 else 0.0


class Turns:
    """How the lobes of a vertex turn with the incident light, in the disc.

    Parameters
    ----------
    follow : share of the turn of the incident light that lobes follow on the whole

    Attributes
    ----------
    lobes : of the vertex
    matrix : from the turn of the incident light to that of each lobe
    sure : share of the squared moves of each lobe's light that the matrix explains
    """

    def __init__(self, network: Network, vertex: int, follow: float) -> None:
        self.lobes = network.lobes[vertex]
        count = len(self.lobes)
        along, square = np.zeros((2, 2, count)), np.zeros((2, 2, count))
        moved = np.zeros(count)
        for number in np.flatnonzero((network.mesh.edges == vertex).any(axis=1)):
            own, move, turn, flux = _moves(network, int(number), vertex)
            weighted = move.T * flux
            weight = np.bincount(own, flux, count)
            sums = np.array([np.bincount(own, part, count) for part in weighted])
            along += sums[:, None] * turn[:, None]
            square += np.outer(turn, turn)[:, :, None] * weight
            moved += np.bincount(own, np.sum(weighted * move.T, axis=0), count)
        alike = self._alike()
        along = np.moveaxis(along @ alike.T, -1, 0)
        square = np.moveaxis(square @ alike.T, -1, 0)
        moved = alike @ moved
        turns = (
            straight_on(network.mesh.vertices)[:, :2]
            - straight_on(network.mesh.vertices[vertex])[:2]
        )
        near = np.sort(np.sum(turns**2, axis=1))[1:4].mean()
        prior = _PRIOR * near * (alike @ self.lobes.flux)[:, None, None] + 1e-12
        own_prior = prior * np.eye(2)
        self.matrix = np.einsum(
            "iab,ibc->iac",
            along + follow * own_prior,
            np.linalg.inv(square + own_prior),
        )
        missed = (
            moved
            - 2 * np.einsum("iab,iab->i", self.matrix, along)
            + np.einsum("iab,ibc,iac->i", self.matrix, square, self.matrix)
        )
        self.sure = np.clip(1 - missed / np.maximum(moved, 1e-30), 0, 1)

    def expected(self, turn: Vector2) -> Points2:
        """Places of the lobes in the disc after a turn, as far as it is sure."""
        shift = self.sure[:, None] * (self.matrix @ turn)
        return np.asarray(self.lobes.centre[:, :2] + shift)

    def moved(self, number: Indices, turn: Vector2) -> Lobes:
        """Lobes without light where some would stand after a turn."""
        disc = self.lobes.centre[number, :2] + self.matrix[number] @ turn
        return Lobes(above(disc), self.lobes.radius[number], np.zeros(len(number)))

    def _alike(self) -> Float[np.ndarray, "lobes lobes"]:
        # Lobes near to each other, sharp ones more than wide ones
        radius = self.lobes.radius
        apart = angles_among(self.lobes)
        near = np.exp(-0.5 * (apart / (_ALIKE * np.minimum.outer(radius, radius))) ** 2)
        sharp = np.minimum(1, (radius[:, None] / radius) ** 2)
        return np.asarray(near * sharp * (radius < _WIDE))


def _moves(
    network: Network, number: int, vertex: int
) -> tuple[
    Indices,
    Points2,
    Vector2,
    Values,
]:
    # Own lobes, where their light moves in the disc, the turn of incidence, and flux
    plan = network.plans[number]
    a, b = network.mesh.edges[number]
    move = (
        network.lobes[b].centre[plan.target] - network.lobes[a].centre[plan.source]
    )[:, :2]
    ends = straight_on(network.mesh.vertices[[a, b]])[:, :2]
    turn, flux = ends[1] - ends[0], np.sqrt(plan.sent * plan.received)
    if a == vertex:
        return plan.source, move, turn, flux
    return plan.target, -move, -turn, flux
