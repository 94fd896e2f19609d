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
from jaxtyping import Float32

from clerestory.image.camera import Camera
from clerestory.image.picture import Picture
from clerestory.phases.blockwise_product import Block, BlockwiseProduct
from clerestory.phases.column_light import Weights
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
_RESULT, _STEPS = 1 << 29, 128

# Layers of a block of luminance: estimate, its copy, sunlight and its error
_LAYERS = 4

# Pixels per block: the memory for coefficients converted from half precision to float32
_PIXELS = 1 << 15


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
    series = _Series(windows, terms, skies, states, weights, len(camera))
    steps = series.steps(max(1, _steps(len(camera)) // len(bands)))
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
    series = _Series(windows, terms, skies, states, weights, len(camera))
    for found in series.steps(_steps(len(camera))):
        yield found.light.reshape(camera.rows, camera.columns)


def uncertain_luminance_over_time(
    windows: Sequence[WindowMatrices],
    terms: Sequence[Term],
    camera: Camera,
    skies: Skies,
    states: States | None = None,
) -> Iterator[UncertainPixels]:
    """Yield the luminance of every time step with its error; see `pictures_over_time`.

    Matrices with pixels as rows have one error component each.
    """
    weights = equation_bands(windows, skies).weights[None]
    blocks, most = PixelBlocks.of(camera.rows, camera.columns), _steps(len(camera))
    rest = terms, skies, states, weights
    few = windows if blocks.single else [blocks.of_window(each) for each in windows]
    uncertain = _Series(few, *rest, math.prod(blocks.shape), errors=True).steps(most)
    if blocks.single:
        for each in uncertain:
            yield each.pixels(each.light, (camera.rows, camera.columns), blocks.shape)
        return
    certain = _Series(windows, *rest, len(camera)).steps(most)
    for fine, each in zip(certain, uncertain, strict=True):
        yield each.pixels(fine.light, (camera.rows, camera.columns), blocks.shape)


def block_bytes(pixels: int) -> int:
    """Return the memory for a block of time steps of a picture [bytes]."""
    return 4 * _LAYERS * pixels * _steps(pixels)


def _steps(pixels: int) -> int:
    # Number of time steps of a block
    return int(np.clip(_RESULT // (4 * _LAYERS * max(1, pixels)), 4, _STEPS))


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
class _Series:
    windows: Sequence[WindowMatrices]
    terms: Sequence[Term]
    skies: Skies
    states: States | None
    weights: Weights
    pixels: int
    errors: bool = False

    def steps(self, most: int) -> Iterator[_Step]:
        draws, pixels = FEW if self.errors else 0, self.pixels
        product = BlockwiseProduct(
            self.windows,
            self.terms,
            self.skies,
            self.states,
            self.weights,
            pixels,
            errors=self.errors,
            most_receivers=_PIXELS,
            most_steps=most,
        )
        light = variance = shared = np.zeros((0, 0, 0), np.float32)
        for block in product.blocks():
            steps = block.times.stop - block.times.start
            if block.rows.start == 0:
                light = np.zeros((len(self.weights), pixels, steps), np.float32)
                variance = np.zeros((pixels * self.errors, steps), np.float32)
                shared = np.zeros((draws, len(variance), steps), np.float32)
            light[:, block.rows, block.steps] = block.terms.sum(axis=0)
            if self.errors:
                self._add_deviations(block, variance, shared)
            if block.rows.stop == pixels:
                # One copy in the order of steps is faster than a strided copy of each
                np.maximum(light, 0, out=light)
                found = np.ascontiguousarray(np.moveaxis(light, -1, 0))
                for step in range(steps):
                    yield _Step(found[step], variance[:, step], shared[:, :, step])

    def _add_deviations(
        self,
        block: Block,
        variance: Float32[np.ndarray, "pixel step"],
        shared: Float32[np.ndarray, "draw pixel step"],
    ) -> None:
        # Add the variance that is independent in each pixel, and shared draws. The
        # first component of a matrix of pixels is independent, all others are shared.
        # V_d and C_ds come from the same paths: their deviations are summed first
        paired = np.zeros((block.rows.stop - block.rows.start, variance.shape[1]), "f4")
        for part in block.components:
            term, _, group = part.source
            deviations, own = part.values[:, 0], int(group == 0 and self._errs[term])
            steps = block.steps[part.steps]
            if own and self.terms[term].part == "whole":
                variance[block.rows, steps] += np.square(deviations[0])
            elif own:
                paired[:, steps] += deviations[0]
            for number, deviation in enumerate(deviations[own:]):
                drawn = shared[number % FEW, block.rows]
                drawn[:, steps] += math.sqrt(FEW) * deviation
        variance[block.rows] += np.square(paired)

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
