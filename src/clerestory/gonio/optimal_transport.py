"""Transport plans: which light of one measured distribution becomes which of the next.

Along an edge of the mesh the lobes of one end are joined to those of the other so
that light travels as little as possible: optimal transport, with the squared angle
between lobes and the squared difference of their radii as the cost of a unit of flux.

Layers also pass more or less light as its direction changes. So before transport the
fluxes of both ends are balanced locally: where one end has less within the *reach* of
a lobe, the other is dimmed to it. What a lobe has more than it sends, it loses on the
way, and a lobe that sends nothing goes with its neighbour. A lobe without a partner in
reach, as one that is cut off, fades where it is instead of wandering into another,
which would make a ghost half-way.

References: N. Bonneel, M. van de Panne, S. Paris, W. Heidrich, "Displacement
interpolation using Lagrangian mass transport", ACM Transactions on Graphics 30 (6),
2011; for what vanishes, A. Figalli, "The optimal partial transport problem", Archive
for Rational Mechanics and Analysis 195, 2010.
"""

from dataclasses import dataclass

import numpy as np
import ot
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Values
from clerestory.gonio.angles import angle_table
from clerestory.gonio.lobes import Lobes, angles_among

# Reach of a lobe: so many times the angle between the incident directions, for a
# tilted mirror and a prism turn light by up to twice the angle they are turned by…
_REACH_PER_ANGLE = 1.5

# … and so many of its radii.
_REACH_PER_RADIUS = 1.0

# Lobes whose centres are nearer than so many of their radii are parts of one peak.
_TOUCHING = 1.5

# A lobe this much wider than another is no part of its peak: a beam that is cut off
# does not become a veil.
_WIDER = 3.0

# Lobes count fully within the reach and soon no more beyond it: with the eighth power
# of the distance, its square squared twice.
_STEEPNESS = 2

# Light below this share of a plan does not travel, and a lobe that sends less than
# this share of its own has no partner.
_LEAST_SHARE, _NO_PARTNER = 1e-7, 1e-2


@dataclass(frozen=True, eq=False)
class Plan:
    """Where the light of one set of lobes goes in another; a sparse matrix.

    Attributes
    ----------
    source, target : numbers of the lobes that exchange light
    sent, received : light that leaves each source for its target, and what arrives
    fading : light of each lobe at the start that has no target
    rising : light of each lobe at the end that has no source
    """

    source: Int[np.ndarray, " moves"]
    target: Int[np.ndarray, " moves"]
    sent: Float[np.ndarray, " moves"]
    received: Float[np.ndarray, " moves"]
    fading: Float[np.ndarray, " start"]
    rising: Float[np.ndarray, " end"]


def plan_transport(start: Lobes, end: Lobes, *, angle: float) -> Plan:
    """Return the plan of least cost between two sets of lobes.

    Parameters
    ----------
    angle : between the two incident directions [rad]

    Examples
    --------
    >>> up = np.array([[0, 0, 1.0]])
    >>> one = Lobes(up, np.array([0.1]), np.array([0.5]))
    >>> other = Lobes(up, np.array([0.1]), np.array([0.3]))
    >>> plan = plan_transport(one, other, angle=0.1)
    >>> plan.sent.round(3).tolist(), plan.received.round(3).tolist()
    ([0.5], [0.3])
    """
    distance = angle_table(start.centre, end.centre)
    return plan_moves(start, end, distance=distance, slack=_REACH_PER_ANGLE * angle)


def plan_moves(
    start: Lobes, end: Lobes, *, distance: Float[np.ndarray, "start end"], slack: float
) -> Plan:
    """Return the plan of least cost for given distances between lobes.

    Parameters
    ----------
    distance : of each lobe at the end from where one of the start is or will be [rad]
    slack : reach of a lobe beyond its radius [rad]
    """
    moved = _moved(start, end, distance, slack)
    source, target = np.nonzero(moved > _LEAST_SHARE * (start.total + end.total))
    flux = moved[source, target]
    out = np.bincount(source, flux, len(start))
    came = np.bincount(target, flux, len(end))

    # A lobe divides all its light as the plan divides what it sends
    partner = (out > _NO_PARTNER * start.flux)[source]
    partner &= (came > _NO_PARTNER * end.flux)[target]
    source, target, flux = source[partner], target[partner], flux[partner]
    out = np.bincount(source, flux, len(start))
    came = np.bincount(target, flux, len(end))
    sent = start.flux[source] * flux / out[source]
    received = end.flux[target] * flux / came[target]

    # A lobe that takes no part goes with the nearest that does
    lone, _, to = _companions(start, out > 0, source, target, flux)
    late, _, off = _companions(end, came > 0, target, source, flux)
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
    own: Int[np.ndarray, " moves"],
    other: Int[np.ndarray, " moves"],
    flux: Float[np.ndarray, " moves"],
) -> tuple[
    Int[np.ndarray, " lone"], Int[np.ndarray, " lone"], Int[np.ndarray, " lone"]
]:
    """Lobes that take no part, those they go with, and where these mostly go."""
    lone, part = np.flatnonzero(~taking_part), np.flatnonzero(taking_part)
    if not len(lone) or not len(part):
        none = np.zeros(0, dtype=int)
        return none, none, none
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
    return lone, companion, most[companion]


def _moved(
    start: Lobes, end: Lobes, distance: Float[np.ndarray, "start end"], slack: float
) -> Float[np.ndarray, "start end"]:
    # Dim each lobe to what both ends have within its reach
    reach, reach_end = _reach(start, slack), _reach(end, slack)
    give = start.flux * np.minimum(
        1,
        (_near(distance / reach[:, None]) @ end.flux)
        / (_near(angles_among(start) / reach[:, None]) @ start.flux),
    )
    take = end.flux * np.minimum(
        1,
        (_near(distance.T / reach_end[:, None]) @ start.flux)
        / (_near(angles_among(end) / reach_end[:, None]) @ end.flux),
    )

    # An extra lobe on each side takes what vanishes and gives what appears
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


def _reach(lobes: Lobes, slack: float) -> Values:
    return slack + _REACH_PER_RADIUS * lobes.radius


def _near(relative: Float[np.ndarray, "one other"]) -> Float[np.ndarray, "one other"]:
    power = relative * relative
    for _ in range(_STEEPNESS):
        power *= power
    return np.asarray(1 / (1 + power))
