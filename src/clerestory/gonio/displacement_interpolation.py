"""Partial displacement: the lobes between measured directions, light under way.

Each unit of light of a plan travels from its lobe at the start to its lobe at the end,
its flux and its squared radius changing evenly; what has no partner fades in its place.
Where the total flux is known it asks for more or less light than that, and what changes
between the corners gives or takes the difference: half-way to a cut-off light is that
of the open side, as much of it as passes, and beside a mirror's beam that grows
towards grazing incidence scattered light stays what it is.

It travels in the disc below the hemisphere, in which what a flat face, a prism or a
grating does to light is nearly a shift: a beam between the corners of a triangle
stands between its beams there by the same weights as the incident direction between
the corners.

References: N. Bonneel et al., ACM Transactions on Graphics 30 (6), 2011; G. Ward,
M. Kurt, N. Bonneel, MAM 2014, for the step into triangles.
"""

import numpy as np
from jaxtyping import Bool, Float

from clerestory.array_types import Values, Vector
from clerestory.gonio.angles import above
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.particles import Particles

# Limit of the exponent by which light changes, and the steps in its search.
_STEEPEST, _STEPS, _STEP_ENDS = 60.0, 20, 1e-9

# Weights that sum to less say nothing.
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
    """Return the lobes at a place of a triangle or an edge.

    Parameters
    ----------
    corners : lobes of A, B, C; of an edge C is not looked at
    s, t : shares of the way from A to B and from there to C
    weights : of the places of A, B and C, if these are not to follow the way
    total : flux of all lobes, if it is not to follow the way; finite or not a number,
        which says nothing

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
    return Lobes(above(disc), np.sqrt(square), flux)


def with_total(flux: Values, change: Values, total: float) -> Values:
    """Fluxes that sum to a total, changed most where light differs between corners.

    Each is multiplied by the exponential of its own relative change times a number
    that all share, so none becomes negative, and where all change alike, as by
    Fresnel's formulas, all are scaled alike. The number is found by Newton's method.

    Parameters
    ----------
    change : mean deviation of the fluxes of the corners from that between them, as a
        share of it

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
    # Weights of the corners at which a particle has a lobe, 1 in all
    own = present * weights
    total = own.sum(axis=1, keepdims=True)
    even = present / present.sum(axis=1, keepdims=True)
    lost = np.abs(total) < _NOTHING
    return np.asarray(np.where(lost, even, own / np.where(lost, 1, total)))
