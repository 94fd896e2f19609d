"""Refinement of transport plans by the expected motion of lobes.

Beams of prisms and gratings move with the incident direction. If they move by more than
half of the distance between beams, transport of least cost matches wrong beams. The
motion of each lobe is therefore estimated from the initial plans (`lobe_motion`). New
plans are then calculated from the expected lobe positions at both ends of an edge, with
a smaller reach. The cost uses angles, not distances in the unit disc: the latter are
small near the horizon, to which the flux of diffusers would move. The estimated motion
is weighted by the fraction of the variance of lobe displacements that it explains,
which is small for diffusers.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Indices, Points2, Values, Vector2
from clerestory.gonio.angles import angle_table, directions_over_disc, undeviated
from clerestory.gonio.lobe_motion import LobeMotion, mean_motion
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.optimal_transport import Plan, plan_moves
from clerestory.gonio.parallel import map_in_order, silent
from clerestory.gonio.transport_network import Network
from clerestory.progress import Progress

# Reach of a lobe beyond its radius, per displacement of the undeviated direction.
_REACH_PER_TURN = 0.5


def refine_plans(
    network: Network, *, processes: int = 1, report: Progress = silent
) -> Network:
    """Refine all transport plans by the expected motion of lobes."""
    every = np.arange(len(network.mesh.edges))
    return refine_some_plans(network, every, processes=processes, report=report)


def refine_some_plans(
    network: Network, chosen: Indices, *, processes: int = 1, report: Progress = silent
) -> Network:
    """Refine the transport plans of some edges, as in `refine_plans`.

    `chosen`: indices of these edges.
    """
    follow = mean_motion(network)
    edges = network.mesh.edges[chosen]
    turns = {vertex: LobeMotion(network, vertex, follow) for vertex in np.unique(edges)}
    work = []
    for a, b in edges:
        ends = undeviated(network.mesh.vertices[[a, b]])[:, :2]
        turn = ends[1] - ends[0]
        distance = _missed(turns[a], turns[b], turn)
        work.append((network.lobes[a], network.lobes[b], distance, turn))
    made = map_in_order(_plan, work, processes=processes, report=report)
    plans = list(network.plans)
    for number, plan in zip(chosen, made, strict=True):
        plans[number] = plan
    return replace(network, plans=tuple(plans))


def _missed(
    start: LobeMotion, end: LobeMotion, turn: Vector2
) -> Float[np.ndarray, "start end"]:
    # Angles between lobes and expected positions, plus distances outside the unit disc
    onward, over = _lifted(start.expected(turn))
    back, short = _lifted(end.expected(-turn))
    there = angle_table(onward, end.lobes.centre) + over[:, None]
    here = angle_table(start.lobes.centre, back) + short
    return np.asarray((there + here) / 2)


def _lifted(disc: Points2) -> tuple[Directions, Values]:
    # Directions of positions in the unit disc, and distances of positions outside it
    beyond = np.maximum(np.linalg.norm(disc, axis=1) - 1, 0)
    return directions_over_disc(disc), beyond


def _plan(work: tuple[Lobes, Lobes, Float[np.ndarray, "start end"], Vector2]) -> Plan:
    start, end, distance, turn = work
    slack = _REACH_PER_TURN * float(np.hypot(*turn))
    return plan_moves(start, end, distance=distance, slack=slack)
