"""Displacement interpolation of lobes between measured incident directions.

Transport plans match lobes at one incident direction with lobes at the next. Between
the two directions, flux and squared radius are interpolated linearly; the flux of
lobes without a match fades at constant position. If the total flux is known, lobe
fluxes are scaled to it, most where they differ most between the corners.

Lobe centres are interpolated linearly in the unit disc onto which the hemisphere is
projected. In the disc, flat surfaces, prisms and gratings nearly translate the incident
direction, so that a beam has the same barycentric coordinates as that direction.

References: N. Bonneel et al., ACM Transactions on Graphics 30 (6), 2011; G. Ward, M.
Kurt, N. Bonneel, MAM 2014, for triangles.
"""

import numpy as np
from jaxtyping import Bool, Float

from clerestory.array_types import Values, Vector
from clerestory.gonio.angles import directions_over_disc
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.particles import Particles

# Newton's method in `with_total`: largest |power|, largest number of steps, tolerance.
_STEEPEST, _STEPS, _STEP_ENDS = 60.0, 20, 1e-9

# Sum of corner weights below which equal weights are used instead.
_NOTHING = 1e-9


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
    particles : matched lobes of the triangle or edge, with their fluxes
    corners : lobes at the corners A, B and C; C is ignored on edges
    s, t : fraction of the way from A to B, and from that point to C
    weights : barycentric coordinates for lobe positions; default: computed from s and t
    total : total flux per incident flux; None or NaN keeps the interpolated flux

    Examples
    --------
    >>> def spot(y):
    ...     centre = np.array([[0, np.sin(y), np.cos(y)]])
    ...     return Lobes(centre, np.ones(1) / 9, np.ones(1))
    >>> a, b = spot(0.0), spot(0.2)
    >>> from clerestory.gonio.particles import edge_particles
    >>> from clerestory.gonio.optimal_transport import plan_transport
    >>> edge = edge_particles(plan_transport(a, b, angle=0.2))
    >>> between = displace(edge, (a, b, b), s=0.5, t=0.0)
    >>> float(np.arcsin(between.centre[0, 1]).round(2))
    0.1
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
    """Scale fluxes to a given sum, most where they differ between corners.

    Each flux is multiplied by exp(power · change), with a common power found by
    Newton's method, so that no flux becomes negative.

    `change`: mean relative deviation of the corner fluxes from the interpolated flux.

    >>> with_total(np.array([0.3, 0.2]), np.array([1.0, 0.0]), 0.4).round(6).tolist()
    [0.2, 0.2]
    >>> with_total(np.array([0.3, 0.2]), np.ones(2), 0.25).round(6).tolist()
    [0.15, 0.1]
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
    # Normalize weights over the corners at which a matched lobe exists
    own = present * weights
    total = own.sum(axis=1, keepdims=True)
    even = present / present.sum(axis=1, keepdims=True)
    lost = np.abs(total) < _NOTHING
    return np.asarray(np.where(lost, even, own / np.where(lost, 1, total)))
