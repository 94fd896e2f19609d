"""Beams of sunlight behind a window: unscattered, and scattered into narrow lobes.

Each sun has the same number of beams of equal probability. The estimate of what a beam
contributes to a point is its value times the transmittance along its direction.
"""

from dataclasses import dataclass, replace

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.bsdf.bsdf import Bsdf
from clerestory.directions import Frame
from clerestory.engine.peak_extraction import PeakTable
from clerestory.engine.sun_tables import solar_disc
from clerestory.engine.upload import launching, vectors
from clerestory.hemisphere.shirley_chiu import directions_from_square

# Number of beams of a sun, a power of two
BEAMS = 256

# Cells with a larger share of the transmitted flux of a sun form narrow beams
_NARROW = 0.005


@dataclass(frozen=True, eq=False)
class Beams:
    """Beams of several suns.

    Attributes
    ----------
    steps : time step of each sun
    direction, sun : unit vectors against the beam in the room, and to the sun
    value : irradiance perpendicular to the beam, by channel
    disc : whether the sun is seen against the beams, which are not scattered
    """

    steps: Int[np.ndarray, " step"]
    direction: Float[np.ndarray, "step beam 3"]
    sun: Float[np.ndarray, "step beam 3"]
    value: Float[np.ndarray, "step beam 3"]
    disc: bool

    def select(self, some: slice | Bool[np.ndarray, " step"]) -> "Beams":
        """Return the beams of some of the suns."""
        return replace(
            self,
            steps=self.steps[some],
            direction=self.direction[some],
            sun=self.sun[some],
            value=self.value[some],
        )


class UnscatteredBeams:
    """Unscattered transmission of a BSDF in the frame of a window."""

    def __init__(self, bsdf: Bsdf, frame: Frame):
        self.peak = PeakTable(bsdf)
        self.axes = np.array([frame.right, frame.up, frame.normal])

    def of(
        self, suns: Float[np.ndarray, "step 3"], irradiance: Float[np.ndarray, " step"]
    ) -> Beams:
        """Return the beams of suns of given direct normal irradiance."""
        with launching():
            leaving = vectors(mi.Vector3f, -suns @ self.axes.T)
            passed = dr.select(leaving.z > 0, self.peak.transmittance(leaving), 0)
            value = (
                np.broadcast_to(passed.numpy(), (3, len(suns))).T * irradiance[:, None]
            )
        disc = solar_disc(suns, BEAMS).transpose(1, 0, 2)
        value = np.repeat(value[:, None], BEAMS, axis=1)
        beams = Beams(np.arange(len(suns)), disc, disc, value, disc=True)
        return beams.select(value.max(axis=(1, 2)) > 0)


def narrow_cells(
    radiance: Float[np.ndarray, "channel cell step"],
) -> Bool[np.ndarray, "cell step"]:
    """Return which cells of equal projected solid angle form narrow beams."""
    mean = radiance.mean(axis=0)
    return np.asarray(mean > _NARROW * mean.sum(axis=0))


def narrow_beams(
    radiance: Float[np.ndarray, "channel cell step"],
    corners: Float[np.ndarray, "cell 2"],
    suns: Float[np.ndarray, "step 3"],
    frame: Frame,
    *,
    seed: int,
) -> Beams:
    """Return beams that represent the radiance of cells of a window.

    `radiance` is zero but for the cells of narrow beams; `corners` are the low corners
    of the cells in the unit square of the Shirley–Chiu map.
    """
    channels, cells, _ = radiance.shape
    mean = radiance.mean(axis=0).T.astype(float)
    lit = np.flatnonzero(mean.sum(axis=1) > 0)
    random = np.random.default_rng(seed)
    share = np.cumsum(mean[lit], axis=1)
    total = share[:, -1:]
    # Stratified points of the distribution, in random order
    pick = (np.arange(BEAMS) + random.random((len(lit), BEAMS))) / BEAMS * total
    cell = np.array(
        [np.searchsorted(s, p, side="right") for s, p in zip(share, pick, strict=True)]
    ).reshape(len(lit), BEAMS)
    cell = np.minimum(cell, cells - 1)
    edge = 1 / np.sqrt(cells)
    place = corners[cell] + edge * random.random((len(lit), BEAMS, 2))
    leaving = directions_from_square(place[..., 0], place[..., 1])
    colour = radiance[:, cell, lit[:, None]] / mean[lit[:, None], cell]
    flux = np.pi / cells * total / np.maximum(leaving[..., 2], 1e-3)
    value = np.broadcast_to(colour, (channels, *cell.shape)) * flux
    value = np.broadcast_to(np.moveaxis(value, 0, -1), (*cell.shape, 3))
    axes = np.array([frame.right, frame.up, frame.normal])
    disc = solar_disc(suns[lit], BEAMS).transpose(1, 0, 2)
    disc = disc[:, random.permutation(BEAMS)]
    return Beams(lit, -leaving @ axes, disc, value, disc=False)
