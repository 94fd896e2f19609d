"""Daylight factor: ratio of indoor to outdoor illuminance under the overcast sky."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.checks import positive


class DaylightFactors(NamedTuple):
    """Daylight factors of a room, as fractions; uniformity is minimum over mean."""

    mean: float
    median: float
    minimum: float
    uniformity: float


def daylight_factor(
    illuminance: Float[np.ndarray, "*sensor"], *, outdoor_lux: float
) -> Float[np.ndarray, "*sensor"]:
    """Daylight factor of each sensor, as a fraction.

    `outdoor_lux` is the unobstructed horizontal illuminance under the same sky.

    >>> daylight_factor(np.array([200.0]), outdoor_lux=10_000.0).tolist()
    [0.02]
    """
    positive(outdoor_lux, "outdoor illuminance", unit="lux")
    return np.asarray(illuminance / outdoor_lux)


def room_factors(factor: Float[np.ndarray, " sensor"]) -> DaylightFactors:
    """Return the statistics of the daylight factors of a room.

    >>> room_factors(np.array([0.01, 0.02, 0.06])).mean
    0.03
    """
    mean, least = float(factor.mean()), float(factor.min())
    return DaylightFactors(
        mean, float(np.median(factor)), least, least / mean if mean > 0 else 0.0
    )
