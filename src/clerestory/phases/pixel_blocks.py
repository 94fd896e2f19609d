"""Matrices of blocks of pixels, for the standard errors of pictures.

Errors are needed for glare indices, that is for sums over many pixels. They are
computed for blocks of pixels, which are as few in a picture of any size.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float, Float32, Int
from scipy.sparse import coo_array, csc_array, csr_array

from clerestory.matrix.axis import pixel_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Receiving,
    WindowMatrices,
)
from clerestory.phases.received_sunlight import ReceivedSunlight, Sunlit

# Largest number of blocks along an edge of a picture
_MOST = 128


@dataclass(frozen=True, eq=False)
class PixelBlocks:
    """Division of a picture into blocks of pixels.

    Attributes
    ----------
    rows, columns : first row or column of each block, and the size of the picture
    """

    rows: Int[np.ndarray, " down"]
    columns: Int[np.ndarray, " across"]

    @classmethod
    def of(cls, rows: int, columns: int) -> "PixelBlocks":
        """Return at most 128 × 128 blocks of a picture."""
        step = -(-max(rows, columns) // _MOST)
        counts = -(-rows // step), -(-columns // step)
        edges = zip((rows, columns), counts, strict=True)
        return cls(*(np.arange(n + 1) * size // n for size, n in edges))

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of blocks along both edges."""
        return len(self.rows) - 1, len(self.columns) - 1

    @property
    def single(self) -> bool:
        """Whether every block is one pixel."""
        return self.shape == (self.rows[-1], self.columns[-1])

    def means(
        self, values: Float[np.ndarray, "*batch pixel column"]
    ) -> Float32[np.ndarray, "*batch block column"]:
        """Return the means over the pixels of each block."""
        *batch, pixels, each = values.shape
        wide = values.reshape(math.prod(batch), pixels, each)
        found = np.zeros((len(wide), *self.shape, each), np.float32)
        width = self.columns[-1]
        for number, (first, last) in enumerate(itertools.pairwise(self.rows.tolist())):
            average, strip = (
                self._averages[last - first],
                slice(first * width, last * width),
            )
            for blocks, one in zip(found, wide, strict=True):
                blocks[number] = average @ one[strip].astype(np.float32, copy=False)
        return found.reshape(*batch, math.prod(self.shape), each)

    @cached_property
    def _averages(self) -> dict[int, csr_array]:
        # Matrix that averages over the blocks of a strip, by the height of the strip
        sizes, width = np.diff(self.columns), self.columns[-1]
        own = np.repeat(np.arange(len(sizes)), sizes)
        share = np.repeat(1 / sizes, sizes)
        return {
            height: csr_array(
                coo_array(
                    (
                        np.tile(share / height, height).astype(np.float32),
                        (np.tile(own, height), np.arange(width * height)),
                    )
                )
            )
            for height in np.unique(np.diff(self.rows)).tolist()
        }

    def of_window(self, window: WindowMatrices) -> WindowMatrices:
        """Return the matrices of a window for the blocks of pixels."""
        parts = (window.whole, window.direct, window.sun)
        return WindowMatrices(*(part and self._chain(part) for part in parts))

    def _chain(self, chain: MatrixChain) -> MatrixChain:
        return replace(chain, receiving=tuple(map(self._matrix, chain.receiving)))

    def divided(
        self, windows: Sequence[WindowMatrices]
    ) -> tuple[tuple[WindowMatrices, ...], tuple[WindowMatrices, ...]]:
        """Return the matrices of pixels without errors, and those of blocks with them.

        The matrices of pixels are in single precision, in which they are multiplied.
        """
        if self.single:
            return tuple(windows), tuple(windows)
        return tuple(map(_certain, windows)), tuple(map(self.of_window, windows))

    def _matrix(self, matrix: Receiving) -> Receiving:
        if isinstance(matrix, Sunlit):
            return _SunlitBlocks(self, matrix)
        assert isinstance(matrix, TransferMatrix)
        parts = matrix.components
        return replace(
            matrix,
            values=self.means(matrix.values),
            rows=pixel_axis(self.shape[0] * self.shape[1]),
            components=None if parts is None else self.means(parts),
        )


def _certain(window: WindowMatrices) -> WindowMatrices:
    # Matrices of pixels in single precision, without error components
    def chain(given: MatrixChain) -> MatrixChain:
        return replace(given, receiving=tuple(map(single, given.receiving)))

    def single(matrix: Receiving) -> Receiving:
        if not isinstance(matrix, TransferMatrix):
            return matrix
        values = matrix.values.astype(np.float32, copy=False)
        return replace(matrix, values=values, components=None)

    parts = (window.whole, window.direct, window.sun)
    return WindowMatrices(*(part and chain(part) for part in parts))


@dataclass(frozen=True, eq=False)
class _SunlitBlocks:
    blocks: PixelBlocks
    pixels: Sunlit

    def received(
        self, normal: csc_array, weights: Float[np.ndarray, "out band"]
    ) -> ReceivedSunlight:
        found = self.pixels.received(normal, weights)
        return replace(found, batches=self.blocks.means(found.batches))
