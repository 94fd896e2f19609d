"""Radiance of sky patches under the Perez all-weather sky.

The computing time of a sky matrix is dominated by one exponential and one arc cosine
per patch and time step; they are computed in float32, in blocks that fit in the cache,
in parallel.
"""

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Literal

import numpy as np
from jaxtyping import Float, Float32, Int

from clerestory.errors import InputError
from clerestory.hemisphere.partition import RingPartition
from clerestory.sky.perez import PerezSky

Quadrature = Literal["exact", "centres"]

# Values per block: half a megabyte of float32
_BLOCK = 150_000
_MOST_THREADS = 8


def dome_radiance(
    sky: PerezSky,
    diffuse: Float[np.ndarray, " time"],
    *,
    dome: RingPartition,
    quadrature: Quadrature = "exact",
    out: Float32[np.ndarray, "time patch"],
    steps: Int[np.ndarray, " lit"],
) -> None:
    """Write the radiance of the patches [W/(m²·sr)] at the given steps into `out`.

    Parameters
    ----------
    sky : relative luminance distribution at all steps
    diffuse : diffuse horizontal irradiance at all steps [W/m²]
    dome : sky patches
    quadrature : weights of the patches in the scaling to `diffuse`: "exact" projected
        solid angles, or solid angle times cosine at the patch "centres" as in Radiance
    out : result
    steps : indices of the steps
    """
    centres = dome.centres()
    if quadrature not in ("exact", "centres"):
        raise InputError(
            f"unknown quadrature {quadrature!r}; 'exact' or 'centres' expected"
        )
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
