"""Optimal transport between the lobes of two incident directions.

Lobes at both ends of a mesh edge are matched at least cost: flux times the sum of
squared angle between lobes and squared difference of radii.

The total flux differs between the ends. The flux of a lobe in the optimization is
therefore limited to the flux at the other end within a given angle, the *reach* of the
lobe. The remaining flux is gained or lost along the edge. A lobe without a match within
reach fades at constant position; a moving lobe would be a spurious beam half-way
along the edge.

References: N. Bonneel, M. van de Panne, S. Paris, W. Heidrich, "Displacement
interpolation using Lagrangian mass transport", ACM Transactions on Graphics 30 (6),
2011; A. Figalli, "The optimal partial transport problem", Archive for Rational
Mechanics and Analysis 195, 2010.
"""

from dataclasses import dataclass

import numpy as np
import ot
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Values, Vector2
from clerestory.gonio.angles import angle_table, undeviated
from clerestory.gonio.incident_mesh import Mesh
from clerestory.gonio.lobes import Lobes, angles_among

# Reach of a lobe: a multiple of the angle between incident directions (tilted mirrors
# and prisms deviate light by up to twice the angle by which they are rotated), plus a
# multiple of the radius of the lobe.
_REACH_PER_ANGLE, _REACH_PER_RADIUS = 1.5, 1.0

# Largest angle between lobes of one peak, as a multiple of the sum of their radii.
_TOUCHING = 1.5

_WIDER = 3.0  # ratio of radii above which lobes belong to different peaks

# The weight of a neighbouring lobe at a distance of d reaches is 1 / (1 + d^n), where n
# is 2^(1 + _STEEPNESS).
_STEEPNESS = 2

# Smallest matched flux as a fraction of the total flux, and smallest fraction of the
# flux of a lobe that must be matched.
_LEAST_SHARE, _NO_PARTNER = 1e-7, 1e-2

# Lobe indices and fluxes of matches, and angles between lobes
_Matches = Int[np.ndarray, " moves"]
_Fluxes = Float[np.ndarray, " moves"]
_Distances = Float[np.ndarray, "start end"]


@dataclass(frozen=True, eq=False)
class Plan:
    """Transport plan: matches between the lobes of two incident directions."""

    source: _Matches  # lobe index of each match at the start of the edge
    target: _Matches  # lobe index of each match at the end of the edge
    sent: _Fluxes  # flux of each match at the start
    received: _Fluxes  # flux of each match at the end
    fading: Float[np.ndarray, " start"]  # unmatched flux of each lobe at the start
    rising: Float[np.ndarray, " end"]  # unmatched flux of each lobe at the end


@dataclass(frozen=True, eq=False)
class Network:
    """Lobes at the vertices of a mesh, and transport plans along the mesh edges."""

    mesh: Mesh  # mesh of incident directions
    lobes: tuple[Lobes, ...]  # lobes at each incident direction of the mesh
    plans: tuple[Plan, ...]  # transport plan of each edge
    # Signs of x and y in the measured part of the hemisphere
    quadrant: Float[np.ndarray, "2"]

    def turn(self, edge: int) -> Vector2:
        """Displacement of the undeviated direction along an edge, in the unit disc."""
        start, end = undeviated(self.mesh.vertices[self.mesh.edges[edge]])[:, :2]
        return np.asarray(end - start)

    def plans_of(self, triangle: int) -> list[Plan]:
        """Transport plans of a triangle from A to B, from A to C and from B to C."""
        corners = self.mesh.triangles[triangle]
        sides = corners[[[0, 1], [0, 2], [1, 2]]]
        found = (self.mesh.edges == sides[:, None]).all(axis=-1).argmax(axis=1)
        return [self.plans[number] for number in found]

    def known_plans(self) -> dict[bytes, Plan]:
        """Transport plans by edge key, for reuse in `join`."""
        return dict(zip(edge_keys(self.mesh), self.plans, strict=True))


def edge_keys(mesh: Mesh) -> list[bytes]:
    """Identifiers of mesh edges, from the incident directions at both ends."""
    return [np.round(ends, 9).tobytes() for ends in mesh.vertices[mesh.edges]]


def plan_transport(start: Lobes, end: Lobes, angle: float) -> Plan:
    """Calculate the transport plan of least cost between two sets of lobes.

    `angle`: angle between the two incident directions [rad].
    """
    distance = angle_table(start.centre, end.centre)
    return plan_moves(start, end, distance, _REACH_PER_ANGLE * angle)


def plan_moves(start: Lobes, end: Lobes, distance: _Distances, slack: float) -> Plan:
    """Calculate the transport plan of least cost for given angles between lobes [rad].

    `slack`: reach of a lobe beyond the lobe radius [rad].
    """
    moved = _moved(start, end, distance, slack)
    source, target = np.nonzero(moved > _LEAST_SHARE * (start.total + end.total))
    flux = moved[source, target]
    out = np.bincount(source, flux, len(start))
    came = np.bincount(target, flux, len(end))

    # Distribute the full flux of each lobe in proportion to the matched fluxes
    partner = (out > _NO_PARTNER * start.flux)[source]
    partner &= (came > _NO_PARTNER * end.flux)[target]
    source, target, flux = source[partner], target[partner], flux[partner]
    out = np.bincount(source, flux, len(start))
    came = np.bincount(target, flux, len(end))
    sent = start.flux[source] * flux / out[source]
    received = end.flux[target] * flux / came[target]

    # Match unmatched lobes like the nearest matched lobe of the same peak
    lone, to = _companions(start, out > 0, source, target, flux)
    late, off = _companions(end, came > 0, target, source, flux)
    fading = np.where(out > 0, 0, start.flux)
    rising = np.where(came > 0, 0, end.flux)
    fading[lone], rising[late] = 0, 0
    return Plan(
        np.concatenate([source, lone, off]),
        np.concatenate([target, to, late]),
        np.concatenate([sent, start.flux[lone], np.zeros(len(late))]),
        np.concatenate([received, np.zeros(len(lone)), end.flux[late]]),
        fading,
        rising,
    )


def _companions(
    lobes: Lobes,
    taking_part: Bool[np.ndarray, " lobes"],
    own: _Matches,
    other: _Matches,
    flux: _Fluxes,
) -> tuple[Int[np.ndarray, " lone"], Int[np.ndarray, " lone"]]:
    # Unmatched lobes and, for each, the lobe at the other end that receives most flux
    # from the nearest matched lobe
    lone, part = np.flatnonzero(~taking_part), np.flatnonzero(taking_part)
    if not len(lone) or not len(part):
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int)
    apart = angle_table(lobes.centre[lone], lobes.centre[part])
    alike = lobes.radius[part] < _WIDER * lobes.radius[lone, None]
    apart = np.where(alike, apart, np.inf)
    nearest = apart.argmin(axis=1)
    touch = _TOUCHING * (lobes.radius[lone] + lobes.radius[part[nearest]])
    near = apart[np.arange(len(lone)), nearest] < touch
    lone, companion = lone[near], part[nearest[near]]
    most = np.zeros(len(lobes), dtype=int)
    by_flux = np.argsort(flux)
    most[own[by_flux]] = other[by_flux]
    return lone, most[companion]


def _moved(start: Lobes, end: Lobes, distance: _Distances, slack: float) -> _Distances:
    # Limit the flux of each lobe to the flux within reach at the other end
    reach, reach_end = _reach(start, slack), _reach(end, slack)
    give = _limited(start, end, distance, reach)
    take = _limited(end, start, distance.T, reach_end)

    # Add a dummy lobe at each end that absorbs or supplies the flux difference
    table = np.zeros((len(start) + 1, len(end) + 1))
    table[:-1, :-1] = distance**2 + (start.radius[:, None] - end.radius) ** 2
    table[:-1, -1] = reach**2 / 2
    table[-1, :-1] = reach_end**2 / 2
    whole = float(give.sum() + take.sum())
    give, take = np.append(give, take.sum()), np.append(take, give.sum())
    if whole <= 0:
        return np.zeros((len(start), len(end)))
    plan = ot.emd(give / whole, take / whole, table, numItermax=1_000_000)
    return np.asarray(plan)[:-1, :-1] * whole


def _limited(
    own: Lobes,
    other: Lobes,
    distance: Float[np.ndarray, "own other"],
    reach: Float[np.ndarray, " own"],
) -> Float[np.ndarray, " own"]:
    there = _near(distance / reach[:, None]) @ other.flux
    here = _near(angles_among(own) / reach[:, None]) @ own.flux
    return np.asarray(own.flux * np.minimum(1, there / here))


def _reach(lobes: Lobes, slack: float) -> Values:
    return slack + _REACH_PER_RADIUS * lobes.radius


def _near(relative: Float[np.ndarray, "one other"]) -> Float[np.ndarray, "one other"]:
    power = relative * relative
    for _ in range(_STEEPNESS):
        power *= power
    return np.asarray(1 / (1 + power))
