"""Groups of bright directions at many time steps, as glare sources in pictures.

Bright directions belong to one source if the gap between them is at most half the
merging angle, directly or by way of others, which is what the scans of evalglare lead
to in pictures. Directions are first collected in blocks so small that all bright
directions of a block belong to one source; then blocks are joined in a graph, of all
time steps together, whose connected components are the sources.
"""

import importlib

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from clerestory.array_types import Directions, Indices, Values

# Height of blocks, and of the directions that are joined beforehand, as fractions of
# half the merging angle: the diagonal of a block is less than that angle
_BLOCK, _NODE = 0.6, 0.14


class DirectionGroups:
    """Groups of directions that are glare sources when they are bright.

    `gap` is the largest gap between directions of one source, half the merging angle
    [rad].
    """

    def __init__(self, direction: Directions, solid_angle: Values, gap: float) -> None:
        node = _cells(direction, _NODE * gap)
        self._order = np.argsort(node, kind="stable")
        counts = np.bincount(node)
        self._first = np.cumsum(counts) - counts
        middle = direction[self._order[self._first]]
        size = np.sqrt(np.bincount(node, solid_angle))
        block = _cells(middle, _BLOCK * gap)
        self.blocks = int(block.max(initial=-1)) + 1
        self.block = block[node]

        # Pairs of nodes within reach in different blocks, sorted by pairs of blocks
        # (imported here, since scipy.spatial loads slowly)
        tree = importlib.import_module("scipy.spatial").cKDTree(middle)
        widest = gap + float(size.max(initial=0))
        a, b = tree.query_pairs(_chord(widest), output_type="ndarray").T
        distance = np.linalg.norm(middle[a] - middle[b], axis=-1)
        near = distance <= _chord(gap + (size[a] + size[b]) / 2)
        near &= block[a] != block[b]
        a, b = a[near], b[near]
        key = np.minimum(block[a], block[b]) * self.blocks + np.maximum(
            block[a], block[b]
        )
        order = np.argsort(key, kind="stable")
        self._a, self._b = a[order], b[order]
        keys, self._begins = np.unique(key[order], return_index=True)
        self._pairs = np.divmod(keys, max(self.blocks, 1))

    def components(
        self,
        bright: Bool[np.ndarray, "direction step"],
        linked: Bool[np.ndarray, "direction step"],
    ) -> Int[np.ndarray, "block step"]:
        """Return the group of each block at each step, and last that of the sun.

        It is -1 for blocks without bright directions.
        `linked` are the directions that belong to the group of the sun if bright.
        """
        steps = bright.shape[1]
        lit = np.logical_or.reduceat(bright[self._order], self._first, axis=0)
        bits = np.packbits(lit, axis=1)
        both = np.bitwise_or.reduceat(
            bits[self._a] & bits[self._b], self._begins, axis=0
        )
        pair, step = _nonzero(np.unpackbits(both, axis=1, count=steps))
        index, under = _nonzero(bright & linked)
        node, when = _nonzero(lit)

        # Vertices of the graph: bright blocks at each step, and the sun at each step
        count = self.blocks * steps
        used = np.zeros(count + steps, dtype=bool)
        used[self.block[self._order[self._first]][node] * steps + when] = True
        used[count:] = True
        vertex = np.cumsum(used) - 1
        a, b = (one[pair] * steps + step for one in self._pairs)
        a = vertex[np.concatenate([a, self.block[index] * steps + under])]
        b = vertex[np.concatenate([b, count + under])]
        sparse = importlib.import_module("scipy.sparse")
        shape = int(vertex[-1]) + 1, int(vertex[-1]) + 1
        graph = sparse.coo_array((np.ones(a.size, np.int8), (a, b)), shape)
        connected = importlib.import_module("scipy.sparse.csgraph").connected_components
        group = connected(graph, directed=False)[1]
        return np.where(used, group[vertex], -1).reshape(-1, steps)

    def totals(
        self,
        weights: Float[np.ndarray, "weights direction"],
        values: Float[np.ndarray, "direction step"]
        | Bool[np.ndarray, "direction step"],
    ) -> Float[np.ndarray, "weights block step"]:
        """Return the sums of weighted values over the directions of each block."""
        place = self.block, np.arange(self.block.size)
        shape = self.blocks, self.block.size
        csr = importlib.import_module("scipy.sparse").csr_array
        return np.stack([csr((one, place), shape) @ values for one in weights])


def _cells(direction: Directions, height: float) -> Int[np.ndarray, " direction"]:
    # Number of the cell of each direction, from 0: zones of equal height, each cut in
    # parts no wider than high; only cells in use are numbered
    zones = int(np.ceil(np.pi / height))
    theta = np.arccos(np.clip(direction[:, 2], -1, 1))
    zone = np.minimum((theta * zones / np.pi).astype(np.int64), zones - 1)
    edges = np.sin(np.linspace(0, np.pi, zones + 1))
    widest = np.maximum(edges[zone], edges[zone + 1])
    widest = np.where((2 * zone + 1) == zones, 1.0, widest)
    parts = np.ceil(2 * np.pi * widest / height)
    turn = np.arctan2(direction[:, 1], direction[:, 0]) / (2 * np.pi) + 0.5
    part = np.minimum((turn * parts).astype(np.int64), parts.astype(np.int64) - 1)
    most = int(np.ceil(2 * np.pi / height)) + 1
    return np.unique(zone * most + part, return_inverse=True)[1].reshape(-1)


def _nonzero(
    values: Bool[np.ndarray, "row step"] | UInt8[np.ndarray, "row step"],
) -> tuple[Indices, Indices]:
    # As `np.nonzero`, but faster
    row, step = np.divmod(np.flatnonzero(values), values.shape[1])
    return row, step


def _chord(angle: Values | float) -> Values:
    return np.asarray(2 * np.sin(np.minimum(angle, np.pi) / 2))
