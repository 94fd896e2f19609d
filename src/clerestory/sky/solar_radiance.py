"""Direct sun as radiance of sky patches.

Radiance's gendaymtx distributes the direct sun over the four nearest patches. Methods
with a separate direct-sun term assign it to one patch, either at the mean radiance of
the patch or at the radiance of the solar disc.
"""

import math
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_array, csc_array

from clerestory.array_types import Series
from clerestory.checks import one_of, require
from clerestory.constants import SUN_DIAMETER
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.reinhart import SkyPartition

SunPlacement = Literal["spread", "patch", "disc"]

SUN_DIAMETER_DEG = math.degrees(SUN_DIAMETER)
_WIDEST_SUN_DEG = 30.0

# Number of nearest patches that gendaymtx illuminates, and constant s in the patch
# weights 1 / (s − cos γ), with the angle γ to the sun
_NEIGHBOURS = 4
_SOFTENING = 1.002

# Direct irradiance up to which the sun is ignored [W/m²], as in gendaymtx: 1e-4 lux
_THRESHOLD = 1e-4 / 179

# Number of rings, and of patches per ring, that are searched for the nearest patches;
# sufficient since patches are at most 1.5 times as wide as high
_RINGS = 5
_MOST = 4


class Nearest(NamedTuple):
    """Patches nearest to each direction, in order of distance between unit vectors."""

    distance: Float[np.ndarray, "direction neighbour"]
    patch: Int[np.ndarray, "direction neighbour"]


def sun_radiance(
    direct: Series,
    directions: Float[np.ndarray, "time 3"],
    *,
    partition: SkyPartition,
    placement: SunPlacement = "spread",
    diameter_deg: float = SUN_DIAMETER_DEG,
) -> csc_array:
    """Return the direct-sun radiance of each patch at each time step [W/(m²·sr)].

    Direct normal irradiance [W/m²] is assigned to patches; "spread": to the nearest
    four patches, with gendaymtx's weights; "patch": to the nearest patch, at the mean
    radiance of the patch; "disc": to the nearest patch, at the radiance of the solar
    disc, for direct-sun matrices traced with solar discs.
    """
    one_of(placement, "placement of the sun", choices=("spread", "patch", "disc"))
    require(
        0 < diameter_deg <= _WIDEST_SUN_DEG,
        f"the diameter of the sun is {diameter_deg}°; above 0 and up to"
        f" {_WIDEST_SUN_DEG:g}° expected",
    )
    up = np.flatnonzero(direct > _THRESHOLD)
    count = _NEIGHBOURS if placement == "spread" else 1
    distance, near = nearest_patches(partition.dome, directions[up], count=count)

    # Weights of gendaymtx, with distance² = 2 − 2 cos γ
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


def nearest_patches(
    dome: RingPartition, directions: Float[np.ndarray, "direction 3"], *, count: int
) -> Nearest:
    """Return the sky patches whose centres are nearest to the given directions.

    scipy.spatial.cKDTree finds the same patches, but takes 0.2 s to load.
    """
    centres = dome.centres()
    rings = min(_RINGS, len(dome.count))

    # Rings of patches to be searched, around the altitude of each direction
    height = np.arcsin(centres[dome.first, 2])
    altitude = np.arcsin(np.clip(directions[:, 2], -1, 1))
    own = np.abs(height[:, None] - altitude).argmin(axis=0)
    ring = np.clip(own - rings // 2, 0, len(height) - rings)[:, None] + np.arange(rings)

    # Patches to be searched in each ring, adjacent to the azimuth; the first patch of a
    # ring is in the north
    each = dome.count[ring]
    azimuth = np.arctan2(directions[:, 0], directions[:, 1])[:, None]
    offset = np.arange(_MOST)
    place = np.floor(azimuth * each / (2 * np.pi)).astype(int)[..., None] - 1 + offset
    patch = dome.first[ring][..., None] + place % each[..., None]

    # Choose the nearest patches; exclude duplicates in rings with few patches
    apart = centres[patch] - directions[:, None, None]
    distance = np.sqrt(np.einsum("drpx,drpx->drp", apart, apart))
    distance[offset >= each[..., None]] = np.inf
    table = len(directions), rings * _MOST
    distance, patch = distance.reshape(table), patch.reshape(table)
    order = np.argsort(distance, axis=1, kind="stable")[:, :count]
    return Nearest(
        np.take_along_axis(distance, order, axis=1),
        np.take_along_axis(patch, order, axis=1),
    )
