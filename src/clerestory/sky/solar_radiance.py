"""Direct sun as radiance of sky patches.

Radiance distributes the sun over the four nearest patches. Methods with a separate
direct sun need it in one patch, at the mean radiance of the patch or at the radiance of
the solar disc.
"""

import math
from typing import Literal

import numpy as np
from jaxtyping import Float
from scipy.sparse import coo_array, csc_array

from clerestory.constants import SUN_DIAMETER
from clerestory.errors import InputError
from clerestory.hemisphere.reinhart import SkyPartition
from clerestory.sky.nearest_patches import nearest_patches

SunPlacement = Literal["spread", "patch", "disc"]

SUN_DIAMETER_DEG = math.degrees(SUN_DIAMETER)
_WIDEST_SUN_DEG = 30.0

# Number of nearest patches and softening of their weights in gendaymtx
_NEIGHBOURS = 4
_SOFTENING = 1.002

# Smallest direct irradiance that counts [W/m²], as in gendaymtx: 1e-4 lux
_THRESHOLD = 1e-4 / 179


def sun_radiance(
    direct: Float[np.ndarray, " time"],
    directions: Float[np.ndarray, "time 3"],
    *,
    partition: SkyPartition,
    placement: SunPlacement = "spread",
    diameter_deg: float = SUN_DIAMETER_DEG,
) -> csc_array:
    """Return the radiance of the sun in each patch at each step [W/(m²·sr)].

    Parameters
    ----------
    direct : visible direct normal irradiance [W/m²]
    directions : unit vectors to the sun
    partition : sky patches
    placement : "spread" over the four nearest patches, weighted by proximity;
        all in the nearest "patch"; in the nearest patch at the radiance of the
        solar "disc", for direct-sun matrices traced with such discs
    diameter_deg : apparent diameter of the disc

    Raises
    ------
    InputError : an unknown placement, a diameter of 0 or above 30°
    """
    if placement not in ("spread", "patch", "disc"):
        raise InputError(
            f"unknown placement of the sun {placement!r};"
            " 'spread', 'patch' or 'disc' expected"
        )
    if not 0 < diameter_deg <= _WIDEST_SUN_DEG:
        raise InputError(
            f"sun of {diameter_deg}°; a diameter up to {_WIDEST_SUN_DEG:g}° expected"
        )
    up = np.flatnonzero(direct > _THRESHOLD)
    count = _NEIGHBOURS if placement == "spread" else 1
    distance, near = nearest_patches(partition.dome, directions[up], count=count)

    # Weight by proximity: distance² = 2 − 2 cos γ
    weight = 1 / (_SOFTENING - 1 + distance**2 / 2)
    weight /= weight.sum(axis=1, keepdims=True)
    if placement == "disc":
        solid_angle = np.full(near.shape, np.pi * np.radians(diameter_deg / 2) ** 2)
    else:
        solid_angle = partition.dome.solid_angles()[near]
    radiance = (direct[up, None] * weight / solid_angle).astype(np.float32)
    step = np.repeat(up, count)
    shape = (len(partition), len(direct))
    return csc_array(
        coo_array((radiance.ravel(), (near.ravel() + 1, step)), shape=shape)
    )
