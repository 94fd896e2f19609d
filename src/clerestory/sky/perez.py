"""Perez all-weather sky luminance distribution.

    L ∝ (1 + a exp(b / cos ζ)) (1 + c exp(d γ) + e cos² γ)

with the angles ζ to the zenith and γ to the sun. Since the sky is later scaled to the
diffuse irradiance, each factor is divided by its largest term to avoid overflow.

Reference: R. Perez, R. Seals, J. Michalsky, All-weather model for sky luminance
distribution – preliminary configuration and validation, Solar Energy 50 (3),
1993, with the erratum in 51 (5).
"""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float, Float32, Int

from clerestory.array_types import Series
from clerestory.checks import one_of
from clerestory.hemisphere.partition import RingPartition
from clerestory.sky.sky_state import SkyState

Quadrature = Literal["exact", "centres"]

# Values per block, half a megabyte of float32, so that a block fits in the cache
_BLOCK = 150_000
_MOST_THREADS = 8

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
    """Relative luminance distribution of the Perez sky at each time step.

    `parameters` are a, b, c, d and e; `sun` has unit vectors to the sun, whose zenith
    angle is limited to 3°…90°.
    """

    parameters: Float[np.ndarray, "five time"]
    sun: Float[np.ndarray, "time 3"]

    def gradation(
        self, cos_zenith: Float[np.ndarray, " patch"]
    ) -> Float[np.ndarray, "time patch"]:
        """Gradation 1 + a exp(b / cos ζ), scaled by a factor per time step."""
        a, b = self.parameters[:2, :, None]
        exponent = b / cos_zenith
        largest = np.maximum(exponent.max(axis=1, keepdims=True), 0)
        return np.asarray(np.exp(-largest) + a * np.exp(exponent - largest))

    def indicatrix(
        self, cos_sun: Float32[np.ndarray, "time patch"]
    ) -> Float32[np.ndarray, "time patch"]:
        """Indicatrix 1 + c exp(d γ) + e cos² γ, scaled by a factor per time step.

        The array `cos_sun` of cos γ is overwritten with the result.
        """
        # Divide by the largest of 1, |c| exp(d π) and |e|
        _, _, c, d, e = self.parameters
        growth = np.maximum(d * np.pi, 0)
        scale = np.log(np.maximum(np.abs(c), 1e-300)) + growth
        size = np.maximum(np.maximum(scale, 0), np.log(np.maximum(np.abs(e), 1)))
        one, growth, c, d, e = (
            part.astype(np.float32)[:, None]
            for part in (
                np.exp(-size),
                growth,
                np.sign(c) * np.exp(scale - size),
                d,
                e * np.exp(-size),
            )
        )

        np.clip(cos_sun, -1, 1, out=cos_sun)
        gamma = np.arccos(cos_sun)
        gamma *= d
        gamma -= growth
        np.exp(gamma, out=gamma)
        gamma *= c
        np.square(cos_sun, out=cos_sun)
        cos_sun *= e
        cos_sun += gamma
        cos_sun += one
        return cos_sun

    def select(self, steps: slice | np.ndarray) -> "PerezSky":
        """Return the distribution at the given time steps."""
        return PerezSky(self.parameters[:, steps], self.sun[steps])


def perez_sky(state: SkyState, *, azimuth: Series) -> PerezSky:
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
    return PerezSky(np.stack([a, b, c, d, e]), sun)


def dome_radiance(
    sky: PerezSky,
    diffuse: Series,
    *,
    dome: RingPartition,
    quadrature: Quadrature = "exact",
    out: Float32[np.ndarray, "time patch"],
    steps: Int[np.ndarray, " lit"],
) -> None:
    """Write the patch radiance [W/(m²·sr)] at the given time steps into `out`.

    The sky is scaled to the diffuse horizontal irradiance [W/m²]. Patches are weighted
    by their "exact" projected solid angle, or by solid angle times cosine at the patch
    "centres" as in Radiance. One exponential and one arc cosine per patch and step
    dominate the computing time; they are computed in float32, in parallel.
    """
    one_of(quadrature, "quadrature", choices=("exact", "centres"))
    centres = dome.centres()
    weight = dome.projected_solid_angles()
    if quadrature == "centres":
        weight = dome.solid_angles() * centres[:, 2]
    rings = centres[dome.first, 2]
    towards = np.ascontiguousarray(centres.T, dtype=np.float32)
    weight = weight.astype(np.float32)
    size = max(1, _BLOCK // len(dome))

    def fill(start: int) -> None:
        at = steps[start : start + size]
        part = sky.select(at)
        block = part.indicatrix(part.sun.astype(np.float32) @ towards)
        gradation = part.gradation(rings).astype(np.float32)
        block *= np.repeat(gradation, dome.count, axis=1)
        np.maximum(block, 0, out=block)

        # Scale to the diffuse irradiance; use a uniform sky where the model gives zero
        total = block @ weight
        dark = ~(total > 1e-30)
        block[dark] = 1
        total[dark] = weight.sum()
        block *= (diffuse[at] / total).astype(np.float32)[:, None]
        out[at] = block

    with ThreadPoolExecutor(min(os.cpu_count() or 1, _MOST_THREADS)) as pool:
        list(pool.map(fill, range(0, len(steps), size)))
