"""Continuation of lobes without a partner at the next incident direction.

Light that is cut off between two incident directions fades. Meanwhile its lobes move
with the incident direction, at the rate that other edges of the mesh show: an added
lobe without flux at the other end gives the direction.
"""

from dataclasses import replace

import numpy as np

from clerestory.gonio.angles import straight_on
from clerestory.gonio.lobe_motion import Turns
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.optimal_transport import Plan
from clerestory.gonio.transport_network import Network


def with_continuations(network: Network, *, follow: float) -> Network:
    """Return a network in which lobes without a partner move while they fade.

    Parameters
    ----------
    follow : mean rotation of lobes over that of the incident direction
    """
    turns = [Turns(network, vertex, follow) for vertex in range(len(network.lobes))]
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


def _joined(parts: list[Lobes]) -> Lobes:
    return Lobes(
        np.concatenate([part.centre for part in parts]),
        np.concatenate([part.radius for part in parts]),
        np.concatenate([part.flux for part in parts]),
    )
