"""Pictures and their luminance over time, by the matrix equation.

Time steps are yielded one by one. The product is computed in blocks of pixels and time
steps, so that memory does not grow with the number of steps. For glare, the bands are
summed before the product, which then takes a third of the time for coloured rooms.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float32, Int

from clerestory.image.camera import Camera
from clerestory.image.picture import Picture
from clerestory.phases.blockwise_product import Block, BlockwiseProduct
from clerestory.phases.column_light import Weights, add_signed
from clerestory.phases.matrix_equation import (
    Skies,
    States,
    Term,
    WindowMatrices,
    chains,
    equation_bands,
)
from clerestory.phases.pixel_blocks import PixelBlocks
from clerestory.phases.receivers import component_count
from clerestory.phases.stored_views import FEW

# Memory for the result of a block of time steps [bytes], and most steps of a block
_RESULT, _STEPS = 3 << 27, 128

# Layers of a block of luminance: estimate, its copy, sunlight and its error
_LAYERS = 4

# Pixels per block: few enough that the block remains in the cache of the processor
_PIXELS = 1 << 12

# Pixels that are transposed together
_STRIP = 64


@dataclass(frozen=True, eq=False)
class UncertainPixels:
    """Luminance of the pixels of a picture, and its statistical error [cd/m²].

    Attributes
    ----------
    blocks : mean luminance of blocks of pixels, for which the errors are given
    error : standard error of each block, independent of those of other blocks
    shared : deviations that all blocks have in common, due to T and D; the mean of
        their squares is the variance
    """

    luminance: Float32[np.ndarray, "row column"]
    blocks: Float32[np.ndarray, "across down"]
    error: Float32[np.ndarray, "across down"]
    shared: Float32[np.ndarray, "draw across down"]


def pictures_over_time(
    windows: Sequence[WindowMatrices],
    terms: Sequence[Term],
    camera: Camera,
    skies: Skies,
    states: States | None = None,
) -> Iterator[Picture]:
    """Yield the picture of every time step, in order.

    The rows of all matrices are the pixels of the camera. With matrices from
    `picture_matrices`, the terms `FIVE_PHASE` give the extended five-phase method.
    """
    bands = equation_bands(windows, skies)
    weights = np.eye(len(bands))
    series = PixelSeries(windows, terms, skies, states, weights, len(camera))
    steps = series.steps(max(1, block_steps(len(camera)) // len(bands)))
    for moment, found in zip(skies.times, steps, strict=True):
        stamp = np.datetime_as_string(moment, unit="m")
        yield camera.picture(found.light, f"TIME= {stamp}", bands=bands)


def luminance_over_time(
    windows: Sequence[WindowMatrices],
    terms: Sequence[Term],
    camera: Camera,
    skies: Skies,
    states: States | None = None,
) -> Iterator[Float32[np.ndarray, "row column"]]:
    """Yield the luminance of every time step [cd/m²]; see `pictures_over_time`."""
    weights = equation_bands(windows, skies).weights[None]
    series = PixelSeries(windows, terms, skies, states, weights, len(camera))
    for found in series.steps(block_steps(len(camera))):
        yield found.light.reshape(camera.rows, camera.columns)


def uncertain_luminance_over_time(
    windows: Sequence[WindowMatrices],
    terms: Sequence[Term],
    camera: Camera,
    skies: Skies,
    states: States | None = None,
    *,
    of_blocks: Sequence[WindowMatrices] | None = None,
) -> Iterator[UncertainPixels]:
    """Yield the luminance of every time step with its error; see `pictures_over_time`.

    Matrices with pixels as rows have one error component each. If `of_blocks` are the
    matrices of blocks of pixels, by `PixelBlocks.divided`, those of pixels need none.
    """
    weights = equation_bands(windows, skies).weights[None]
    blocks, most = PixelBlocks.of(camera.rows, camera.columns), block_steps(len(camera))
    rest = terms, skies, states, weights
    few = of_blocks or blocks.divided(windows)[1]
    count = math.prod(blocks.shape)
    uncertain = PixelSeries(few, *rest, count, errors=True).steps(most)
    if blocks.single:
        for each in uncertain:
            yield each.pixels(each.light, (camera.rows, camera.columns), blocks.shape)
        return
    certain = PixelSeries(windows, *rest, len(camera)).steps(most)
    for fine, each in zip(certain, uncertain, strict=True):
        yield each.pixels(fine.light, (camera.rows, camera.columns), blocks.shape)


def block_bytes(pixels: int) -> int:
    """Return the memory for a block of time steps of a picture [bytes]."""
    return 4 * _LAYERS * pixels * block_steps(pixels)


def block_steps(pixels: int) -> int:
    """Return the number of time steps of a block of a picture."""
    return int(np.clip(_RESULT // (4 * _LAYERS * max(1, pixels)), 4, _STEPS))


def _transpose(
    values: Float32[np.ndarray, "layer some lit"],
    into: Float32[np.ndarray, "step layer pixel"],
    steps: Int[np.ndarray, " lit"],
    rows: slice,
) -> None:
    # Set the values of some pixels at some time steps, strip by strip of pixels
    turned, target = values.transpose(2, 0, 1), into[:, :, rows]
    for first in range(0, values.shape[1], _STRIP):
        strip = np.s_[:, :, first : first + _STRIP]
        target[strip][steps] = turned[strip]


@dataclass(frozen=True, eq=False)
class _Step:
    # Radiance or luminance of the pixels at one time step, and its error, if computed
    light: Float32[np.ndarray, "out pixel"]
    variance: Float32[np.ndarray, " uncertain"]
    shared: Float32[np.ndarray, "draw uncertain"]

    def pixels(
        self,
        luminance: Float32[np.ndarray, "1 all"],
        size: tuple[int, int],
        blocks: tuple[int, int],
    ) -> UncertainPixels:
        """Return a picture with the errors of its blocks."""
        return UncertainPixels(
            luminance.reshape(size),
            self.light.reshape(blocks),
            np.sqrt(self.variance).reshape(blocks),
            self.shared.reshape(-1, *blocks),
        )


@dataclass(frozen=True, eq=False)
class SeriesBlock:
    """Radiance or luminance of some pixels in a block of time steps.

    Attributes
    ----------
    times, steps : see `Block`; the values are those of `steps`
    variance : of each pixel, independent of the other pixels; empty without errors
    shared : deviations that pixels have in common; see `UncertainPixels`
    """

    rows: slice
    times: slice
    steps: Int[np.ndarray, " step"]
    light: Float32[np.ndarray, "out pixel step"]
    variance: Float32[np.ndarray, "uncertain lit"]
    shared: Float32[np.ndarray, "draw uncertain lit"]


@dataclass(frozen=True, eq=False)
class PixelSeries:
    """Radiance or luminance of pixels, or of cells of the sphere, over time.

    `weights` are those of the bands in each output; see `BlockwiseProduct`.
    """

    windows: Sequence[WindowMatrices]
    terms: Sequence[Term]
    skies: Skies
    states: States | None
    weights: Weights
    pixels: int
    errors: bool = False

    def steps(self, most: int) -> Iterator[_Step]:
        """Yield the time steps, computed in blocks of at most `most` steps."""
        draws, pixels = FEW if self.errors else 0, self.pixels
        light = variance = shared = np.zeros((0, 0, 0), np.float32)
        for block in self.blocks(most):
            steps = block.times.stop - block.times.start
            if block.rows.start == 0:
                light = np.zeros((steps, len(self.weights), pixels), np.float32)
                variance = np.zeros((steps, pixels * self.errors), np.float32)
                shared = np.zeros((steps, draws, variance.shape[1]), np.float32)
            # Transposed while the block is in the cache of the processor
            _transpose(block.light, light, block.steps, block.rows)
            if self.errors:
                variance[block.steps, block.rows] = block.variance.T
                _transpose(block.shared, shared, block.steps, block.rows)
            if block.rows.stop == pixels:
                yield from map(_Step, light, variance, shared)

    def blocks(self, most: int, *, rows: int = _PIXELS) -> Iterator[SeriesBlock]:
        """Yield blocks of at most `rows` pixels × `most` time steps."""
        product = BlockwiseProduct(
            self.windows,
            self.terms,
            self.skies,
            self.states,
            self.weights,
            self.pixels,
            errors=self.errors,
            summed=True,
            most_receivers=rows,
            most_steps=most,
        )
        nothing = np.zeros((0, 0), np.float32), np.zeros((0, 0, 0), np.float32)
        for block in product.blocks():
            light = np.maximum(block.terms[0], 0, out=block.terms[0])
            errors = self._deviations(block) if self.errors else nothing
            yield SeriesBlock(block.rows, block.times, block.steps, light, *errors)

    def _deviations(
        self, block: Block
    ) -> tuple[
        Float32[np.ndarray, "pixel step"], Float32[np.ndarray, "draw pixel step"]
    ]:
        # The variance that is independent in each pixel, and shared draws. The first
        # component of a matrix of pixels is independent, all others are shared. V, V_d
        # and C_ds have paths in common: their deviations are summed first
        shape = block.terms.shape[-2:]
        deviation = np.zeros(shape, np.float32)
        shared = np.zeros((FEW, *shape), np.float32)
        for part in block.components:
            term, _, group = part.source
            deviations, own = part.values[:, 0], int(group == 0 and self._errs[term])
            if own:
                add_signed(1, deviation, deviations[0], part.steps)
            for number, other in enumerate(deviations[own:]):
                add_signed(1, shared[number % FEW], other, part.steps)
        shared *= np.float32(math.sqrt(FEW))
        return np.square(deviation, out=deviation), shared

    @cached_property
    def _errs(self) -> list[bool]:
        # Whether the matrices of the pixels of each term have an error component
        return [
            any(
                component_count(matrix)
                for chain in chains(self.windows, term.part)
                for matrix in chain.receiving
            )
            for term in self.terms
        ]
