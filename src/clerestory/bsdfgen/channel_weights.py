"""Channels of a generated BSDF as weighted sums of spectral bands of the scene.

All bands of a scene are traced in one pass; each channel of the BSDF is a weighted sum
of bands. The three bands red, green and blue can also hold other reflectances, such as
the visible and the solar reflectance of grey materials.
"""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vector
from clerestory.bands import RGB, Bands
from clerestory.checks import require, within
from clerestory.colorimetry import RADIANCE

Weights = tuple[float, ...]

# Reflectance or transmittance: one value for grey, or three for red, green and blue.
Share = float | Sequence[float]

# Weights of red, green and blue in the luminance.
VISIBLE: Mapping[str, Weights] = MappingProxyType(
    {"visible": tuple(RGB.shares.tolist())}
)

# Weights for scenes with the visible and the solar reflectance in bands 1 and 2.
VISIBLE_AND_SOLAR: Mapping[str, Weights] = MappingProxyType(
    {"visible": (1.0, 0.0, 0.0), "solar": (0.0, 1.0, 0.0)}
)

# Chromaticity u', v' of equal-energy white, used where the BSDF is zero.
_WHITE_UV = 4 / 19, 9 / 19


def channel_values(name: str, value: Share, solar: float | None = None) -> Vector:
    """Return a reflectance or transmittance in the three traced bands.

    With a solar value, band 1 holds the visible, bands 2 and 3 the solar value.
    """
    channels = np.atleast_1d(np.asarray(value, dtype=float))
    within(channels, name, least=0, most=1)
    counts = (1, 3) if solar is None else (1,)
    numbers = " or ".join(map(str, counts))
    valid = channels.ndim == 1 and len(channels) in counts
    require(valid, f"{name} has {channels.size} values; {numbers} expected")
    if solar is None:
        return np.broadcast_to(channels, 3).copy()
    within(solar, f"solar {name}", least=0, most=1)
    return np.array([channels[0], solar, solar])


def system_bands(solar: float | None) -> Mapping[str, Weights]:
    """Weights of the BSDF channels for bands filled by `channel_values`."""
    return dict(VISIBLE if solar is None else VISIBLE_AND_SOLAR)


def default_weights(bands: Bands) -> Mapping[str, Weights]:
    """Default BSDF channels: "visible" and, except for RGB scenes, each scene band."""
    if bands == RGB:
        return VISIBLE
    each = map(tuple, np.eye(len(bands)).tolist())
    single = dict(zip(bands.names, each, strict=True))
    if bands.efficacy is None:
        return single
    return {"visible": tuple(bands.shares.tolist()), **single}


def check_bands(bands: Mapping[str, Weights], count: int) -> None:
    """Raise InputError unless each channel has `count` weights ≥ 0, not all zero."""
    require(bands, 'no band; at least one band such as "visible" expected')
    for name, weights in bands.items():
        require(
            len(weights) == count and min(weights) >= 0 and sum(weights) > 0,
            f"weights {tuple(weights)} of band {name!r}; {count} non-negative"
            " numbers, not all zero, expected",
        )


def tristimulus(
    channels: Float[np.ndarray, " channel *value"],
) -> Float[np.ndarray, " 3 *value"]:
    """CIE X, Y and Z from red, green and blue, or from one grey channel."""
    rgb = np.broadcast_to(channels, (3, *channels.shape[1:]))
    return np.tensordot(RADIANCE.to_xyz(), rgb, axes=1)


def chromaticity(
    channels: Float[np.ndarray, " channel *value"],
) -> tuple[Float[np.ndarray, " *value"], Float[np.ndarray, " *value"]]:
    """CIE 1976 u' and v' from red, green and blue; equal-energy white if all are zero.

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
