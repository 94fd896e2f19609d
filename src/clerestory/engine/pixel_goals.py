"""Stopping criteria of adaptive pixel sampling.

A criterion gives the error of a picture relative to its target, and the contribution of
each pixel to the square of that error. Paths are distributed by the contributions
(`engine.pixel_allocation`).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.bands import Bands
from clerestory.engine.radiance_jobs import PictureJob
from clerestory.engine.sums import Sums, variance
from clerestory.scene.view import View


@dataclass(frozen=True, eq=False)
class PixelEstimates:
    """Mean value and variance of the mean of each pixel, from independent batches."""

    value: Float[np.ndarray, "row column band"]
    variance: Float[np.ndarray, "row column band"]
    view: View
    bands: Bands

    @classmethod
    def of(cls, sums: Sums, job: PictureJob) -> "PixelEstimates":
        """Return the estimates of the pixels of a picture."""
        batches = sums.collected()
        shape = job.rows, job.columns, batches.shape[-1]
        value = batches.mean(axis=1).reshape(shape)
        spread = variance(batches, axis=1).reshape(shape)
        return cls(value, spread, job.view, job.scene.bands)


class PixelGoal(ABC):
    """A target for the error of a picture, or of a quantity computed from a picture."""

    @abstractmethod
    def check_view(self, view: View, columns: int, rows: int) -> None:
        """Raise `InputError` if the quantity cannot be computed from such pictures."""

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

    def check_view(self, view: View, columns: int, rows: int) -> None:
        """Accept any view."""

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
