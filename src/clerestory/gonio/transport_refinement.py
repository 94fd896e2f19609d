"""Plans made again, from where lobes are expected after the turn of the incident light.

Light does not always become what is nearest to it: beams of a prism or a grating, and
the teeth of its cut-offs, turn with the incident light, and where they turn by more
than half the distance to the next beam the least way leads to the wrong one. So the
first plans serve to learn how each lobe turns (`turning`): errors along one edge are
outvoted by its other edges and by lobes nearby. Then each lobe is moved by the turn
that is expected along an edge, from both ends, and transport is planned from there;
what has to be travelled now is only what the expectation misses, so the reach of lobes
is shorter. It is measured as an angle: in the disc light of a diffuser would come to
the horizon for nothing. Where moves follow no turn, as those of small lobes in the
even light of a diffuser, little of it is expected: a share as large as that of the
squared moves that the turn explains.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Indices, Points2, Values, Vector2
from clerestory.gonio.angles import above, angle_table, straight_on
from clerestory.gonio.lobe_motion import Turns, followed
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.optimal_transport import Plan, plan_moves
from clerestory.gonio.parallel import Report, map_in_order, silent
from clerestory.gonio.transport_network import Network

# Reach beyond the radius of a lobe, as a share of the turn of the incident light.
_REACH_PER_TURN = 0.5


def plan_again(
    network: Network, *, processes: int = 1, report: Report = silent
) -> Network:
    """Return a network whose plans start from where lobes are expected to turn to."""
    every = np.arange(len(network.mesh.edges))
    return replan(network, every, processes=processes, report=report)


def replan(
    network: Network, chosen: Indices, *, processes: int = 1, report: Report = silent
) -> Network:
    """Return a network of which some plans are made again, as by `plan_again`.

    Parameters
    ----------
    chosen : numbers of the edges
    """
    follow = followed(network)
    edges = network.mesh.edges[chosen]
    turns = {vertex: Turns(network, vertex, follow) for vertex in np.unique(edges)}
    work = []
    for a, b in edges:
        ends = straight_on(network.mesh.vertices[[a, b]])[:, :2]
        turn = ends[1] - ends[0]
        distance = _missed(turns[a], turns[b], turn)
        work.append((network.lobes[a], network.lobes[b], distance, turn))
    made = map_in_order(_plan, work, processes=processes, report=report)
    plans = list(network.plans)
    for number, plan in zip(chosen, made, strict=True):
        plans[number] = plan
    return replace(network, plans=tuple(plans))


def _missed(start: Turns, end: Turns, turn: Vector2) -> Float[np.ndarray, "start end"]:
    # Angles between lobes and where the other end expects them, beyond the rim too
    onward, over = _lifted(start.expected(turn))
    back, short = _lifted(end.expected(-turn))
    there = angle_table(onward, end.lobes.centre) + over[:, None]
    here = angle_table(start.lobes.centre, back) + short
    return np.asarray((there + here) / 2)


def _lifted(disc: Points2) -> tuple[Directions, Values]:
    # Directions above the disc, and how far places lie beyond its rim
    beyond = np.maximum(np.linalg.norm(disc, axis=1) - 1, 0)
    return above(disc), beyond


def _plan(work: tuple[Lobes, Lobes, Float[np.ndarray, "start end"], Vector2]) -> Plan:
    start, end, distance, turn = work
    slack = _REACH_PER_TURN * float(np.hypot(*turn))
    return plan_moves(start, end, distance=distance, slack=slack)
