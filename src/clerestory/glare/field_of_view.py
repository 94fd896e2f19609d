"""Guth's field of view, total and binocular.

The limits are angles from the line of sight as functions of the azimuth around the line
of sight.
"""

from typing import Literal

import numpy as np

from clerestory.array_types import Mask, Values

FieldOfView = Literal["total", "binocular"]

# Upper limit of the binocular field of view [rad]
_BROW = np.radians(60)
# Angle tau above which the total field of view has a lower limit [rad]
_CHEEK = np.radians(135)


def in_field(sigma: Values, tau: Values, below: Mask, *, field: FieldOfView) -> Mask:
    """Whether directions are seen by either eye ("total") or by both ("binocular").

    Directions are given by their angle sigma from the line of sight, and their azimuth
    tau around it from the upward vertical [rad].

    Reference: Guth, S. K. (1958): Light and comfort. Industrial Medicine and Surgery
    27. The fitted curves are those of evalglare 3.06 (options -g and -G).
    """
    around = np.degrees(tau)
    from_below = 180 - around
    if field == "binocular":
        limit = np.where(below, np.radians(_lower_binocular(from_below)), _BROW)
        return np.asarray(sigma <= limit)
    upper = np.radians(_upper_total(around))
    lower = np.where(tau > _CHEEK, np.radians(_lower_total(from_below)), np.inf)
    return np.asarray(sigma <= np.where(below, lower, upper))


def _upper_total(tau: np.ndarray) -> np.ndarray:
    root = np.polyval([8.5572726e-6, -0.00021746318, 0.00057407915, 7.7458218], tau)
    return np.asarray(root**2)


def _lower_total(tau: np.ndarray) -> np.ndarray:
    # Limit τ to 45° from the downward vertical, since the fit has a pole beyond
    tau = np.minimum(tau, 45)
    inverse = np.polyval([5.1539687e-8, -4.6898068e-6, 1.5541106e-5, 0.014699242], tau)
    return np.asarray(1 / inverse)


def _lower_binocular(tau: np.ndarray) -> np.ndarray:
    above = np.polyval([0.046674262, -2.9524084, 68.227109], tau)
    under = np.polyval([-6.5364285e-7, 0.00075698419, -0.042317294, 1.0], tau)
    return np.where(tau > 73, 60.0, above / under)
