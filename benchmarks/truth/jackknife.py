"""Glare indices of pictures traced in independent parts, with standard errors.

The indices grow with the noise of pixels. The jackknife estimate, from all parts and
from all but one of them, is free of this bias to first order.
"""

from dataclasses import dataclass

import numpy as np

import clerestory as cl
from clerestory.image.camera import Camera

INDICES = "dgp", "dgi"


@dataclass(frozen=True, eq=False)
class Estimated:
    """Values and their standard errors."""

    value: np.ndarray
    error: np.ndarray

    @classmethod
    def jackknifed(cls, whole: np.ndarray, others: np.ndarray) -> "Estimated":
        """Return the estimate from all parts, and without each of them (part, …)."""
        parts = len(others)
        value = parts * whole - (parts - 1) * others.mean(axis=0)
        spread = np.square(others - others.mean(axis=0)).sum(axis=0)
        return cls(value, np.sqrt(spread * (parts - 1) / parts))


def indices(camera: Camera, radiance: np.ndarray) -> np.ndarray:
    """Return DGP and DGI of pixels (pixel, channel)."""
    found = cl.evaluate_glare(camera.picture(radiance.T), trust=True)
    return np.array([found.values()[name] for name in INDICES])


def glare(camera: Camera, parts: np.ndarray) -> Estimated:
    """Return DGP and DGI of independent parts (part, pixel, channel)."""
    total, count = parts.sum(axis=0), len(parts)
    others = [indices(camera, (total - part) / (count - 1)) for part in parts]
    made = Estimated.jackknifed(indices(camera, total / count), np.array(others))
    # DGP is at most 1
    limit = np.array([1.0, np.inf])
    return Estimated(np.minimum(made.value, limit), made.error)
