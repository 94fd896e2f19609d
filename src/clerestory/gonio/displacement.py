"""Partial displacement: the lobes between measured directions, light under way.

Each unit of light of a plan travels along a great circle from its lobe at the start
to its lobe at the end, its flux and its squared radius changing evenly; what has no
partner fades in its place. Within a triangle light first goes along the edge from A
to B, then towards C: the part that belongs to A by the plan from A to C, the part that
belongs to B by that from B to C. So edges look alike from both of their triangles,
corners are the fits themselves, and the flux is the weighted mean of the fluxes of the
corners.

References: N. Bonneel et al., ACM Transactions on Graphics 30 (6), 2011; G. Ward,
M. Kurt, N. Bonneel, MAM 2014, for the step into triangles.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from clerestory.gonio.lobes import Lobes
from clerestory.gonio.transport import Plan

# Light of a triangle in its smallest particles that is given to the others.
_SMALL_CHANGE = 2e-3

# Limits and steps in the search for the shares of corners.
_STEEPEST, _BISECTIONS = 12.0, 40

# Differences of the fluxes of corners, relative to their mean, up to which light
# changes alike, and from which on some of it is cut off.
_ALIKE = 0.3, 0.7


@dataclass(frozen=True, eq=False)
class Particles:
    """Light that travels within a triangle, or along an edge.

    Attributes
    ----------
    corner : lobe of each corner that a particle comes from or goes to; -1 for none
    flux : of each particle at A, at B, and at C for what belongs to A and to B
    """

    corner: Int[np.ndarray, "particles 3"]
    flux: Float[np.ndarray, "particles 4"]


def edge_particles(plan: Plan) -> Particles:
    """Return the particles of the plan from A to B."""
    fading, rising = np.flatnonzero(plan.fading), np.flatnonzero(plan.rising)
    return _joined(
        [
            _particles(
                (plan.source, plan.target, None), {0: plan.sent, 1: plan.received}
            ),
            _particles((fading, None, None), {0: plan.fading[fading]}),
            _particles((None, rising, None), {1: plan.rising[rising]}),
        ]
    )


def triangle_particles(a_to_b: Plan, a_to_c: Plan, b_to_c: Plan) -> Particles:
    """Return the particles of a triangle from the plans of its edges."""
    edge = edge_particles(a_to_b)
    i, j, _ = edge.corner.T
    of_a, of_b = np.flatnonzero(edge.flux[:, 0]), np.flatnonzero(edge.flux[:, 1])
    from_a = _onwards(i[of_a], j[of_a], edge.flux[of_a, 0], a_to_c, at=(0, 2))
    from_b = _onwards(j[of_b], i[of_b], edge.flux[of_b, 1], b_to_c, at=(1, 3))
    return _without_change(_joined(from_a + from_b))


def displace(
    particles: Particles,
    corners: tuple[Lobes, Lobes, Lobes],
    *,
    s: float,
    t: float,
    shares: Float[np.ndarray, "3"] | None = None,
) -> Lobes:
    """Return the lobes at a place of a triangle or an edge.

    Parameters
    ----------
    corners : lobes of A, B, C; of an edge C is not looked at
    s, t : shares of the way from A to B and from there to C
    shares : of the fluxes of A, B and C, if these are not to follow the way

    Examples
    --------
    >>> def spot(y):
    ...     centre = np.array([[0, np.sin(y), np.cos(y)]])
    ...     return Lobes(centre, np.ones(1) / 9, np.ones(1))
    >>> a, b = spot(0.0), spot(0.2)
    >>> from clerestory.gonio.transport import plan_transport
    >>> edge = edge_particles(plan_transport(a, b, angle=0.2))
    >>> between = displace(edge, (a, b, b), s=0.5, t=0.0)
    >>> float(np.arcsin(between.centre[0, 1]).round(6))
    0.1
    """
    if shares is None:
        shares = np.array([(1 - s) * (1 - t), s * (1 - t), t])
    a, b, c = shares
    flux = particles.flux @ [a, b, c * (1 - s), c * s]
    keep = flux > 0
    i, j, k = particles.corner[keep].T
    centre, square = _at(corners[0], i)
    centre_b, square_b = _at(corners[1], j)
    centre, square = _between(
        centre, square, centre_b, square_b, _share(i < 0, j < 0, s)
    )
    centre_c, square_c = _at(corners[2], k)
    centre, square = _between(
        centre, square, centre_c, square_c, _share((i < 0) & (j < 0), k < 0, t)
    )
    return Lobes(centre, np.sqrt(square), flux[keep])


def corner_shares(
    shares: Float[np.ndarray, " corners"],
    fluxes: Float[np.ndarray, " corners"],
    total: float,
) -> Float[np.ndarray, " corners"]:
    """Shares of the corners changed as little as a total flux asks for.

    A corner counts for more by a factor that grows exponentially with its flux. So
    half-way to a cut-off light is that of the open side, as much of it as passes, and
    what is scattered on both sides stays what it is. Where the fluxes of the corners
    differ little, as by Fresnel's formulas, all light changes alike, and shares stay.

    >>> corner_shares(np.array([0.5, 0.5]), np.array([0.1, 0.5]), 0.2).round(6).tolist()
    [0.75, 0.25]
    >>> corner_shares(np.array([0.5, 0.5]), np.array([0.5, 0.6]), 0.52).tolist()
    [0.5, 0.5]
    """
    mean = float(shares @ fluxes)
    if mean <= 0:
        return shares
    alike, cut_off = _ALIKE
    apart = float(np.ptp(fluxes[shares > 0])) / mean
    if apart <= alike:
        return shares
    total = mean + (total - mean) * min((apart - alike) / (cut_off - alike), 1)
    relative = fluxes / mean - 1
    low, high = -_STEEPEST, _STEEPEST
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        tilted = shares * np.exp(middle * relative)
        tilted = tilted / tilted.sum()
        if tilted @ fluxes < total:
            low = middle
        else:
            high = middle
    return np.asarray(tilted)


def _particles(
    corners: tuple[Int[np.ndarray, " particles"] | None, ...],
    flux: dict[int, Float[np.ndarray, " particles"]],
) -> Particles:
    size = len(next(iter(flux.values())))
    none = np.full(size, -1)
    table = np.zeros((size, 4))
    for column, values in flux.items():
        table[:, column] = values
    corner = np.stack([none if part is None else part for part in corners], axis=-1)
    return Particles(corner, table)


def _onwards(
    own: Int[np.ndarray, " moves"],
    other: Int[np.ndarray, " moves"],
    flux: Float[np.ndarray, " moves"],
    plan: Plan,
    *,
    at: tuple[int, int],
) -> list[Particles]:
    """Light that belongs to one end of the edge A–B, on its way to C.

    Parameters
    ----------
    own, other, flux : lobes at this end and the other, and light at this end
    at : columns of the flux at this end and at C
    """
    share = flux / np.bincount(own, flux, len(plan.fading))[own]

    # Each particle goes wherever the light of its lobe goes
    by_source = np.argsort(plan.source, kind="stable")
    start = np.searchsorted(plan.source[by_source], own)
    count = np.searchsorted(plan.source[by_source], own, side="right") - start
    row = np.repeat(np.arange(len(own)), count)
    offset = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    move = by_source[np.repeat(start, count) + offset]
    begin, end = at
    moving = {
        begin: share[row] * plan.sent[move],
        end: share[row] * plan.received[move],
    }
    stays = np.flatnonzero(plan.fading[own])
    rising = np.flatnonzero(plan.rising)

    def ends(
        mine: Int[np.ndarray, " particles"], theirs: Int[np.ndarray, " particles"]
    ) -> tuple[Int[np.ndarray, " particles"], Int[np.ndarray, " particles"]]:
        return (theirs, mine) if begin else (mine, theirs)

    return [
        _particles((*ends(own[row], other[row]), plan.target[move]), moving),
        _particles((*ends(own[stays], other[stays]), None), {begin: flux[stays]}),
        _particles((None, None, rising), {end: plan.rising[rising]}),
    ]


def _joined(parts: list[Particles]) -> Particles:
    return Particles(
        np.concatenate([part.corner for part in parts]),
        np.concatenate([part.flux for part in parts]),
    )


def _without_change(particles: Particles) -> Particles:
    # Join those of the same lobes; leave out the smallest, whose light the others get
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


def _at(
    lobes: Lobes, number: Int[np.ndarray, " particles"]
) -> tuple[Float[np.ndarray, "particles 3"], Float[np.ndarray, " particles"]]:
    # Centres and squared radii; those of no lobe are not used
    number = np.maximum(number, 0)
    return lobes.centre[number], lobes.radius[number] ** 2


def _share(
    no_start: np.ndarray, no_end: np.ndarray, share: float
) -> Float[np.ndarray, " particles"]:
    return np.where(no_end, 0.0, np.where(no_start, 1.0, share))


def _between(
    start: Float[np.ndarray, "particles 3"],
    square: Float[np.ndarray, " particles"],
    end: Float[np.ndarray, "particles 3"],
    end_square: Float[np.ndarray, " particles"],
    share: Float[np.ndarray, " particles"],
) -> tuple[Float[np.ndarray, "particles 3"], Float[np.ndarray, " particles"]]:
    # Along the great circle
    cosine = np.clip(np.einsum("pi,pi->p", start, end), -1, 1)
    angle = np.arccos(cosine)
    sine = np.sqrt(1 - cosine**2)
    straight = sine < 1e-6
    safe = np.where(straight, 1, sine)
    a = np.where(straight, 1 - share, np.sin((1 - share) * angle) / safe)
    b = np.where(straight, share, np.sin(share * angle) / safe)
    centre = a[:, None] * start + b[:, None] * end
    centre /= np.maximum(np.linalg.norm(centre, axis=1, keepdims=True), 1e-12)
    return centre, (1 - share) * square + share * end_square
