"""Validation of parameters of parametric systems: reflectances and lengths."""

from collections.abc import Mapping, Sequence

import numpy as np

from clerestory.array_types import Vector
from clerestory.bsdfgen.channel_weights import VISIBLE, VISIBLE_AND_SOLAR, Weights
from clerestory.errors import InputError

# Reflectance or transmittance: one value for grey, or three for red, green and blue.
Share = float | Sequence[float]


def channel_values(name: str, value: Share, solar: float | None = None) -> Vector:
    """Return a reflectance or transmittance in the three traced channels.

    Parameters
    ----------
    name : name of the parameter, for error messages
    solar : solar value; the three channels are then visible, solar and solar

    Examples
    --------
    >>> channel_values("reflectance", 0.5, solar=0.4).tolist()
    [0.5, 0.4, 0.4]
    """
    channels = np.atleast_1d(np.asarray(value, dtype=float))
    if channels.shape not in ((1,), (3,)) or not np.all(
        (channels >= 0) & (channels <= 1)
    ):
        raise InputError(f"{name} = {value}; one or three values from 0 to 1 expected")
    if solar is None:
        return np.broadcast_to(channels, 3).copy()
    if len(channels) == 3 or not 0 <= solar <= 1:
        raise InputError(
            f"{name} = {value} and {solar} in the solar band; one value from 0 to 1 for"
            " each band expected"
        )
    return np.array([channels[0], solar, solar])


def bands(*, solar: bool) -> Mapping[str, Weights]:
    """BSDF channels that match the traced channels of `channel_values`."""
    return dict(VISIBLE_AND_SOLAR if solar else VISIBLE)


def check_positive(**lengths: float) -> None:
    """Raise InputError unless all lengths are positive."""
    for name, value in lengths.items():
        if not (np.isfinite(value) and value > 0):
            raise InputError(f"{name} = {value}; a length above 0 m expected")


def check_not_negative(**lengths: float) -> None:
    """Raise InputError if a length is negative."""
    for name, value in lengths.items():
        if not (np.isfinite(value) and value >= 0):
            raise InputError(f"{name} = {value}; a length of 0 m or more expected")
