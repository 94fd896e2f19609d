"""What scans say without transport: plain means, and fluxes straight between them."""

import numpy as np

from clerestory.gonio.angles import angle_between
from clerestory.gonio.incident_mesh import locate
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.symmetry import fold


def plain_means(interpolant, directions):
    """Yield the mean of the fits at the corners about each direction."""
    network = interpolant.network
    folded, factors = folding(interpolant, directions)
    for corners, shares, factor in places(network.mesh, folded, factors):
        parts = [network.lobes[v] for v in corners]
        lobes = Lobes(
            np.concatenate([part.centre for part in parts]),
            np.concatenate([part.radius for part in parts]),
            np.concatenate([w * p.flux for w, p in zip(shares, parts, strict=True)]),
        )
        yield lobes.transformed(factor)


def straight_lines(interpolant, incidents, known, directions):
    """Flux straight between the exact values about directions, and how these differ."""
    mesh = interpolant.network.mesh
    ends, _ = folding(interpolant, mesh.vertices)
    own, _ = folding(interpolant, incidents)
    values = known[angle_between(ends[:, None], own).argmin(axis=1)]
    folded, factors = folding(interpolant, directions)
    about = list(places(mesh, folded, factors))
    flux = np.array([shares @ values[corners] for corners, shares, _ in about])
    return flux, np.array([np.ptp(values[corners]) for corners, _, _ in about])


def folding(interpolant, directions):
    """Directions in the measured part, and the matrices that turn light back."""
    return fold(directions, interpolant.symmetry, interpolant.network.quadrant)


def places(mesh, folded, factors):
    """Yield the corners about each direction, their shares, and its matrix."""
    place = locate(mesh, folded)
    for k, factor in enumerate(factors):
        s, t = place.s[k], place.t[k]
        if place.on_edge[k]:
            yield mesh.edges[place.simplex[k]], np.array([1 - s, s]), factor
        else:
            shares = np.array([(1 - s) * (1 - t), s * (1 - t), t])
            yield mesh.triangles[place.simplex[k]], shares, factor
