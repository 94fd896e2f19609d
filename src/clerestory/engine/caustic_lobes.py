"""Cones of directions in which refracted and focused sunlight arrives.

Sunlight by way of lenses, prisms and curved mirrors arrives at each point of a room
from few narrow directions. A hash table of small cells holds them (`learned_caustics`),
and paths continue along them with some probability. The density of sampling is known
for every direction, so missing or wrong cones increase the noise but cause no bias.

Reference: M. Teschner et al., "Optimized spatial hashing for collision detection of
deformable objects", Vision, Modeling and Visualization 2003.
"""

from dataclasses import dataclass, replace

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Int

from clerestory.engine.cone_fits import ConeArrays
from clerestory.engine.sampler import mix
from clerestory.engine.upload import on_device, vectors

# Probability that a path continues along a cone where there are any.
_CHANCE = 0.4

# Largest number of cones in a cell, and of those taken from a larger one.
_MOST, _RARE = 96, 16

# Fraction of the samples in a wider cone about each axis, and the ratio of the widths,
# which must keep the wider cone within the hemisphere.
_AROUND, _WIDER = 0.25, 2.0

_MIX = 0x9E3779B9


@dataclass
class Level:
    """Cones of cells of one size [m].

    `owner` is the key of the cell of each slot, or 0; the number of slots is a power
    of 2. `place` and `side` are the indices of the cell along each axis and its class
    of normals.
    """

    size: float
    owner: Int[np.ndarray, " slot"]
    place: Int[np.ndarray, "slot 3"]
    side: Int[np.ndarray, " slot"]
    cones: ConeArrays

    def extended(self, wider: "Level") -> "Level":
        """Return the level with cones of larger cells that its own cells lack.

        Few particles of a faint kind arrive in a small cell, and often none. Without a
        cone, paths would find its light by chance only. A narrower cone of a kind
        replaces the own one: more particles have been fitted by it.
        """
        ratio = round(wider.size / self.size)
        owned = np.flatnonzero(self.owner)
        key = keys(self.place[owned] // ratio, self.side[owned])
        there = key & (len(wider.owner) - 1)
        owned, there = (part[wider.owner[there] == key] for part in (owned, there))
        # The strongest cones of the larger cell, for each cell
        other = wider.cones.strongest(_RARE)
        first, end = (np.searchsorted(other.slot, there + n) for n in (0, 1))
        slot = np.repeat(owned, end - first)
        before = np.cumsum(end - first) - end
        number = np.arange(len(slot)) - np.repeat(before, end - first)
        own, match = _matching(self.cones, slot, other.kind[number])
        rare = other.some(number[match < 0])
        # Weights are roots of power, which is proportional to the areas of the cells
        rare = replace(rare, slot=slot[match < 0], weight=rare.weight / ratio)
        known, number = match[match >= 0], number[match >= 0]
        narrower = other.size[number] < own.size[known]
        own = own.reshaped(known[narrower], other.some(number[narrower]))
        return replace(self, cones=own + rare)


@dataclass
class CausticLobes:
    """Cones of directions for each cell of space and class of surface normals.

    Cells have several sizes; a point in an empty cell has the cones of a larger one.

    Attributes
    ----------
    sizes : edges of the cells of each level, the smallest first [m]
    masks, offsets : number of slots of each level - 1, and its first slot
    owner : key of the cell of each slot
    first : index of the first cone of each slot, and the number of cones
    point, axis, rows, across, width : see `ConeArrays`; rows of the gradient
    cumulative : cumulative probability of the cones of a slot
    """

    sizes: list[mi.Float]
    masks: list[mi.UInt32]
    offsets: list[mi.UInt32]
    owner: mi.UInt32
    first: mi.UInt32
    point: mi.Point3f
    axis: mi.Vector3f
    rows: list[mi.Vector3f]
    across: mi.Vector3f
    width: list[mi.Float]
    cumulative: mi.Float

    @classmethod
    def of(cls, levels: list[Level]) -> "CausticLobes":
        """Return the hash table of the strongest cones of each slot.

        `levels` are in ascending order of size.
        """
        for number in reversed(range(len(levels) - 1)):
            levels[number] = levels[number].extended(levels[number + 1])
        slots = [len(level.owner) for level in levels]
        offsets = np.cumsum([0, *slots])
        kept = levels[0].cones
        for offset, level in zip(offsets[1:], levels[1:], strict=False):
            kept += replace(level.cones, slot=level.cones.slot + offset)
        kept = kept.strongest(_MOST)
        first = np.searchsorted(kept.slot, np.arange(offsets[-1] + 1))
        total = np.cumsum(np.append(0.0, kept.weight))
        before = total[first[kept.slot]]
        whole = total[first[kept.slot + 1]] - before
        return cls(
            sizes=[on_device(mi.Float, [level.size]) for level in levels],
            masks=[on_device(mi.UInt32, [number - 1]) for number in slots],
            offsets=[on_device(mi.UInt32, [offset]) for offset in offsets[:-1]],
            owner=on_device(mi.UInt32, np.concatenate([x.owner for x in levels])),
            first=on_device(mi.UInt32, first),
            point=vectors(mi.Point3f, kept.point),
            axis=vectors(mi.Vector3f, kept.axis),
            rows=[vectors(mi.Vector3f, kept.gradient[:, i]) for i in range(3)],
            across=vectors(mi.Vector3f, kept.across),
            width=[on_device(mi.Float, part) for part in kept.width.T],
            cumulative=on_device(mi.Float, (total[1:] - before) / whole),
        )

    def cone(self, number, place, active=True):
        """Return the frame of a cone at a place, and its half widths."""

        def of(table):
            return dr.gather(type(table), table, number, active)

        apart = place - of(self.point)
        turn = mi.Vector3f(*(dr.dot(of(row), apart) for row in self.rows))
        axis = dr.normalize(of(self.axis) + turn)
        across = of(self.across)
        across = dr.normalize(across - axis * dr.dot(axis, across))
        frame = mi.Frame3f(across, dr.cross(axis, across), axis)
        return frame, mi.Vector2f(*(of(width) for width in self.width))

    def at(self, point: mi.Point3f, normal: mi.Vector3f, active: mi.Bool) -> "Cones":
        """Return the cones in which sunlight may arrive at a point of a surface."""
        size = dr.abs(normal)
        upright = (size.z >= size.x) & (size.z >= size.y)
        axis = dr.select(upright, 2, dr.select(size.x >= size.y, 0, 1))
        along = dr.select(upright, normal.z, dr.select(axis == 0, normal.x, normal.y))
        side = mi.UInt32(axis) * 2 + dr.select(along > 0, mi.UInt32(1), mi.UInt32(0))
        first, end = mi.UInt32(0), mi.UInt32(0)
        levels = zip(self.sizes, self.masks, self.offsets, strict=True)
        for edge, mask, offset in levels:
            key, empty = side, active & (first == end)
            for part in mi.Point3i(dr.floor(point / edge)):
                key = mix(mi.UInt32(part), key * mi.UInt32(_MIX) + 1)
            slot = (key & mask) + offset
            own = empty & (dr.gather(mi.UInt32, self.owner, slot, empty) == key)
            first = dr.select(own, dr.gather(mi.UInt32, self.first, slot, own), first)
            end = dr.select(own, dr.gather(mi.UInt32, self.first, slot + 1, own), end)
        return Cones(self, point, first, end)


@dataclass
class Caustics:
    """Cones of focused sunlight at surfaces, and at the points where paths start."""

    surfaces: CausticLobes | None
    sensors: CausticLobes | None


@dataclass
class Cones:
    """The cones of one slot, a range of the table, at a point."""

    table: CausticLobes
    point: mi.Point3f
    first: mi.UInt32
    end: mi.UInt32

    @property
    def chance(self) -> mi.Float:
        """Probability that a path continues along a cone."""
        return dr.select(self.first < self.end, mi.Float(_CHANCE), 0)

    @dr.syntax
    def sample(self, pick, u, v) -> mi.Vector3f:
        """Sample a direction; `pick` chooses the cone."""
        number = mi.UInt32(self.first)
        found = self.first < self.end
        last = self.end - 1
        searching = found & (number < last)
        while searching:
            reached = dr.gather(mi.Float, self.table.cumulative, number) <= pick
            number += dr.select(reached, mi.UInt32(1), 0)
            searching = reached & (number < last)
        frame, width = self.table.cone(number, self.point, found)
        around = u < _AROUND
        share = dr.select(around, u / _AROUND, (u - _AROUND) / (1 - _AROUND))
        radius = dr.sqrt(share) * dr.select(around, _WIDER, 1)
        sine, cosine = dr.sincos(2 * dr.pi * v)
        x, y = width.x * radius * cosine, width.y * radius * sine
        local = mi.Vector3f(x, y, dr.safe_sqrt(1 - x * x - y * y))
        return dr.select(found, frame.to_world(local), mi.Vector3f(0, 0, 1))

    @dr.syntax
    def pdf(self, direction: mi.Vector3f, active: mi.Bool) -> mi.Float:
        """Return the density of sampling a direction [1/sr]."""
        total, before = mi.Float(0), mi.Float(0)
        number = mi.UInt32(self.first)
        while active & (number < self.end):
            frame, width = self.table.cone(number, self.point)
            until = dr.gather(mi.Float, self.table.cumulative, number)
            local = frame.to_local(direction)
            apart = dr.square(local.x / width.x) + dr.square(local.y / width.y)
            density = dr.select(apart <= 1, 1 - _AROUND, 0)
            density += dr.select(apart <= _WIDER**2, _AROUND / _WIDER**2, 0)
            density *= dr.maximum(local.z, 0) / (dr.pi * width.x * width.y)
            total += (until - before) * density
            before = until
            number += 1
        return total


def _matching(
    own: ConeArrays, slot: Int[np.ndarray, " n"], kind: Int[np.ndarray, " n"]
) -> tuple[ConeArrays, Int[np.ndarray, " n"]]:
    # Own cones in order, and the index of the one of each slot and kind, or -1
    own = own.some(np.lexsort((own.kind, own.slot)))
    mine, wanted = (own.slot << 32) + own.kind, (slot << 32) + kind
    place = np.minimum(np.searchsorted(mine, wanted), len(mine) - 1)
    return own, np.where(mine[place] == wanted, place, -1)


def keys(
    place: Int[np.ndarray, "n 3"], facing: Int[np.ndarray, " n"]
) -> Int[np.ndarray, " n"]:
    """Return the hashes of cells, as `CausticLobes.at` computes them."""
    key = facing.astype(np.uint32)
    for part in place.T.astype(np.int32).view(np.uint32):
        key = _mix(part, key * np.uint32(_MIX) + np.uint32(1))
    return key.astype(np.int64)


def _mix(
    value: Int[np.ndarray, " n"], salt: Int[np.ndarray, " n"]
) -> Int[np.ndarray, " n"]:
    # As `sampler.mix`
    value = value ^ salt
    value = (value ^ (value >> np.uint32(16))) * np.uint32(0x7FEB352D)
    value = (value ^ (value >> np.uint32(15))) * np.uint32(0x846CA68B)
    return np.asarray(value ^ (value >> np.uint32(16)))
