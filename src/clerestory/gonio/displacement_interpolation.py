"""Displacement interpolation of lobes between measured incident directions.

Transport plans match lobes at one incident direction with lobes at the next. A particle
is a set of matched lobes, at most one per corner of a mesh triangle or edge. The
particle fluxes at each corner follow from the transport plans, so that lobe fits are
reproduced at corners, and adjacent triangles agree on common edges. In a triangle ABC
flux is transported along the edge A–B, then to C by the plans from A to C and from B to
C.

Flux and squared radius are interpolated linearly; the flux of lobes without a match
fades at constant position. If the total flux is given, lobe fluxes are scaled to this
total; fluxes that differ most between the corners change most.

Lobe centres are interpolated linearly in the unit disc onto which the hemisphere is
projected. In the disc, flat surfaces, prisms and gratings nearly translate the incident
direction, so that beam and incident direction have the same barycentric coordinates.

References: N. Bonneel et al., ACM Transactions on Graphics 30 (6), 2011; G. Ward, M.
Kurt, N. Bonneel, MAM 2014, for triangles.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Indices, Values, Vector
from clerestory.gonio.angles import directions_over_disc
from clerestory.gonio.lobes import Lobes, joined
from clerestory.gonio.optimal_transport import Plan

# The smallest particles are dropped, up to this fraction of the total flux.
_SMALL_CHANGE = 2e-3

_Light = dict[int, Float[np.ndarray, " particles"]]


@dataclass(frozen=True, eq=False)
class Particles:
    """Matches between lobes at the corners of a mesh triangle or edge, with fluxes."""

    # Index of the lobe of each particle at corners A, B and C; -1 for no lobe
    corner: Int[np.ndarray, "particles 3"]
    # Flux of each particle at A, at B, at C (from A) and at C (from B)
    flux: Float[np.ndarray, "particles 4"]


def edge_particles(plan: Plan) -> Particles:
    """Particles of an edge, from the transport plan from A to B."""
    fading, rising = np.flatnonzero(plan.fading), np.flatnonzero(plan.rising)
    return joined(
        [
            _particles(
                (plan.source, plan.target, None), {0: plan.sent, 1: plan.received}
            ),
            _particles((fading, None, None), {0: plan.fading[fading]}),
            _particles((None, rising, None), {1: plan.rising[rising]}),
        ]
    )


def triangle_particles(a_to_b: Plan, a_to_c: Plan, b_to_c: Plan) -> Particles:
    """Particles of a mesh triangle, from the transport plans of the edges."""
    edge = edge_particles(a_to_b)
    i, j, _ = edge.corner.T
    of_a, of_b = np.flatnonzero(edge.flux[:, 0]), np.flatnonzero(edge.flux[:, 1])
    return _without_change(
        joined(
            [
                *_onwards(i[of_a], j[of_a], edge.flux[of_a, 0], a_to_c, own=0),
                *_onwards(j[of_b], i[of_b], edge.flux[of_b, 1], b_to_c, own=1),
                _only_at_c(a_to_c, b_to_c, i[of_a], own=0),
                _only_at_c(b_to_c, a_to_c, j[of_b], own=1),
            ]
        )
    )


def _onwards(
    mine: Indices, theirs: Indices, flux: Values, plan: Plan, *, own: int
) -> list[Particles]:
    """Particles that transport flux from corner A or B to corner C.

    `own`: start corner, 0 for A or 1 for B; `mine`, `theirs`: lobe indices at the start
    and at the other corner of the edge A–B; `flux`: flux of each particle at the start.
    """
    share = flux / np.bincount(mine, flux, len(plan.fading))[mine]

    # Split each particle in proportion to the fluxes of the matches of its lobe
    by_source = np.argsort(plan.source, kind="stable")
    start = np.searchsorted(plan.source[by_source], mine)
    count = np.searchsorted(plan.source[by_source], mine, side="right") - start
    row = np.repeat(np.arange(len(mine)), count)
    offset = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    move = by_source[np.repeat(start, count) + offset]
    light = {
        own: share[row] * plan.sent[move],
        2 + own: share[row] * plan.received[move],
    }
    stays = np.flatnonzero(plan.fading[mine])
    rising = np.flatnonzero(plan.rising)
    return [
        _particles(_ends(own, mine[row], theirs[row], plan.target[move]), light),
        _particles(_ends(own, mine[stays], theirs[stays], None), {own: flux[stays]}),
        _particles((None, None, rising), {2 + own: plan.rising[rising]}),
    ]


def _only_at_c(plan: Plan, other_plan: Plan, mine: Indices, *, own: int) -> Particles:
    """Particles with flux at C from lobes that are in no particle of the edge A–B.

    At the other corner, a particle has the lobe that sends most flux to C.
    """
    late = np.flatnonzero(~np.isin(plan.source, mine) & (plan.received > 0))
    target = plan.target[late]
    most = np.full(len(plan.rising), -1)
    by_light = np.argsort(other_plan.received)
    most[other_plan.target[by_light]] = other_plan.source[by_light]
    ends = _ends(own, plan.source[late], most[target], target)
    return _particles(ends, {2 + own: plan.received[late]})


def _ends(
    own: int, mine: Indices, theirs: Indices, third: Indices | None
) -> tuple[Indices | None, ...]:
    return (theirs, mine, third) if own else (mine, theirs, third)


def _particles(corners: tuple[Indices | None, ...], flux: _Light) -> Particles:
    size = len(next(iter(flux.values())))
    none = np.full(size, -1)
    table = np.zeros((size, 4))
    for column, values in flux.items():
        table[:, column] = values
    corner = np.stack([none if part is None else part for part in corners], axis=-1)
    return Particles(corner, table)


def _without_change(particles: Particles) -> Particles:
    # Merge particles of equal lobes; drop small particles and rescale all others
    corner, which = np.unique(particles.corner, axis=0, return_inverse=True)
    flux = np.stack(
        [
            np.bincount(which.ravel(), column, len(corner))
            for column in particles.flux.T
        ],
        axis=-1,
    )
    whole = flux.sum(axis=0)
    size = np.max(flux / np.maximum(whole, 1e-300), axis=1)
    order = np.argsort(size)
    keep = np.ones(len(order), dtype=bool)
    keep[order[np.cumsum(size[order]) < _SMALL_CHANGE]] = False
    left = flux[keep].sum(axis=0)
    scale = np.divide(whole, left, out=np.ones(4), where=left > 0)
    return Particles(corner[keep], flux[keep] * scale)


# Newton's method in `with_total`: largest |power|, largest number of steps, tolerance.
_STEEPEST, _STEPS, _STEP_ENDS = 60.0, 20, 1e-9

_NOTHING = 1e-9  # sum of corner weights below which equal weights are used


def displace(
    particles: Particles,
    corners: tuple[Lobes, Lobes, Lobes],
    *,
    s: float,
    t: float,
    weights: Vector | None = None,
    total: float | None = None,
) -> Lobes:
    """Interpolate lobes at a point of a mesh triangle or mesh edge.

    Parameters
    ----------
    corners : lobes at the corners A, B and C; C is ignored on edges
    s, t : fraction s of the way from A to B, and t from the point at s to C
    weights : barycentric coordinates for lobe positions; default: computed from s and t
    total : total scattered flux per incident flux; None or NaN: as interpolated
    """
    way = np.array([(1 - s) * (1 - t), s * (1 - t), t], dtype=float)
    place = way if weights is None else weights
    ends = particles.flux[:, :3].copy()
    ends[:, 2] += s * (particles.flux[:, 3] - ends[:, 2])
    flux = ends @ way
    lit = flux > 0
    number, flux, ends = particles.corner[lit], flux[lit], ends[lit]
    if total is not None and np.isfinite(total):
        change = np.abs(ends - flux[:, None]) @ way / flux
        flux = with_total(flux, change, total)

    present = number >= 0
    place, way = _among(present, place), _among(present, way)
    disc, square = np.zeros((len(number), 2)), np.zeros(len(number))
    for k, lobes in enumerate(corners):
        at = np.where(present[:, k], number[:, k], 0)
        disc += place[:, k, None] * lobes.centre[at, :2]
        square += way[:, k] * lobes.radius[at] ** 2
    return Lobes(directions_over_disc(disc), np.sqrt(square), flux)


def with_total(flux: Values, change: Values, total: float) -> Values:
    """Scale fluxes to a given sum; fluxes that differ most between corners change most.

    Each flux is multiplied by exp(power · change), with a common power found by
    Newton's method, so that no flux becomes negative.

    `change`: mean relative deviation of the corner fluxes from the interpolated flux.

    >>> with_total(np.array([0.3, 0.2]), np.array([1.0, 0.0]), 0.4).round(6).tolist()
    [0.2, 0.2]
    """
    if not len(flux) or total <= 0:
        return flux * 0.0
    power, changed = 0.0, flux
    for _ in range(_STEPS):
        sums = float(changed.sum())
        missing = np.log(total / sums)
        slope = float(changed @ change) / sums
        step = missing / max(slope, 1e-300)
        ahead = float(np.clip(power + step, -_STEEPEST, _STEEPEST))
        if abs(missing) < _STEP_ENDS or ahead == power:
            break
        power = ahead
        changed = flux * np.exp(power * change)
    return np.asarray(changed * (total / float(changed.sum())))


def _among(
    present: Bool[np.ndarray, "particles 3"], weights: Vector
) -> Float[np.ndarray, "particles 3"]:
    # Normalize corner weights over the corners at which a particle has a lobe
    own = present * weights
    total = own.sum(axis=1, keepdims=True)
    even = present / present.sum(axis=1, keepdims=True)
    lost = np.abs(total) < _NOTHING
    return np.asarray(np.where(lost, even, own / np.where(lost, 1, total)))
