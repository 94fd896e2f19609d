"""Where light would go on to that has no partner at the next incident direction.

Light that is cut off between two directions fades, but on the way it still turns with
the incident light: straight light goes straight on, mirrored light turns the other
way. How the light of a lobe turns shows where it does have partners: along the other
edges of its vertex, and of lobes nearby. What these say together, a matrix from the
turn of the incident light to that of the lobe, gives it a place at the other end, a
lobe without light.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float, Int

from clerestory.gonio.angles import angle_table, straight_on
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.nodes import Network
from clerestory.gonio.transport import Plan

# Lobes within so many of their radii turn alike.
_ALIKE = 3.0

# Weight of the mean turn of all lobes against that of the lobe's own moves, as a
# share of the squared turn that its own moves would have if all its light had them.
_PRIOR = 0.05

# Lobes wider than this say nothing about where light turns [rad].
_WIDE = 0.5


def with_continuations(network: Network, *, follow: float) -> Network:
    """Return a network in whose plans no light fades or rises in its place.

    Parameters
    ----------
    follow : share of the turn of the incident light that lobes follow on the whole
    """
    turns = [_Turns(network, vertex, follow) for vertex in range(len(network.lobes))]
    added: list[list[Lobes]] = [[] for _ in network.lobes]
    size = [len(lobes) for lobes in network.lobes]
    plans = []
    for (a, b), plan in zip(network.mesh.edges, network.plans, strict=True):
        a, b = int(a), int(b)
        fading, rising = np.flatnonzero(plan.fading), np.flatnonzero(plan.rising)
        ends = straight_on(network.mesh.vertices[[a, b]])[:, :2]
        added[b].append(turns[a].moved(fading, ends[1] - ends[0]))
        added[a].append(turns[b].moved(rising, ends[0] - ends[1]))
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
    lobes = tuple(
        _joined([own, *more]) for own, more in zip(network.lobes, added, strict=True)
    )
    sized = tuple(
        replace(plan, fading=np.zeros(size[a]), rising=np.zeros(size[b]))
        for plan, (a, b) in zip(plans, network.mesh.edges, strict=True)
    )
    return replace(network, lobes=lobes, plans=sized)


class _Turns:
    # How the lobes of a vertex turn with the incident light, in the disc

    def __init__(self, network: Network, vertex: int, follow: float) -> None:
        self.lobes = network.lobes[vertex]
        count = len(self.lobes)
        along, square = np.zeros((count, 2, 2)), np.zeros((count, 2, 2))
        for number in np.flatnonzero((network.mesh.edges == vertex).any(axis=1)):
            own, move, turn, flux = _moves(network, int(number), vertex)
            np.add.at(
                along, own, flux[:, None, None] * move[:, :, None] * turn[None, None]
            )
            np.add.at(square, own, flux[:, None, None] * (turn[:, None] * turn)[None])
        alike = self._alike()
        along = np.einsum("ij,jab->iab", alike, along)
        square = np.einsum("ij,jab->iab", alike, square)
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

    def moved(
        self, number: Int[np.ndarray, " chosen"], turn: Float[np.ndarray, "2"]
    ) -> Lobes:
        """Lobes without light where some would stand after a turn."""
        disc = self.lobes.centre[number, :2] + self.matrix[number] @ turn
        length = np.hypot(*disc.T)
        disc = disc * np.minimum(1, 0.9999 / np.maximum(length, 1e-12))[:, None]
        height = np.sqrt(np.maximum(1 - np.sum(disc**2, axis=1), 0))
        centre = np.concatenate([disc, height[:, None]], axis=1)
        return Lobes(centre, self.lobes.radius[number], np.zeros(len(number)))

    def _alike(self) -> Float[np.ndarray, "lobes lobes"]:
        # Lobes near to each other, sharp ones more than wide ones
        radius = self.lobes.radius
        apart = angle_table(self.lobes.centre, self.lobes.centre)
        near = np.exp(-0.5 * (apart / (_ALIKE * np.minimum.outer(radius, radius))) ** 2)
        sharp = np.minimum(1, (radius[:, None] / radius) ** 2)
        return np.asarray(near * sharp * (radius < _WIDE))


def _moves(
    network: Network, number: int, vertex: int
) -> tuple[
    Int[np.ndarray, " moves"],
    Float[np.ndarray, "moves 2"],
    Float[np.ndarray, "2"],
    Float[np.ndarray, " moves"],
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


def _joined(parts: list[Lobes]) -> Lobes:
    return Lobes(
        np.concatenate([part.centre for part in parts]),
        np.concatenate([part.radius for part in parts]),
        np.concatenate([part.flux for part in parts]),
    )
