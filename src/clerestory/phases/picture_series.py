"""Pictures over time by the matrix equation.

Pictures are yielded one by one. The product is computed in blocks of pixels and time
steps, so that memory does not grow with the number of steps.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from clerestory.bands import Bands
from clerestory.image.picture import Picture
from clerestory.phases.blockwise_product import BlockwiseProduct, Components
from clerestory.phases.matrix_equation import (
    Skies,
    States,
    Term,
    WindowMatrices,
    chains,
    equation_bands,
)
from clerestory.phases.picture_matrices import Camera
from clerestory.phases.receivers import component_count
from clerestory.phases.stored_views import FEW

# Time steps per block: 640,000 pixels × 16 steps take 123 MB
STEPS_PER_BLOCK = 16

# Pixels per block: the memory for coefficients converted from half precision to float32
_PIXELS = 1 << 15


@dataclass(frozen=True, eq=False)
class UncertainPicture:
    """A picture, and the statistical error of its luminance [cd/m²].

    Attributes
    ----------
    error : standard error of each pixel, independent of those of other pixels
    shared : deviations that all pixels have in common, due to T and D; the mean of
        their squares is the variance
    """

    picture: Picture
    error: Float32[np.ndarray, "row column"]
    shared: Float32[np.ndarray, "draw row column"]


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
    series = _Series(windows, terms, camera, skies, states, errors=False).pictures()
    return (found.picture for found in series)


def uncertain_pictures_over_time(
    windows: Sequence[WindowMatrices],
    terms: Sequence[Term],
    camera: Camera,
    skies: Skies,
    states: States | None = None,
    *,
    errors: bool = True,
) -> Iterator[UncertainPicture]:
    """Yield the picture of every time step with its errors; see `pictures_over_time`.

    Matrices with pixels as rows have one error component each. Without `errors`, all
    errors are zero.
    """
    return _Series(windows, terms, camera, skies, states, errors).pictures()


@dataclass(frozen=True, eq=False)
class _Series:
    windows: Sequence[WindowMatrices]
    terms: Sequence[Term]
    camera: Camera
    skies: Skies
    states: States | None
    errors: bool

    def pictures(self) -> Iterator[UncertainPicture]:
        bands = equation_bands(self.windows, self.skies)
        product = BlockwiseProduct(
            self.windows,
            self.terms,
            self.skies,
            self.states,
            np.eye(len(bands)),
            len(self.camera),
            errors=self.errors,
            most_receivers=_PIXELS,
            most_steps=STEPS_PER_BLOCK,
        )
        draws, pixels = FEW if self.errors else 0, len(self.camera)
        light = variance = shared = np.zeros((0, 0, 0), np.float32)
        for block in product.blocks():
            steps = block.times.stop - block.times.start
            if block.rows.start == 0:
                light = np.zeros((len(bands), pixels, steps), np.float32)
                variance = np.zeros((pixels, steps), np.float32)
                shared = np.zeros((draws, pixels, steps), np.float32)
            light[:, block.rows, block.steps] = block.terms.sum(axis=0)
            if self.errors:
                for part in block.components:
                    own, drawn = self._deviations(part, bands)
                    place = block.rows, block.steps[part.steps]
                    variance[place] += own
                    shared[:, *place] += drawn
            if block.rows.stop == pixels:
                yield from self._of_block(block.times, light, variance, shared, bands)

    def _deviations(
        self, part: Components, bands: Bands
    ) -> tuple[np.ndarray, np.ndarray]:
        # Variance of luminance that is independent in each pixel, and shared draws. The
        # first component of a matrix of pixels is independent, all others are shared
        term, _, group = part.source
        luminance = bands.photometric(part.values, axis=1)
        count = int(group == 0 and self._has_error(self.terms[term]))
        others = luminance[count:]
        drawn = np.zeros((FEW, *luminance.shape[1:]), np.float32)
        for number, deviation in enumerate(others):
            drawn[number % FEW] += math.sqrt(FEW) * deviation
        return np.square(luminance[:count]).sum(axis=0), drawn

    def _has_error(self, term: Term) -> bool:
        # Whether the matrices of the pixels have an error component
        return any(
            callable(matrix) or component_count(matrix)
            for chain in chains(self.windows, term.part)
            for matrix in chain.receiving
        )

    def _of_block(
        self,
        times: slice,
        light: np.ndarray,
        variance: np.ndarray,
        shared: np.ndarray,
        bands: Bands,
    ) -> Iterator[UncertainPicture]:
        size = self.camera.rows, self.camera.columns
        for step, moment in enumerate(self.skies.times[times]):
            stamp = np.datetime_as_string(moment, unit="m")
            pixels = np.maximum(light[:, :, step], 0)
            yield UncertainPicture(
                self.camera.picture(pixels, f"TIME= {stamp}", bands=bands),
                np.sqrt(variance[:, step]).reshape(size),
                shared[:, :, step].reshape(len(shared), *size),
            )
