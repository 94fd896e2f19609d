"""Assembly of lobes, mesh and transport plans of a measurement.

The mesh includes mirror images of the measured incident directions, so that it is
continuous across symmetry planes; triangles outside the measured part are removed.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Indices, Vector2
from clerestory.errors import InputError
from clerestory.gonio.angles import angle_between
from clerestory.gonio.incident_mesh import Mesh, arc_mesh, triangulate
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.optimal_transport import Plan, plan_transport
from clerestory.gonio.parallel import map_in_order, silent
from clerestory.gonio.scattering_measurement import SAME_DIRECTION
from clerestory.gonio.symmetry import Symmetry, images, measured_quadrant, within
from clerestory.gonio.transport_network import Network, edge_key
from clerestory.gonio.transport_refinement import refine_plans
from clerestory.progress import Progress


def connect(
    incidents: Directions,
    fits: Sequence[Lobes],
    symmetry: Symmetry,
    *,
    processes: int = 1,
    report: Progress = silent,
) -> Network:
    """Connect lobe fits and their mirror images by refined transport plans."""
    network = join(incidents, fits, symmetry, processes=processes, report=report)
    return refine_plans(network, processes=processes, report=report)


def join(
    incidents: Directions,
    fits: Sequence[Lobes],
    symmetry: Symmetry,
    *,
    known: Mapping[bytes, Plan] | None = None,
    processes: int = 1,
    report: Progress = silent,
) -> Network:
    """Connect lobe fits by initial (unrefined) transport plans.

    `known`: initial plans of another network of the same fits, which are reused.
    """
    if len(fits) < 2:
        raise InputError(
            f"number of incident directions: {len(fits)}; two or more expected for"
            " interpolation"
        )
    if symmetry == "isotropic":
        mesh, lobes = _isotropic(incidents, fits)
        quadrant = np.ones(2)
    else:
        mesh, lobes, quadrant = _around(incidents, fits, symmetry)
    plans = _plans(mesh, lobes, known or {}, processes, report)
    return Network(mesh, lobes, plans, quadrant)


def transformed(lobes: Lobes, turn: Float[np.ndarray, "3 3"]) -> Lobes:
    """Rotate or reflect lobes by a matrix.

    >>> up = Lobes(np.array([[0, 0.6, 0.8]]), np.ones(1), np.ones(1))
    >>> transformed(up, np.diag([1.0, -1.0, 1.0])).centre.tolist()
    [[0.0, -0.6, 0.8]]
    """
    return Lobes(lobes.centre @ turn.T, lobes.radius, lobes.flux)


def rotation_about_normal(angle: float) -> Float[np.ndarray, "3 3"]:
    """Matrix of a rotation about the normal by an angle [rad], from +x to +y."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def _around(
    incidents: Directions, fits: Sequence[Lobes], symmetry: Symmetry
) -> tuple[Mesh, tuple[Lobes, ...], Vector2]:
    # Build the mesh from the triangles that overlap the measured part
    quadrant = measured_quadrant(incidents)
    vertices, lobes = _with_images(incidents, fits, symmetry)
    mesh = triangulate(vertices)
    kept = within(vertices[mesh.triangles], symmetry, quadrant)
    return _only(mesh, np.flatnonzero(kept)), lobes, quadrant


def _isotropic(
    incidents: Directions, fits: Sequence[Lobes]
) -> tuple[Mesh, tuple[Lobes, ...]]:
    # Rotate every direction to azimuth 0; without normal incidence, add the image of
    # the smallest polar angle
    azimuth = np.arctan2(incidents[:, 1], incidents[:, 0])
    theta = np.arctan2(np.hypot(*incidents[:, :2].T), incidents[:, 2])
    order = np.argsort(theta)
    lobes = [transformed(fits[k], rotation_about_normal(-azimuth[k])) for k in order]
    theta = theta[order]
    same = np.flatnonzero(np.diff(theta) < SAME_DIRECTION)
    if len(same):
        raise InputError(
            f"two scans at θ {np.degrees(theta[same[0]]):.1f}° of an isotropic layer;"
            " one scan per polar angle expected"
        )
    if theta[0] > SAME_DIRECTION:
        theta = np.concatenate([[-theta[0]], theta])
        lobes.insert(0, transformed(lobes[0], rotation_about_normal(np.pi)))
    return arc_mesh(theta), tuple(lobes)


def _with_images(
    incidents: Float[np.ndarray, "scans 3"], fits: Sequence[Lobes], symmetry: Symmetry
) -> tuple[Float[np.ndarray, "vertices 3"], tuple[Lobes, ...]]:
    vertices, lobes = list(incidents), list(fits)
    for factor in images(symmetry)[1:]:
        for incident, fit in zip(incidents, fits, strict=True):
            image = incident * factor
            if angle_between(np.array(vertices), image).min() > SAME_DIRECTION:
                vertices.append(image)
                lobes.append(transformed(fit, np.diag(factor)))
    return np.array(vertices), tuple(lobes)


def _only(mesh: Mesh, triangles: Indices) -> Mesh:
    corners = mesh.triangles[triangles]
    every = np.concatenate([corners[:, [0, 1]], corners[:, [0, 2]], corners[:, [1, 2]]])
    edges = np.unique(every, axis=0)
    number = {tuple(edge): k for k, edge in enumerate(mesh.edges.tolist())}
    rim = np.array([mesh.rim[number[tuple(edge)]] for edge in edges.tolist()])
    return Mesh(mesh.vertices, corners, edges, rim)


def _plans(
    mesh: Mesh,
    lobes: Sequence[Lobes],
    known: Mapping[bytes, Plan],
    processes: int,
    report: Progress,
) -> tuple[Plan, ...]:
    keys = [edge_key(mesh.vertices[edge]) for edge in mesh.edges]
    new = [k for k, key in enumerate(keys) if key not in known]
    work = [
        (lobes[a], lobes[b], float(angle_between(mesh.vertices[a], mesh.vertices[b])))
        for a, b in mesh.edges[new]
    ]
    made = map_in_order(_plan, work, processes=processes, report=report)
    plans = {**known, **{keys[k]: plan for k, plan in zip(new, made, strict=True)}}
    return tuple(plans[key] for key in keys)


def _plan(work: tuple[Lobes, Lobes, float]) -> Plan:
    start, end, angle = work
    return plan_transport(start, end, angle=angle)
