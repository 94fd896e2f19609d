"""Partial displacement: the lobes between measured directions, light under way.

Each unit of light of a plan travels from its lobe at the start to its lobe at the end,
its flux and its squared radius changing evenly; what has no partner fades in its place.
It travels in the disc below the hemisphere, in which what a flat face, a prism or a
grating does to light is nearly a shift: a beam between the corners of a triangle
stands between its beams there by the same weights as the incident direction between
the corners.

References: N. Bonneel et al., ACM Transactions on Graphics 30 (6), 2011; G. Ward,
M. Kurt, N. Bonneel, MAM 2014, for the step into triangles.
"""

import numpy as np
from jaxtyping import Bool, Float

from clerestory.gonio.lobes import Lobes
from clerestory.gonio.particles import Particles

# Limits and steps in the search for the shares of corners.
_STEEPEST, _BISECTIONS = 12.0, 40

# Farthest from the normal that lobes move, in the disc.
_HORIZON = 0.9999

# Weights that sum to less say nothing.
_NOTHING = 1e-9

# Differences of the fluxes of corners, relative to their mean, up to which light
# changes alike, and from which on some of it is cut off.
_ALIKE = 0.3, 0.7


def displace(
    particles: Particles,
    corners: tuple[Lobes, Lobes, Lobes],
    *,
    s: float,
    t: float,
    weights: Float[np.ndarray, "3"] | None = None,
    shares: Float[np.ndarray, "3"] | None = None,
) -> Lobes:
    """Return the lobes at a place of a triangle or an edge.

    Parameters
    ----------
    corners : lobes of A, B, C; of an edge C is not looked at
    s, t : shares of the way from A to B and from there to C
    weights : of the places of A, B and C, if these are not to follow the way
    shares : of the fluxes of A, B and C, if these are not to follow the way

    Examples
    --------
    >>> def spot(y):
    ...     centre = np.array([[0, np.sin(y), np.cos(y)]])
    ...     return Lobes(centre, np.ones(1) / 9, np.ones(1))
    >>> a, b = spot(0.0), spot(0.2)
    >>> from clerestory.gonio.particles import edge_particles
    >>> from clerestory.gonio.transport import plan_transport
    >>> edge = edge_particles(plan_transport(a, b, angle=0.2))
    >>> between = displace(edge, (a, b, b), s=0.5, t=0.0)
    >>> float(np.arcsin(between.centre[0, 1]).round(2))
    0.1
    """
    way = np.array([(1 - s) * (1 - t), s * (1 - t), t], dtype=float)
    a, b, c = way if shares is None else shares
    place = way if weights is None else weights
    flux = particles.flux @ [a, b, c * (1 - s), c * s]
    number = particles.corner[flux > 0]
    flux = flux[flux > 0]

    present = number >= 0
    place, way = _among(present, place), _among(present, way)
    disc, square = np.zeros((len(number), 2)), np.zeros(len(number))
    for k, lobes in enumerate(corners):
        at = np.where(present[:, k], number[:, k], 0)
        disc += place[:, k, None] * lobes.centre[at, :2]
        square += way[:, k] * lobes.radius[at] ** 2
    length = np.hypot(*disc.T)
    disc *= np.minimum(1, _HORIZON / np.maximum(length, 1e-12))[:, None]
    height = np.sqrt(1 - np.sum(disc**2, axis=1))
    centre = np.concatenate([disc, height[:, None]], axis=1)
    return Lobes(centre, np.sqrt(square), flux)


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


def _among(
    present: Bool[np.ndarray, "particles 3"], weights: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "particles 3"]:
    # Weights of the corners at which a particle has a lobe, 1 in all
    own = present * weights
    total = own.sum(axis=1, keepdims=True)
    even = present / present.sum(axis=1, keepdims=True)
    lost = np.abs(total) < _NOTHING
    return np.asarray(np.where(lost, even, own / np.where(lost, 1, total)))
