"""Motion of lobes with the incident direction, estimated from transport plans.

Directions are projected onto the unit disc. A 2 × 2 matrix per lobe converts the
displacement of the undeviated direction to the displacement of the lobe centre. The
matrix is estimated from matches of the lobe and nearby lobes at neighbouring incident
directions. Lobes without a match move according to their matrix while they fade.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Indices, Points2, Values, Vector2
from clerestory.gonio.angles import directions_over_disc, undeviated
from clerestory.gonio.lobes import Lobes, angles_among, joined
from clerestory.gonio.optimal_transport import Network, Plan

# Angular distance within which lobes move similarly, as a multiple of the lobe radius.
_ALIKE = 3.0

# Weight of the mean motion of all lobes, relative to the typical squared displacement.
_PRIOR = 0.05

_WIDE = 0.5  # the motion of lobes with larger radii [rad] is ignored


def mean_motion(network: Network) -> float:
    """Mean displacement of lobes per displacement of the undeviated direction, −1…1."""
    along, squared = 0.0, 0.0
    for number, plan in enumerate(network.plans):
        turn = network.turn(number)
        start, end = (network.lobes[k] for k in network.mesh.edges[number])
        move = (end.centre[plan.target] - start.centre[plan.source])[:, :2]
        # Weight narrow lobes most: the displacement of wide lobes is mostly noise
        flux = np.minimum(plan.sent, plan.received)
        weight = flux / (start.radius[plan.source] * end.radius[plan.target])
        along += float(weight @ (move @ turn))
        squared += float(weight.sum() * (turn @ turn))
    return float(np.clip(along / squared, -1, 1)) if squared > 0 else 0.0


class LobeMotion:
    """Motion of the lobes of one incident direction in the unit disc.

    Attributes
    ----------
    lobes : lobes at the incident direction
    matrix : for each lobe, matrix from the displacement of the undeviated direction to
        the displacement of the lobe
    explained : fraction of the variance of lobe displacements that the matrix explains
    """

    def __init__(self, network: Network, vertex: int, mean_motion: float) -> None:
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
        alike = self._similarity()
        along = np.moveaxis(along @ alike.T, -1, 0)
        square = np.moveaxis(square @ alike.T, -1, 0)
        moved = alike @ moved
        turns = (
            undeviated(network.mesh.vertices)[:, :2]
            - undeviated(network.mesh.vertices[vertex])[:2]
        )
        near = np.sort(np.sum(turns**2, axis=1))[1:4].mean()
        prior = _PRIOR * near * (alike @ self.lobes.flux)[:, None, None] + 1e-12
        own_prior = prior * np.eye(2)
        self.matrix = np.einsum(
            "iab,ibc->iac",
            along + mean_motion * own_prior,
            np.linalg.inv(square + own_prior),
        )
        missed = (
            moved
            - 2 * np.einsum("iab,iab->i", self.matrix, along)
            + np.einsum("iab,ibc,iac->i", self.matrix, square, self.matrix)
        )
        self.explained = np.clip(1 - missed / np.maximum(moved, 1e-30), 0, 1)

    def expected(self, turn: Vector2) -> Points2:
        """Expected lobe centres in the unit disc; displacements times `explained`."""
        shift = self.explained[:, None] * (self.matrix @ turn)
        return np.asarray(self.lobes.centre[:, :2] + shift)

    def moved(self, number: Indices, turn: Vector2) -> Lobes:
        """Lobes with given indices, displaced and with zero flux."""
        disc = self.lobes.centre[number, :2] + self.matrix[number] @ turn
        return Lobes(
            directions_over_disc(disc), self.lobes.radius[number], np.zeros(len(number))
        )

    def _similarity(self) -> Float[np.ndarray, "lobes lobes"]:
        # Weights of nearby lobes, larger for narrow lobes
        radius = self.lobes.radius
        apart = angles_among(self.lobes)
        near = np.exp(-0.5 * (apart / (_ALIKE * np.minimum.outer(radius, radius))) ** 2)
        sharp = np.minimum(1, (radius[:, None] / radius) ** 2)
        return np.asarray(near * sharp * (radius < _WIDE))


def _moves(
    network: Network, number: int, vertex: int
) -> tuple[Indices, Points2, Vector2, Values]:
    # Indices of the matched lobes at the vertex, lobe displacements in the disc along
    # the edge, displacement of the undeviated direction, and flux of each match
    plan = network.plans[number]
    start, end = (network.lobes[k] for k in network.mesh.edges[number])
    move = (end.centre[plan.target] - start.centre[plan.source])[:, :2]
    turn, flux = network.turn(number), np.sqrt(plan.sent * plan.received)
    if network.mesh.edges[number, 0] == vertex:
        return plan.source, move, turn, flux
    return plan.target, -move, -turn, flux


def with_unmatched_lobes(network: Network, *, mean_motion: float) -> Network:
    """Return a network in which unmatched lobes move while they fade."""
    motions = [
        LobeMotion(network, vertex, mean_motion) for vertex in range(len(network.lobes))
    ]
    edges = network.mesh.edges.tolist()
    lobes = [[own] for own in network.lobes]
    size = [len(own) for own in network.lobes]
    plans = []
    for number, (plan, (a, b)) in enumerate(zip(network.plans, edges, strict=True)):
        fading, rising = np.flatnonzero(plan.fading), np.flatnonzero(plan.rising)
        turn = network.turn(number)
        lobes[b].append(motions[a].moved(fading, turn))
        lobes[a].append(motions[b].moved(rising, -turn))
        gone = size[b] + np.arange(len(fading))
        come = size[a] + np.arange(len(rising))
        size[b] += len(fading)
        size[a] += len(rising)
        plans.append(
            Plan(
                np.concatenate([plan.source, fading, come]),
                np.concatenate([plan.target, gone, rising]),
                np.concatenate([plan.sent, plan.fading[fading], np.zeros(len(come))]),
                np.concatenate(
                    [plan.received, np.zeros(len(gone)), plan.rising[rising]]
                ),
                np.zeros(0),
                np.zeros(0),
            )
        )
    sized = tuple(
        replace(plan, fading=np.zeros(size[a]), rising=np.zeros(size[b]))
        for plan, (a, b) in zip(plans, edges, strict=True)
    )
    return replace(network, lobes=tuple(map(joined, lobes)), plans=sized)
