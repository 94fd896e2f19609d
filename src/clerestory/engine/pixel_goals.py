"""Stopping criteria of adaptive pixel sampling.

A criterion gives the error of a picture relative to its target, and the contribution of
each pixel to the square of that error. Paths are distributed by the contributions
(`engine.pixel_allocation`).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.engine.sums import Sums, variance


@dataclass(frozen=True, eq=False)
class PixelEstimates:
    """Mean value and variance of the mean of each pixel, from independent batches."""

    value: Float[np.ndarray, "row column band"]
    variance: Float[np.ndarray, "row column band"]

    @classmethod
    def of(cls, sums: Sums, columns: int) -> "PixelEstimates":
        """Return the estimates of the pixels of rows of a length."""
        batches = sums.collected()
        shape = -1, columns, batches.shape[-1]
        spread = variance(batches, axis=1)
        return cls(batches.mean(axis=1).reshape(shape), spread.reshape(shape))


class PixelGoal(ABC):
    """A target for the error of a picture, or of a quantity computed from a picture."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Name and value of the target, for messages."""

    @abstractmethod
    def error(self, pixels: PixelEstimates) -> float:
        """Return the error of the picture relative to the target."""

    @abstractmethod
    def contributions(self, pixels: PixelEstimates) -> Float[np.ndarray, "row column"]:
        """Return the contribution of each pixel to the squared error, in any unit."""


@dataclass(frozen=True)
class RelativePixelError(PixelGoal):
    """RMS of the standard errors of the pixels, relative to the mean pixel value."""

    target: float

    @property
    def name(self) -> str:
        """Name and value of the target, for messages."""
        return f"the relative error {self.target:g}"

    def error(self, pixels: PixelEstimates) -> float:
        """Return the error of the picture relative to the target; 0 if it is black."""
        mean = float(pixels.value.mean())
        error = float(np.sqrt(pixels.variance.mean()))
        return error / mean / self.target if mean > 0 else 0.0

    def contributions(self, pixels: PixelEstimates) -> Float[np.ndarray, "row column"]:
        """Return the mean variance of the bands of each pixel."""
        mean: np.ndarray = pixels.variance.mean(axis=-1)
        return mean
