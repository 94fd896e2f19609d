"""Assembly of lobes, mesh and transport plans of a measurement.

The mesh includes mirror images of the measured incident directions, so that it is
continuous across symmetry planes; triangles outside the measured part are removed.

Beams of prisms and gratings move with the incident direction. Beams that move by more
than half of the distance between beams are matched wrongly by transport of least cost.
The motion of each lobe is therefore estimated from initial plans (`lobe_motion`). New
plans are then calculated from the expected lobe positions at both ends of an edge, with
a smaller reach. The cost uses angles: distances in the unit disc are small near the
horizon and would attract the flux of diffusers there. The estimated motion is weighted
by the fraction of the variance of lobe displacements that it explains, which is small
for diffusers.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Indices, Points2, Values, Vector2
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.gonio.angles import angle_between, angle_table, directions_over_disc
from clerestory.gonio.incident_mesh import Mesh, arc_mesh, triangulate
from clerestory.gonio.lobe_motion import LobeMotion, mean_motion
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.optimal_transport import (
    Network,
    Plan,
    edge_keys,
    plan_moves,
    plan_transport,
)
from clerestory.gonio.parallel import IN_SERIES, Workers
from clerestory.gonio.scattering_measurement import SAME_DIRECTION
from clerestory.gonio.symmetry import (
    Symmetry,
    images,
    measured_quadrant,
    rotation_about_normal,
    within,
)

# Reach of a lobe beyond its radius, per displacement of the undeviated direction, in
# refined plans.
_REACH_PER_TURN = 0.5


def connect(
    incidents: Directions,
    fits: Sequence[Lobes],
    symmetry: Symmetry,
    *,
    workers: Workers = IN_SERIES,
) -> Network:
    """Connect lobe fits and their mirror images by refined transport plans."""
    network = join(incidents, fits, symmetry, workers=workers)
    return refine_plans(network, workers=workers)


def join(
    incidents: Directions,
    fits: Sequence[Lobes],
    symmetry: Symmetry,
    *,
    known: Mapping[bytes, Plan] | None = None,
    workers: Workers = IN_SERIES,
) -> Network:
    """Connect lobe fits by initial (unrefined) transport plans.

    `known`: initial plans by edge key, reused from another network of the same fits.
    """
    found = f"number of incident directions is {len(fits)}"
    require(len(fits) >= 2, f"{found}; two or more expected for interpolation")
    assemble = _isotropic if symmetry == "isotropic" else _around
    mesh, lobes, quadrant = assemble(incidents, fits, symmetry)
    keys, plans = edge_keys(mesh), dict(known or {})
    new = [k for k, key in enumerate(keys) if key not in plans]
    work = [
        (lobes[a], lobes[b], float(angle_between(mesh.vertices[a], mesh.vertices[b])))
        for a, b in mesh.edges[new]
    ]
    made = workers.map("plan transport", plan_transport, work)
    plans.update(zip([keys[k] for k in new], made, strict=True))
    return Network(mesh, lobes, tuple(plans[key] for key in keys), quadrant)


def refine_plans(
    network: Network, *, chosen: Indices | None = None, workers: Workers = IN_SERIES
) -> Network:
    """Refine the transport plans of all or some edges from the estimated lobe motion.

    `chosen`: indices of the edges; default: all.
    """
    if chosen is None:
        chosen = np.arange(len(network.mesh.edges))
    mean = mean_motion(network)
    edges = network.mesh.edges[chosen]
    motions = {vertex: LobeMotion(network, vertex, mean) for vertex in np.unique(edges)}
    work = []
    for number, (a, b) in zip(chosen, edges, strict=True):
        turn = network.turn(number)
        distance = _missed(motions[a], motions[b], turn)
        slack = _REACH_PER_TURN * float(np.hypot(*turn))
        work.append((network.lobes[a], network.lobes[b], distance, slack))
    plans = list(network.plans)
    made = workers.map("plan transport", plan_moves, work)
    for number, plan in zip(chosen, made, strict=True):
        plans[number] = plan
    return replace(network, plans=tuple(plans))


def _missed(
    start: LobeMotion, end: LobeMotion, turn: Vector2
) -> Float[np.ndarray, "start end"]:
    # Angles from lobes to expected positions, plus distances of positions from the disc
    onward, over = _lifted(start.expected(turn))
    back, short = _lifted(end.expected(-turn))
    there = angle_table(onward, end.lobes.centre) + over[:, None]
    here = angle_table(start.lobes.centre, back) + short
    return np.asarray((there + here) / 2)


def _lifted(disc: Points2) -> tuple[Directions, Values]:
    # Directions of points in the unit disc; distance to the disc (0 for points inside)
    beyond = np.maximum(np.linalg.norm(disc, axis=1) - 1, 0)
    return directions_over_disc(disc), beyond


_Assembly = tuple[Mesh, tuple[Lobes, ...], Vector2]


def _around(
    incidents: Directions, fits: Sequence[Lobes], symmetry: Symmetry
) -> _Assembly:
    # Add mirror images of lobe fits; keep triangles that overlap the measured part
    vertices, lobes = list(incidents), list(fits)
    for factor in images(symmetry)[1:]:
        for incident, fit in zip(incidents, fits, strict=True):
            image = incident * factor
            if angle_between(np.array(vertices), image).min() > SAME_DIRECTION:
                vertices.append(image)
                lobes.append(fit.transformed(np.diag(factor)))
    quadrant = measured_quadrant(incidents)
    mesh = triangulate(np.array(vertices))
    kept = within(mesh.vertices[mesh.triangles], symmetry, quadrant)
    return mesh.only(kept), tuple(lobes), quadrant


def _isotropic(
    incidents: Directions, fits: Sequence[Lobes], _symmetry: Symmetry
) -> _Assembly:
    # Rotate every direction to azimuth 0; without normal incidence, add the mirror
    # image of the lobes at the smallest polar angle
    azimuth = np.arctan2(incidents[:, 1], incidents[:, 0])
    theta = np.arctan2(np.hypot(*incidents[:, :2].T), incidents[:, 2])
    order = np.argsort(theta)
    lobes = [fits[k].transformed(rotation_about_normal(-azimuth[k])) for k in order]
    theta = theta[order]
    same = theta[:-1][np.diff(theta) < SAME_DIRECTION]
    if same.size:
        found = f"two scans of an isotropic layer at θ {np.degrees(same[0]):.1f}°"
        raise InputError(f"{found}; one scan per polar angle expected")
    if theta[0] > SAME_DIRECTION:
        theta = np.concatenate([[-theta[0]], theta])
        lobes.insert(0, lobes[0].transformed(rotation_about_normal(np.pi)))
    return arc_mesh(theta), tuple(lobes), np.ones(2)
