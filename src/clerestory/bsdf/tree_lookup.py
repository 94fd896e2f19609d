"""Lookup in tensor trees, encoded as in `clerestory.bsdf.tensor_tree`.

A *place* is the integer coordinates of a smallest cell, 0 to 2^depth − 1 along each
dimension. The bits of the coordinates, highest first, give the branch on each level.
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Float32, Int, Int32, Int64

from clerestory.array_types import Indices, Slots

_TOP_BITS = 16  # the dense table of upper tree levels has at most 2^16 cells

_Places = Int32[np.ndarray, " pairs"]
_Tops = Int32[np.ndarray, " tops"]


class Cells(NamedTuple):
    """Cells of one size in a tree."""

    level: int  # level of the cells; their edge is 2^-level
    # Coordinates along each dimension, 0 to 2^level − 1
    place: Int64[np.ndarray, "rank cells"]
    value: Float32[np.ndarray, " cells"]  # BSDF [1/sr]


class Slices(NamedTuple):
    """Exit cells for given incident cells, sorted by `owner`."""

    owner: Int64[np.ndarray, " cells"]  # index of the incident cell
    # Lower corner of the cell in the unit square
    corner: Float32[np.ndarray, "2 cells"]
    size: Float32[np.ndarray, " cells"]  # edge of the cell in the unit square
    value: Float32[np.ndarray, " cells"]  # BSDF [1/sr]

    @property
    def flux(self) -> Float[np.ndarray, " cells"]:
        """BSDF times cell area in the unit square; proportional to exit flux."""
        return np.asarray(self.value * self.size.astype(float) ** 2)


def look_up(
    slots: Slots, place: tuple[_Places, ...], *, depth: int
) -> tuple[Float32[np.ndarray, " pairs"], _Places]:
    """BSDF values at integer coordinates, and tree levels of the cells found there."""
    rank = len(place)
    path = morton_codes(place, depth)
    code = np.full(len(path), slots[0], dtype=np.int32)
    level = np.zeros(len(path), dtype=np.int32)
    for height in reversed(range(depth)):
        inner = code < 0
        if not inner.any():
            break
        # Descend one level; places that have reached a leaf are unchanged
        branch = (path >> rank * height).astype(np.int32) & ((1 << rank) - 1)
        np.copyto(code, np.take(slots, ~code + branch, mode="clip"), where=inner)
        level += inner
    return code.view(np.float32), level


def dense_top(slots: Slots, rank: int, depth: int) -> tuple[int, _Tops]:
    """Return an upper tree level and the dense table of the slots on this level.

    A lookup reaches this level in a single step. The values of larger cells are
    repeated in the table.
    """
    halvings = min(depth, _TOP_BITS // rank)
    top = slots[:1]
    branches = np.arange(1 << rank, dtype=np.int32)
    for _ in range(halvings):
        code = np.repeat(top, 1 << rank)
        inner = np.flatnonzero(code < 0)
        code[inner] = slots[~code[inner] + np.resize(branches, len(code))[inner]]
        top = code
    return halvings, top


def values_at(
    slots: Slots, top: tuple[int, _Tops], place: tuple[_Places, ...], *, depth: int
) -> Float32[np.ndarray, " pairs"]:
    """BSDF values at integer coordinates; starts from the table of `dense_top`."""
    rank, (halvings, codes) = len(place), top
    path = morton_codes(place, depth)
    code = np.take(codes, path >> rank * (depth - halvings))
    for height in reversed(range(depth - halvings)):
        inner = np.flatnonzero(code < 0)
        if not len(inner):
            break
        branch = (path[inner] >> rank * height).astype(np.int32) & ((1 << rank) - 1)
        code[inner] = np.take(slots, ~code[inner] + branch)
    return code.view(np.float32)


def cells(slots: Slots, rank: int) -> Iterator[Cells]:
    """Cells of a tree, one group per size."""
    code, place, level = slots[:1], np.zeros((rank, 1), dtype=np.int64), 0
    bits = (np.arange(1 << rank) >> np.arange(rank)[:, None]) & 1
    while len(code):
        inner = code < 0
        yield Cells(level, place[:, ~inner], code[~inner].view(np.float32))
        below = ~code[inner, None] + np.arange(1 << rank, dtype=np.int32)
        code = slots[below.ravel()]
        place = (2 * place[:, inner, None] + bits[:, None]).reshape(rank, -1)
        level += 1


def slices(
    slots: Slots, incident: Int[np.ndarray, "fixed places"], *, depth: int
) -> Slices:
    """Exit cells for each incident cell (the first one or two coordinates)."""
    fixed, count = incident.shape
    owner = np.arange(count)
    code = np.full(count, slots[0], dtype=np.int32)
    corner, size = np.zeros((2, count), dtype=np.float32), 1.0
    found: list[Slices] = []
    halves = np.array([[0, 1, 0, 1], [0, 0, 1, 1]], dtype=np.float32)
    for height in reversed(range(-1, depth)):
        inner = code < 0
        done = ~inner
        edge = np.full(int(done.sum()), size, dtype=np.float32)
        value = code[done].view(np.float32)
        found.append(Slices(owner[done], corner[:, done], edge, value))
        if not inner.any():
            break

        # Descend into the four quarters of the exit cell
        owner, size = owner[inner], size / 2
        bits = (incident[:, owner] >> height) & 1
        branch = bits.T @ (1 << np.arange(fixed))
        below = (~code[inner] + branch)[:, None] + (np.arange(4) << fixed)
        code = slots[below.ravel()]
        corner = corner[:, inner, None] + np.float32(size) * halves[:, None]
        corner, owner = corner.reshape(2, -1), np.repeat(owner, 4)
    owners, corners, sizes, values = (
        np.concatenate(arrays, axis=-1) for arrays in zip(*found, strict=True)
    )
    order = np.argsort(owners, kind="stable")
    return Slices(owners[order], corners[:, order], sizes[order], values[order])


def morton_codes(place: tuple[_Places, ...], depth: int) -> Int[np.ndarray, " pairs"]:
    """Morton codes: branch numbers of all levels, the coarsest in the highest bits."""
    rank = len(place)
    spread = _spread(rank, depth)
    path: Int[np.ndarray, " pairs"] = spread[place[0]]
    for dimension in range(1, rank):
        path = path | (spread[place[dimension]] << dimension)
    return path


@lru_cache(maxsize=16)
def _spread(rank: int, depth: int) -> Indices:
    # All numbers of `depth` bits, with the bits spread `rank` positions apart
    number = np.arange(1 << depth, dtype=np.int64)
    apart: Int64[np.ndarray, " places"] = np.zeros_like(number)
    for bit in range(depth):
        apart |= ((number >> bit) & 1) << rank * bit
    narrow: Int[np.ndarray, " places"] = apart.astype(np.int32)
    return narrow if rank * depth < 31 else apart
