"""Channels of a generated BSDF as weighted sums of the scene's bands.

All bands of a scene are traced in one pass, and a channel of the BSDF is any weighted
sum of them. Scenes in RGB may hold other values in their three bands, such as the
visible and the solar reflectance of grey materials.
"""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from jaxtyping import Float

from clerestory.bands import RGB, Bands
from clerestory.colorimetry import RADIANCE
from clerestory.errors import InputError

Weights = tuple[float, ...]

# Luminous values, from red, green and blue.
VISIBLE: Mapping[str, Weights] = MappingProxyType(
    {"visible": tuple(RGB.shares.tolist())}
)

# Channels that hold the visible and the solar reflectance of grey materials.
VISIBLE_AND_SOLAR: Mapping[str, Weights] = MappingProxyType(
    {"visible": (1.0, 0.0, 0.0), "solar": (0.0, 1.0, 0.0)}
)

# Chromaticity u', v' of equal-energy white, used where values are zero.
_WHITE_UV = 4 / 19, 9 / 19


def default_weights(bands: Bands) -> Mapping[str, Weights]:
    """Return the channels of a BSDF in some bands: visible, and each band but RGB's."""
    if bands == RGB:
        return VISIBLE
    each = map(tuple, np.eye(len(bands)).tolist())
    single = dict(zip(bands.names, each, strict=True))
    if bands.efficacy is None:
        return single
    return {"visible": tuple(bands.shares.tolist()), **single}


def check_bands(bands: Mapping[str, Weights], count: int) -> None:
    """Refuse bands that are not sums of the `count` bands of the scene."""
    for name, weights in bands.items():
        if len(weights) != count or min(weights) < 0 or not sum(weights) > 0:
            raise InputError(
                f"band {name!r} with the weights {tuple(weights)}; {count} numbers from"
                " 0, not all zero, expected"
            )
    if not bands:
        raise InputError('no band; at least one such as "visible" expected')


def tristimulus(
    channels: Float[np.ndarray, " channel *value"],
) -> Float[np.ndarray, " 3 *value"]:
    """CIE X, Y and Z of red, green and blue; grey scenes are white."""
    rgb = np.broadcast_to(channels, (3, *channels.shape[1:]))
    return np.tensordot(RADIANCE.to_xyz(), rgb, axes=1)


def chromaticity(
    channels: Float[np.ndarray, " channel *value"],
) -> tuple[Float[np.ndarray, " *value"], Float[np.ndarray, " *value"]]:
    """CIE 1976 u' and v' of red, green and blue; white where all are zero.

    References: CIE 15:2004, eq. 8.24.
    """
    x, y, z = tristimulus(channels)
    total = x + 15 * y + 3 * z
    lit = total > 0
    total = np.where(lit, total, 1)
    u, v = (
        np.where(lit, k * part / total, w)
        for k, part, w in ((4, x, _WHITE_UV[0]), (9, y, _WHITE_UV[1]))
    )
    return np.asarray(u), np.asarray(v)
