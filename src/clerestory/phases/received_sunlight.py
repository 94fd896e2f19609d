"""Sunlight that receivers get from windows, as a factor of the matrix equation."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float, Float32, Int
from scipy.sparse import csc_array

from clerestory.sky.sun_matrix import SunMatrix


@dataclass(frozen=True, eq=False)
class ReceivedSunlight:
    """C_ds S_sun by two batches of paths, in the time steps with sunlight.

    Attributes
    ----------
    steps : indices of the time steps with sunlight
    batches : estimates by both batches
    """

    steps: Int[np.ndarray, " lit"]
    batches: Float32[np.ndarray, "2 out row lit"]

    def mean(self, rows: slice) -> Float32[np.ndarray, "out some lit"]:
        """Return the estimate for some of the rows."""
        one, other = self.batches[:, :, rows]
        return np.asarray((one + other) * np.float32(0.5))

    def error(self, rows: slice) -> Float32[np.ndarray, "out some lit"]:
        """Return the error component for some of the rows."""
        one, other = self.batches[:, :, rows]
        return np.asarray((one - other) * np.float32(0.5))


def received_sunlight(
    matrix: "Sunlit", suns: SunMatrix, weights: Float[np.ndarray, "out band"]
) -> ReceivedSunlight:
    """Return C_ds S_sun, summed over bands with weights and over the suns' colours."""
    found = [matrix.received(*part) for part in suns.weighted(weights)]
    if len(found) == 1:
        return found[0]
    return ReceivedSunlight(found[0].steps, np.sum([f.batches for f in found], axis=0))


@runtime_checkable
class Sunlit(Protocol):
    """Direct-sun coefficients C_ds that are multiplied without being computed."""

    def received(
        self, normal: csc_array, weights: Float[np.ndarray, "out band"]
    ) -> ReceivedSunlight:
        """Return C_ds S_sun, summed over bands with weights.

        `normal` is the direct normal irradiance (sun × step).
        """
