"""Directions that sample the sphere around a view point, one in each quadtree cell.

Every cell has one direction, at a random place of the cell (stratified sampling), and
represents its solid angle. The luminance of a cell is that of its direction, or better
the mean over the cell.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Directions, Values, Vector
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.hemisphere.sphere_square import (
    adjacent_pairs,
    sphere_from_square,
    square_from_sphere,
)
from clerestory.scene.sphere_cells import SphereCells

# Finest level of the quadtree: cells of 0.1°
FINEST = 11

_QUARTERS = np.array([[0, 0], [0, 1], [1, 0], [1, 1]])


@dataclass(frozen=True, eq=False)
class SphereSamples:
    """Directions that sample the sphere, and the quadtree cells that they represent.

    Attributes
    ----------
    level : level of each cell
    place : row and column of each cell among the 2ⁿ × 2ⁿ cells of its level
    point : place of the direction in the unit square of the equal-area map

    >>> samples = regular_samples(3)
    >>> samples.count, round(float(samples.solid_angle.sum() / np.pi), 9)
    (64, 4.0)
    """

    level: Int[np.ndarray, " cell"]
    place: Int[np.ndarray, "cell 2"]
    point: Float[np.ndarray, "cell 2"]

    __repr__ = brief

    @property
    def count(self) -> int:
        """Number of directions."""
        return int(self.level.size)

    @cached_property
    def direction(self) -> Directions:
        """Unit vectors."""
        return sphere_from_square(self.point)

    @cached_property
    def solid_angle(self) -> Values:
        """Solid angle that each direction represents [sr]."""
        return np.asarray(4 * np.pi / 4.0**self.level)

    @cached_property
    def adjacent(self) -> Int[np.ndarray, "pairs 2"]:
        """Pairs of cells that share an edge, each in both orders, sorted."""
        return adjacent_pairs(self._owners())

    def containing(self, direction: Directions) -> Int[np.ndarray, " direction"]:
        """Return the index of the cell that contains each direction."""
        owner = self._owners()
        place = (square_from_sphere(direction) * len(owner)).astype(np.int64)
        row, column = np.minimum(place, len(owner) - 1).T
        return np.asarray(owner[row, column])

    def split(
        self, which: Bool[np.ndarray, " cell"], random: np.random.Generator
    ) -> "SphereSamples":
        """Split cells in four; the cells that are not split come first."""
        level = np.repeat(self.level[which] + 1, 4)
        place = (2 * self.place[which, None] + _QUARTERS).reshape(-1, 2)
        rest = self.select(~which)
        return SphereSamples(
            np.concatenate([rest.level, level]),
            np.concatenate([rest.place, place]),
            np.concatenate([rest.point, _points(level, place, random)]),
        )

    def select(self, which: slice | np.ndarray) -> "SphereSamples":
        """Return the samples of a slice, a mask or indices."""
        return SphereSamples(self.level[which], self.place[which], self.point[which])

    def centred(self) -> "SphereSamples":
        """Return the samples with the directions in the middle of their cells."""
        return replace(self, point=(self.place + 0.5) / 2.0 ** self.level[:, None])

    def cells(self, position: Vector) -> SphereCells:
        """Return the cells, around a point [m], as receivers of radiance."""
        return SphereCells(position, self.level, self.place)

    def _owners(self) -> Int[np.ndarray, "side side"]:
        # Index of the cell of this value in which each cell of the finest level lies
        finest = int(self.level.max())
        owner = np.empty((1 << finest, 1 << finest), dtype=np.int64)
        for level in np.unique(self.level):
            size = 1 << (finest - level)
            mine = np.flatnonzero(self.level == level)
            blocks = owner.reshape(1 << level, size, 1 << level, size)
            row, column = self.place[mine].T
            blocks[row, :, column] = mine[:, None, None]
        return owner


def regular_samples(level: int, *, seed: int = 1) -> SphereSamples:
    """Return one random direction in each of the 4ⁿ cells of a level."""
    require(
        0 <= level <= FINEST,
        f"level of the cells is {level}; 0 to {FINEST} expected",
    )
    place = np.stack(np.divmod(np.arange(4**level), 1 << level), axis=-1)
    levels = np.full(len(place), level)
    point = _points(levels, place, np.random.default_rng(seed))
    return SphereSamples(levels, place, point)


def _points(
    level: Int[np.ndarray, " cell"],
    place: Int[np.ndarray, "cell 2"],
    random: np.random.Generator,
) -> Float[np.ndarray, "cell 2"]:
    return np.asarray((place + random.random(place.shape)) / 2.0 ** level[:, None])
