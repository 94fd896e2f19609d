"""Fits of cones of directions to particles.

Light diverges from an image of the sun, which may lie behind a curved mirror or before
a lens: the direction in which it arrives varies with position, at first linearly, and
fills an ellipse. Both are fitted to the particles that arrive in a cell by least
squares.

Reference: P. Shirley, B. Wade, P. Hubbard et al., "Global illumination via density
estimation", Rendering Techniques 1995; L. Schjøth et al., "Photon differentials",
GRAPHITE 2007 (first-order variation of particles).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

# Smallest number of particles to which an elliptical cone is fitted, and the factor by
# which it is enlarged; groups of fewer particles have wide circular cones.
_MANY, _ENLARGED = 14, 1.2

# Smallest and largest half angles [rad].
_SHARPEST, _WIDEST = 1e-5, 0.45


@dataclass(frozen=True, eq=False)
class ConeArrays:
    """Elliptical cones in which sunlight arrives near a point.

    The axis at a point x has the direction of `axis` + `gradient` · (x - `point`).

    Attributes
    ----------
    slot : slot of the hash table of each cone
    kind : hash of the surfaces and directions of its particles
    weight : sampling weight
    point, axis : position [m] and direction of the axis there
    gradient : derivative of the direction by position [1/m]
    across : unit vector along the first axis of the ellipse
    width : half widths of the ellipse, as sines
    """

    slot: Int[np.ndarray, " cone"]
    kind: Int[np.ndarray, " cone"]
    weight: Float[np.ndarray, " cone"]
    point: Float[np.ndarray, "cone 3"]
    axis: Float[np.ndarray, "cone 3"]
    gradient: Float[np.ndarray, "cone 3 3"]
    across: Float[np.ndarray, "cone 3"]
    width: Float[np.ndarray, "cone 2"]

    def __add__(self, other: "ConeArrays") -> "ConeArrays":
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return ConeArrays(*(np.concatenate(pair) for pair in pairs))

    @property
    def size(self) -> Float[np.ndarray, " cone"]:
        """Solid angles over π [sr]."""
        return np.asarray(self.width.prod(axis=1))

    def reshaped(
        self, number: Int[np.ndarray, " other"], like: "ConeArrays"
    ) -> "ConeArrays":
        """Return the cones; those of given indices have the shapes of others."""
        parts = {name: part.copy() for name, part in vars(self).items()}
        for name in ("point", "axis", "gradient", "across", "width"):
            parts[name][number] = getattr(like, name)
        return ConeArrays(**parts)

    def strongest(self, most: int) -> "ConeArrays":
        """Return the cones of largest weight in each slot, in order of slots."""
        order = np.lexsort((-self.weight, self.slot))
        slot = self.slot[order]
        rank = np.arange(len(order)) - np.searchsorted(slot, slot)
        return self.some(order[rank < most])

    def some(self, chosen: Int[np.ndarray, " m"]) -> "ConeArrays":
        """Return the cones of given indices."""
        return ConeArrays(*(part[chosen] for part in vars(self).values()))


@dataclass(frozen=True, eq=False)
class Arrivals:
    """Particles that arrive near cells.

    Attributes
    ----------
    point, towards : position [m], and direction from which a particle arrives
    blur : half angle of the cone of directions of neighbours [rad]
    """

    point: Float[np.ndarray, "arrival 3"]
    towards: Float[np.ndarray, "arrival 3"]
    blur: Float[np.ndarray, " arrival"]


def fitted_cones(
    slot: Int[np.ndarray, " cone"],
    kind: Int[np.ndarray, " cone"],
    cone: Int[np.ndarray, " arrival"],
    found: Arrivals,
) -> ConeArrays:
    """Return one cone for each group of arrivals.

    `slot` and `kind` are those of each cone, `cone` is the cone of each arrival; no
    cone is without arrivals.
    """
    count = np.bincount(cone, minlength=len(slot))
    middle, axis = (_means(part, cone, count) for part in (found.point, found.towards))
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    plane = _tangents(axis)
    turn = np.einsum("nij,nj->ni", plane[cone], found.towards - axis[cone])
    step = np.einsum("nij,nj->ni", plane[cone], found.point - middle[cone])
    many = count >= _MANY

    # Linear variation across the axis; damped where particles lie on a line
    square = _moments(step, step, cone)
    size = np.trace(square, axis1=1, axis2=2)
    square += (1e-4 * size + 1e-30)[:, None, None] * np.eye(2)
    slope = _moments(turn, step, cone) @ np.linalg.inv(square)
    slope *= many[:, None, None]
    off = turn - np.einsum("nij,nj->ni", slope[cone], step)

    # Ellipse: an even one has a variance of a quarter of the squared half width
    spread = _moments(off, off, cone) / np.maximum(count - 3, 1)[:, None, None]
    variance, turned = np.linalg.eigh(spread)
    width = 2 * np.sqrt(np.maximum(variance, 0.04 * variance[:, 1:])) + _SHARPEST
    place = np.einsum("nji,nj->ni", turned[cone], off) / width[cone]
    farthest, blur, widest = np.zeros((3, len(slot)))
    np.maximum.at(farthest, cone, np.linalg.norm(place, axis=1))
    np.maximum.at(blur, cone, found.blur)
    np.maximum.at(widest, cone, np.linalg.norm(off, axis=1))
    width *= (np.maximum(farthest, 1) * (_ENLARGED + 4 / count))[:, None]
    loose = np.maximum(2 * blur, 1.5 * widest)
    width = np.where(many[:, None], width, loose[:, None])
    return ConeArrays(
        slot,
        kind,
        np.sqrt(count),
        middle,
        axis,
        np.einsum("nki,nkl,nlj->nij", plane, slope, plane),
        np.einsum("nk,nkj->nj", turned[:, :, 0], plane),
        np.clip(width, _SHARPEST, _WIDEST),
    )


def _tangents(axis: Float[np.ndarray, "cone 3"]) -> Float[np.ndarray, "cone 2 3"]:
    # Two unit vectors across each axis
    helper = np.eye(3)[np.argmin(np.abs(axis), axis=1)]
    right = np.cross(axis, helper)
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    return np.stack([right, np.cross(axis, right)], axis=1)


def _means(
    value: Float[np.ndarray, "arrival 3"],
    cone: Int[np.ndarray, " arrival"],
    count: Int[np.ndarray, " cone"],
) -> Float[np.ndarray, "cone 3"]:
    sums = [np.bincount(cone, part) for part in value.T]
    return np.stack(sums, axis=1) / count[:, None]


def _moments(
    one: Float[np.ndarray, "arrival 2"],
    other: Float[np.ndarray, "arrival 2"],
    cone: Int[np.ndarray, " arrival"],
) -> Float[np.ndarray, "cone 2 2"]:
    # Sums over the arrivals of a cone of the products of components
    found = [[np.bincount(cone, a * b) for b in other.T] for a in one.T]
    return np.moveaxis(np.array(found), -1, 0)
