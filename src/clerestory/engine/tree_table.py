"""Evaluation and sampling of tensor-tree BSDFs in kernels.

A path is traced against the direction of light: the leaving direction is given and the
incident direction is sampled by descent of the tree. Each level selects one of the four
quadrants of the incident direction's square, in proportion to their mean BSDF values
over the given direction's cell at that level. Every quadrant of nonzero mean can be
selected, and no other.

The functions of a layer are concatenated in one table of slots, in the layout of
`bsdf.tensor_tree`.
"""

from collections.abc import Sequence

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.bsdf.resample import exchanged_tree
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import slot_means
from clerestory.colorimetry import RADIANCE
from clerestory.engine.square import cell_of_disc, disc_from_square, square_from_disc
from clerestory.engine.upload import on_device
from clerestory.hemisphere.shirley_chiu import cell_centres, directions_from_square

# Edge of the grid of directions on which hemispherical reflectance or transmittance
# is tabulated.
_GRID = 32

# Least tabulated reflectance or transmittance, so that every function can be sampled.
_LEAST = 1e-3

# Probability of sampling the whole hemisphere, for directions that a resampled tree of
# rank 3 misses.
_DEFENSIVE = 0.05


class TreeTable:
    """Tensor trees of one layer, all of one rank.

    Each function has trees of X, Y and Z, or one tree; it is None if the layer has no
    such function. `other` holds the index of each function's reciprocal function, which
    replaces the function if it is missing.
    """

    def __init__(
        self,
        functions: Sequence[tuple[ScatteringTree, ...] | None],
        other: Sequence[int],
    ):
        present = [part for part in functions if part is not None]
        self.rank = present[0][0].rank
        self.colours = max(len(part) for part in present)
        self.middle = 1 if self.colours == 3 else 0
        trees = [
            None if part is None else part[min(colour, len(part) - 1)]
            for part in functions
            for colour in range(self.colours)
        ]

        # Rank 4 trees are sampled directly, rank 3 trees with exchanged directions
        numbers = range(len(functions))
        known = [part is not None for part in functions]
        own = [n if known[n] else o for n, o in zip(numbers, other, strict=True)]
        self.own = on_device(mi.UInt32, own)
        self.proposals = len(trees)
        if self.rank == 3:
            for number in numbers:
                part = functions[own[number]]
                tree = None if part is None else part[self.middle]
                # A tree that is evaluated with exchanged directions is sampled directly
                trees.append(exchanged_tree(tree) if tree and known[number] else tree)
        self._tabulate(trees)
        shares = [self._shares(functions[n], functions[own[n]]) for n in numbers]
        self.share = on_device(mi.Float, np.concatenate(shares))

    def _tabulate(self, trees: list[ScatteringTree | None]) -> None:
        zero = np.zeros(1, dtype=np.int32)
        slots = [zero if tree is None else tree.slots for tree in trees]
        means = [
            zero.view("f4") if tree is None else slot_means(tree) for tree in trees
        ]
        depth = [0 if tree is None else tree.depth for tree in trees]
        start = np.concatenate([[0], np.cumsum([len(part) for part in slots])[:-1]])
        self.slots = on_device(mi.Int32, np.concatenate(slots))
        self.means = on_device(mi.Float, np.concatenate(means))
        self.depth = on_device(mi.UInt32, depth)
        self.start = on_device(mi.UInt32, start)

    def _shares(self, own, read) -> np.ndarray:
        # Hemispherical reflectance or transmittance over a grid of leaving directions
        if read is None:
            return np.zeros(_GRID * _GRID)
        tree = read[self.middle]
        exact = tree.reciprocal() if own is not None and self.rank == 4 else tree
        direction = directions_from_square(*cell_centres(_GRID.bit_length() - 1))
        return np.maximum(exact.hemispherical(direction), _LEAST)

    def gathered(self, function, leaving):
        """Return the tabulated hemispherical reflectance or transmittance."""
        cell = function * (_GRID * _GRID) + cell_of_disc(leaving, _GRID)
        return dr.gather(mi.Float, self.share, cell)

    def evaluate(self, function, incident, leaving):
        """Return the BSDF (grey or X, Y, Z) and the pdf per projected angle [1/sr]."""
        if self.rank == 4:
            value, density = self._read(function, incident, leaving, (2, 3))
        else:
            own = dr.gather(mi.UInt32, self.own, function)
            swap = own != function
            enter = dr.select(swap, leaving, incident)
            leave = dr.select(swap, incident, leaving)
            value, _ = self._read(own, enter, leave, ())
            number = self.proposals + function
            place = self._places(number, leaving, incident)
            _, density = self._descend(number, place, (0,))
            density = density * (1 - _DEFENSIVE) + _DEFENSIVE * dr.inv_pi
        return value, density

    def colour(self, value):
        """Convert a BSDF value of the table to RGB."""
        return _rgb(value) if self.colours == 3 else value

    def _read(self, function, incident, leaving, fixed):
        # BSDF of all channels, and pdf of sampling the dimensions not in `fixed`
        number = function * self.colours + self.middle
        place = self._places(number, incident, leaving)
        luminous, density = self._descend(number, place, fixed)
        if self.colours == 1:
            return mi.Color3f(luminous), density
        x, z = (
            self._descend(number, self._places(number, incident, leaving), ())[0]
            for number in (function * 3, function * 3 + 2)
        )
        return mi.Color3f(x, luminous, z), density

    def sample(self, function, leaving, u, v):
        """Sample an incident direction; return its disc point, BSDF value and pdf."""
        if self.rank == 4:
            number = function * self.colours + self.middle
            place = self._place(number, square_from_disc(leaving.x, leaving.y))
            point = self._draw(number, {2: place[0], 3: place[1]}, (0, 1), u, v)
            disc = -disc_from_square(point.x, point.y)
        else:
            # Sample the whole hemisphere with the defensive probability
            everywhere = u < _DEFENSIVE
            rest = dr.clip((u - _DEFENSIVE) / (1 - _DEFENSIVE), 0, 0.9999999)
            number = self.proposals + function
            radial = self._radial(number, leaving)
            point = self._draw(number, {0: radial}, (1, 2), rest, v)
            turned = disc_from_square(point.x, point.y)
            c, s = _azimuth(leaving)
            disc = mi.Point2f(c * turned.x - s * turned.y, s * turned.x + c * turned.y)
            disc = dr.select(everywhere, disc_from_square(u / _DEFENSIVE, v), disc)
        height = dr.safe_sqrt(1 - dr.squared_norm(disc))
        incident = mi.Vector3f(disc.x, disc.y, height)
        value, density = self.evaluate(function, incident, leaving)
        return disc, value, density

    def _places(self, number, incident, leaving):
        # Indices of the finest cell along each dimension
        if self.rank == 4:
            one = self._place(number, square_from_disc(-incident.x, -incident.y))
            other = self._place(number, square_from_disc(leaving.x, leaving.y))
            return {0: one[0], 1: one[1], 2: other[0], 3: other[1]}
        c, s = _azimuth(incident)
        x, y = c * leaving.x + s * leaving.y, c * leaving.y - s * leaving.x
        other = self._place(number, square_from_disc(x, y))
        return {0: self._radial(number, incident), 1: other[0], 2: other[1]}

    def _place(self, number, point):
        edge = mi.Int32(1) << mi.Int32(dr.gather(mi.UInt32, self.depth, number))
        cells = [mi.Int32(c * mi.Float(edge)) for c in (point.x, point.y)]
        return [mi.UInt32(dr.clip(cell, 0, edge - 1)) for cell in cells]

    def _radial(self, number, direction):
        # Cell index from half the distance to the disc's rim, 0 to 0.5; the upper half
        # of the tree is unused
        radius = dr.sqrt(dr.square(direction.x) + dr.square(direction.y))
        inwards = dr.clip(0.5 - 1e-6 - 0.5 * radius, 0, 1)
        return self._place(number, mi.Point2f(inwards, inwards))[0]

    @dr.syntax
    def _descend(self, number, place, fixed):
        """Return the BSDF of a cell, and the pdf of sampling a direction in it."""
        start = dr.gather(mi.UInt32, self.start, number)
        code = dr.gather(mi.Int32, self.slots, start)
        height = dr.gather(mi.UInt32, self.depth, number)
        density = mi.Float(dr.inv_pi)
        free = [d for d in range(self.rank) if d not in fixed]
        while code < 0:
            height -= 1
            block = start + mi.UInt32(~code)
            branch = mi.UInt32(0)
            kept = mi.UInt32(0)
            for dimension in range(self.rank):
                bit = ((place[dimension] >> height) & 1) << dimension
                branch |= bit
                if dimension in fixed:
                    kept |= bit
            if dr.hint(len(free) == 2, mode="scalar"):
                total = mi.Float(0)
                for a in range(2):
                    for b in range(2):
                        quarter = block + kept + ((a << free[0]) | (b << free[1]))
                        total += dr.gather(mi.Float, self.means, quarter)
                here = dr.gather(mi.Float, self.means, block + branch)
                density *= dr.select(total > 0, 4 * here / total, 0)
            code = dr.gather(mi.Int32, self.slots, block + branch)
        return dr.reinterpret_array(mi.Float, code), density

    @dr.syntax
    def _draw(self, number, known, free, u, v):
        """Sample a point of the unit square that represents the incident direction."""
        start = dr.gather(mi.UInt32, self.start, number)
        code = dr.gather(mi.Int32, self.slots, start)
        height = dr.gather(mi.UInt32, self.depth, number)
        u, v = mi.Float(u), mi.Float(v)
        corner = mi.Point2f(0)
        size = mi.Float(1)
        while code < 0:
            height -= 1
            block = start + mi.UInt32(~code)
            for dimension, place in known.items():
                block += ((place >> height) & 1) << dimension
            low, high = 1 << free[0], 1 << free[1]
            m00 = dr.gather(mi.Float, self.means, block)
            m10 = dr.gather(mi.Float, self.means, block + low)
            m01 = dr.gather(mi.Float, self.means, block + high)
            m11 = dr.gather(mi.Float, self.means, block + (low + high))

            # Choose one half along each axis; the rescaled random numbers serve the
            # next level
            total = m00 + m01 + m10 + m11
            first = dr.select(total > 0, (m00 + m01) / total, 0.5)
            a = u >= first
            u = dr.select(a, (u - first) / (1 - first), u / first)
            lower, upper = dr.select(a, m10, m00), dr.select(a, m11, m01)
            both = lower + upper
            second = dr.select(both > 0, lower / both, 0.5)
            b = v >= second
            v = dr.select(b, (v - second) / (1 - second), v / second)
            u, v = dr.clip(u, 0, 0.9999999), dr.clip(v, 0, 0.9999999)
            size *= 0.5
            corner.x += dr.select(a, size, 0)
            corner.y += dr.select(b, size, 0)
            branch = dr.select(a, mi.UInt32(low), 0) + dr.select(b, mi.UInt32(high), 0)
            code = dr.gather(mi.Int32, self.slots, block + branch)
        return mi.Point2f(corner.x + size * u, corner.y + size * v)


def _rgb(xyz):
    # Colours outside the gamut of Radiance's primaries are desaturated (bsdf.colour)
    rows = np.linalg.inv(RADIANCE.to_xyz())
    rgb = mi.Color3f(*[sum(float(row[i]) * xyz[i] for i in range(3)) for row in rows])
    least, luminance = dr.min(rgb), xyz[1]
    share = dr.select(least < 0, luminance / (luminance - least), 1)
    return dr.maximum(luminance + share * (rgb - luminance), 0)


def _azimuth(direction):
    # Cosine and sine of the azimuth opposite to a direction (direct transmission)
    radius = dr.sqrt(dr.square(direction.x) + dr.square(direction.y))
    upright = radius == 0
    scale = 1 / dr.select(upright, 1, radius)
    return dr.select(upright, -1, -direction.x * scale), -direction.y * scale
