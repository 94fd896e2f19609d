"""Beams of sunlight behind a window: unscattered, and scattered into narrow lobes.

Each sun has the same number of beams of equal probability. The estimate of what a beam
contributes to a point is its value times the transmittance along its direction.
"""

import zlib
from collections.abc import Callable
from dataclasses import dataclass, replace

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Bool, Float, Int, UInt32

from clerestory.bands import RGB, Bands
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.spectral_channels import band_groups_of
from clerestory.constants import R2
from clerestory.directions import Frame
from clerestory.engine.channels import GROUP
from clerestory.engine.peak_extraction import INWARDS, PeakTable
from clerestory.engine.upload import launching, vectors
from clerestory.sky.solar_disc import GOLDEN_TURN, disc_points

# Cells whose radiance exceeds the mean radiance by this factor form narrow beams. Paths
# to random points of the window resolve all other cells well enough.
_NARROW = 32

# Function from cells and points of the unit square to directions in the cells
Sampler = Callable[
    [Int[np.ndarray, "step beam"], Float[np.ndarray, "step beam 2"]],
    Float[np.ndarray, "step beam 3"],
]


@dataclass(frozen=True, eq=False)
class Beams:
    """Beams of several suns.

    Attributes
    ----------
    steps : time step of each sun
    key : key of the random numbers of each sun
    direction, sun : unit vectors against the beam in the room, and to the sun
    value : irradiance perpendicular to the beam, by channel: three, or one per band
    disc : whether the sun is seen against the beams, which are not scattered
    """

    steps: Int[np.ndarray, " step"]
    key: UInt32[np.ndarray, " step"]
    direction: Float[np.ndarray, "step beam 3"]
    sun: Float[np.ndarray, "step beam 3"]
    value: Float[np.ndarray, "step beam channel"]
    disc: bool

    def group(self, number: int) -> "Beams":
        """Return the beams in three bands, those of a group of bands of a scene."""
        channels = self.value.shape[-1]
        if channels == GROUP:
            return self
        chosen = np.minimum(np.arange(GROUP) + GROUP * number, channels - 1)
        return replace(self, value=self.value[..., chosen])

    def select(self, some: slice | Bool[np.ndarray, " step"]) -> "Beams":
        """Return the beams of some of the suns."""
        return replace(
            self,
            steps=self.steps[some],
            key=self.key[some],
            direction=self.direction[some],
            sun=self.sun[some],
            value=self.value[some],
        )


class UnscatteredBeams:
    """Unscattered transmission of a BSDF in the frame of a window, in some bands."""

    def __init__(self, bsdf: Bsdf, frame: Frame, bands: Bands = RGB):
        self.peaks = [PeakTable(part, INWARDS) for part in band_groups_of(bsdf, bands)]
        self.channels = len(bands) if len(self.peaks) > 1 else GROUP
        self.axes = np.array([frame.right, frame.up, frame.normal])

    def of(
        self,
        suns: Float[np.ndarray, "step 3"],
        irradiance: Float[np.ndarray, " step"],
        count: int,
        *,
        batches: int = 1,
        seed: int = 0,
    ) -> Beams:
        """Return `count` beams of each sun of given direct normal irradiance.

        The beams of the batches of paths alternate.
        """
        disc = random_disc(suns, count, batches=batches, seed=seed)
        with launching():
            leaving = vectors(mi.Vector3f, -disc.reshape(-1, 3) @ self.axes.T)
            parts = [
                dr.select(leaving.z > 0, peak.transmittance(leaving), 0).numpy()
                for peak in self.peaks
            ]
        shape = GROUP, len(suns) * count
        passed = np.concatenate([np.broadcast_to(part, shape) for part in parts])
        value = passed[: self.channels].T.reshape(*disc.shape[:2], self.channels)
        value = value * irradiance[:, None, None]
        beams = Beams(np.arange(len(suns)), _keys(suns), disc, disc, value, disc=True)
        return beams.select(value.max(axis=(1, 2)) > 0)


def random_disc(
    suns: Float[np.ndarray, "step 3"],
    count: int,
    *,
    batches: int,
    seed: int,
    mixed: bool = False,
) -> Float[np.ndarray, "step point 3"]:
    """Return unit vectors to random points of the solar disc around centres of suns.

    The points of the batches alternate. Those of a batch are evenly distributed over
    the disc, turned and shifted at random and independently of the other batches, so
    that the batches scatter as their mean does. The points of a sun do not depend on
    the other suns. `mixed` points are in random order.
    """
    own = count // batches
    place = np.empty((len(suns), own, batches, 2))
    for sun, key in enumerate(_keys(suns)):
        random = np.random.default_rng([seed, int(key), 1])
        shift = random.random((batches, 2))
        number = np.tile(np.arange(own)[:, None], batches)
        if mixed:
            number = random.permuted(number, axis=0)
        place[sun, ..., 0] = (number + shift[:, 0]) / own
        place[sun, ..., 1] = number * GOLDEN_TURN + shift[:, 1]
    return disc_points(suns, place.reshape(len(suns), -1, 2))


def narrow_cells(
    radiance: Float[np.ndarray, "channel cell step"],
    sizes: Float[np.ndarray, " cell"],
) -> Bool[np.ndarray, "cell step"]:
    """Return which cells form narrow beams; `sizes` are projected solid angles [sr]."""
    mean = radiance.mean(axis=0)
    return np.asarray(mean > _NARROW * (sizes @ mean) / sizes.sum())


def narrow_beams(
    radiance: Float[np.ndarray, "channel cell step"],
    sizes: Float[np.ndarray, " cell"],
    sample: Sampler,
    suns: Float[np.ndarray, "step 3"],
    frame: Frame,
    *,
    count: int,
    batches: int,
    seed: int,
) -> Beams:
    """Return beams that represent the radiance of cells of a window, `count` per sun.

    `radiance` is zero but for the cells of narrow beams. The beams of the batches of
    paths alternate. `sample` returns directions in cells, uniform in projected solid
    angle, for points of the unit square.
    """
    mean = radiance.mean(axis=0).T.astype(float)
    lit = np.flatnonzero(mean.sum(axis=1) > 0)
    keys = _keys(suns[lit])
    # Random numbers of a sun do not depend on the other suns
    own = count // batches
    random = np.array(
        [np.random.default_rng([seed, key]).random((batches, own + 2)) for key in keys]
    ).reshape(len(lit), batches, own + 2)
    jitter = random[:, :, :own].transpose(0, 2, 1)
    shift = random[:, None, :, own : own + 2]
    # Stratified samples of the distribution of flux, one for each batch
    share = np.cumsum(mean[lit] * sizes, axis=1)
    total, number = share[:, -1:], np.arange(own)[:, None]
    pick = ((number + jitter) / own).reshape(len(lit), -1) * total
    u = number[..., None] * R2 + shift
    cell = np.array(
        [np.searchsorted(s, p, side="right") for s, p in zip(share, pick, strict=True)]
    ).reshape(len(lit), count)
    cell = np.minimum(cell, len(sizes) - 1)
    leaving = sample(cell, u.reshape(len(lit), count, 2) % 1)
    colour = radiance[:, cell, lit[:, None]] / mean[lit[:, None], cell]
    flux = total / np.maximum(leaving[..., 2], 1e-3)
    channels = len(radiance) if len(radiance) > 1 else GROUP
    value = np.broadcast_to(np.moveaxis(colour * flux, 0, -1), (*cell.shape, channels))
    axes = np.array([frame.right, frame.up, frame.normal])
    # The points of the disc are in an order of their own, unlike the cells
    disc = random_disc(suns[lit], count, batches=batches, seed=seed, mixed=True)
    return Beams(lit, keys, -leaving @ axes, disc, value, disc=False)


def _keys(suns: Float[np.ndarray, "sun 3"]) -> UInt32[np.ndarray, " sun"]:
    return np.array([zlib.crc32(sun.tobytes()) for sun in suns], np.uint32)
