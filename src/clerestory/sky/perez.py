"""Perez all-weather sky luminance distribution.

    L ∝ (1 + a exp(b / cos ζ)) (1 + c exp(d γ) + e cos² γ)

with the angles ζ to the zenith and γ to the sun. Since the sky is later scaled to the
diffuse irradiance, each factor is divided by its largest term to avoid overflow.

Reference: R. Perez, R. Seals, J. Michalsky, All-weather model for sky luminance
distribution – preliminary configuration and validation, Solar Energy 50 (3),
1993, with the erratum in 51 (5).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32

from clerestory.sky.sky_state import SkyState

# Table 1: x1, x2, x3, x4 for each of a, b, c, d, e, by clearness category
# fmt: off
_COEFFICIENTS = np.array([
    [1.3525, -0.2576, -0.2690, -1.4366, -0.7670, 0.0007, 1.2734, -0.1233,
     2.8000, 0.6004, 1.2375, 1.0000, 1.8734, 0.6297, 0.9738, 0.2809,
     0.0356, -0.1246, -0.5718, 0.9938],
    [-1.2219, -0.7730, 1.4148, 1.1016, -0.2054, 0.0367, -3.9128, 0.9156,
     6.9750, 0.1774, 6.4477, -0.1239, -1.5798, -0.5081, -1.7812, 0.1080,
     0.2624, 0.0672, -0.2190, -0.4285],
    [-1.1000, -0.2515, 0.8952, 0.0156, 0.2782, -0.1812, -4.5000, 1.1766,
     24.7219, -13.0812, -37.7000, 34.8438, -5.0000, 1.5218, 3.9229, -2.6204,
     -0.0156, 0.1597, 0.4199, -0.5562],
    [-0.5484, -0.6654, -0.2672, 0.7117, 0.7234, -0.6219, -5.6812, 2.6297,
     33.3389, -18.3000, -62.2500, 52.0781, -3.5000, 0.0016, 1.1477, 0.1062,
     0.4659, -0.3296, -0.0876, -0.0329],
    [-0.6000, -0.3566, -2.5000, 2.3250, 0.2937, 0.0496, -5.6812, 1.8415,
     21.0000, -4.7656, -21.5906, 7.2492, -3.5000, -0.1554, 1.4062, 0.3988,
     0.0032, 0.0766, -0.0656, -0.1294],
    [-1.0156, -0.3670, 1.0078, 1.4051, 0.2875, -0.5328, -3.8500, 3.3750,
     14.0000, -0.9999, -7.1406, 7.5469, -3.4000, -0.1078, -1.0750, 1.5702,
     -0.0672, 0.4016, 0.3017, -0.4844],
    [-1.0000, 0.0211, 0.5025, -0.5119, -0.3000, 0.1922, 0.7023, -1.6317,
     19.0000, -5.0000, 1.2438, -1.9094, -4.0000, 0.0250, 0.3844, 0.2656,
     1.0468, -0.3788, -2.4517, 1.4656],
    [-1.0500, 0.0289, 0.4260, 0.3590, -0.3250, 0.1156, 0.7781, 0.0025,
     31.0625, -14.5000, -46.1148, 55.3750, -7.2312, 0.4050, 13.3500, 0.6234,
     1.5000, -0.6426, 1.8564, 0.5636],
]).reshape(8, 5, 4)
# fmt: on

# Largest exponent, to avoid overflow
_LARGEST_EXPONENT = 600.0


@dataclass(frozen=True, eq=False)
class PerezSky:
    """Relative luminance distribution at each time step.

    Attributes
    ----------
    a, b, c, d, e : parameters of the distribution
    sun : unit vectors to the sun, with the zenith angle limited to 3°…90°
    """

    a: Float[np.ndarray, " time"]
    b: Float[np.ndarray, " time"]
    c: Float[np.ndarray, " time"]
    d: Float[np.ndarray, " time"]
    e: Float[np.ndarray, " time"]
    sun: Float[np.ndarray, "time 3"]

    def gradation(
        self, cos_zenith: Float[np.ndarray, " patch"]
    ) -> Float[np.ndarray, "time patch"]:
        """Gradation 1 + a exp(b / cos ζ), up to a factor per time step."""
        exponent = self.b[:, None] / cos_zenith
        largest = np.maximum(exponent.max(axis=1, keepdims=True), 0)
        factor = np.exp(-largest) + self.a[:, None] * np.exp(exponent - largest)
        return np.asarray(factor)

    def indicatrix(
        self, cos_sun: Float32[np.ndarray, "time patch"]
    ) -> Float32[np.ndarray, "time patch"]:
        """Indicatrix 1 + c exp(d γ) + e cos² γ, up to a factor per time step.

        `cos_sun`, cos γ, is overwritten and returned.
        """
        # Divide by the largest of 1, |c| exp(d π) and |e|
        growth = np.maximum(self.d * np.pi, 0)
        size = np.maximum(np.log(np.maximum(np.abs(self.c), 1e-300)) + growth, 0)
        size = np.maximum(size, np.log(np.maximum(np.abs(self.e), 1)))
        one = np.exp(-size).astype(np.float32)[:, None]
        c = np.sign(self.c) * np.exp(
            np.log(np.maximum(np.abs(self.c), 1e-300)) + growth - size
        )
        e = self.e * np.exp(-size)

        np.clip(cos_sun, -1, 1, out=cos_sun)
        gamma = np.arccos(cos_sun)
        gamma *= self.d.astype(np.float32)[:, None]
        gamma -= growth.astype(np.float32)[:, None]
        np.exp(gamma, out=gamma)
        gamma *= c.astype(np.float32)[:, None]
        np.square(cos_sun, out=cos_sun)
        cos_sun *= e.astype(np.float32)[:, None]
        cos_sun += gamma
        cos_sun += one
        return cos_sun

    def select(self, steps: slice | np.ndarray) -> "PerezSky":
        """Return the distribution at the given time steps."""
        return PerezSky(
            self.a[steps], self.b[steps], self.c[steps], self.d[steps], self.e[steps],
            self.sun[steps],
        )  # fmt: skip


def perez_sky(state: SkyState, *, azimuth: Float[np.ndarray, " time"]) -> PerezSky:
    """Return the luminance distribution of the sky (Perez et al. 1993, eqs. 6 to 8)."""
    # Limit the brightness Δ as gendaymtx does
    low = (state.clearness > 1.065) & (state.clearness < 2.8)
    brightness = np.where(low, np.maximum(state.brightness, 0.2), state.brightness)

    x = np.moveaxis(_COEFFICIENTS[state.category], 0, -1)
    z = state.zenith
    a, b, c, d, e = x[:, 0] + x[:, 1] * z + brightness * (x[:, 2] + x[:, 3] * z)

    # c and d of the overcast clearness category (eqs. 7 and 8)
    overcast = state.category == 0
    power = np.maximum(brightness * (x[2, 0] + x[2, 1] * z), 0) ** x[2, 2]
    c_overcast = np.exp(np.minimum(power, _LARGEST_EXPONENT)) - x[2, 3]
    growth = np.minimum(brightness * (x[3, 0] + x[3, 1] * z), _LARGEST_EXPONENT)
    d_overcast = -np.exp(growth) + x[3, 2] + brightness * x[3, 3]
    c = np.where(overcast, c_overcast, c)
    d = np.where(overcast, d_overcast, d)
    d = np.clip(d, -1e6, _LARGEST_EXPONENT)

    sine = np.sin(z)
    sun = np.stack([sine * np.sin(azimuth), sine * np.cos(azimuth), np.cos(z)], axis=-1)
    return PerezSky(a, b, c, d, e, sun)
