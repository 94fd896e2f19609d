"""Partition of a hemisphere into rings of patches.

A ring around the pole is divided into patches of equal azimuth. Patches are the rows
and columns of all matrices: a BSDF is a matrix from patches to patches, a view matrix
one from patches to sensors.

Directions are in the frame of the hemisphere: z along the pole, y up (or north), x
right (or east). In sky partitions the first patch of a ring is centred on +y (north)
and azimuth runs clockwise, towards +x. In Klems bases the first patch is centred on +x
(right) and azimuth runs towards +y (up).
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from clerestory.array_types import Directions, Indices, Points2, Values
from clerestory.brief_repr import brief
from clerestory.checks import require


@dataclass(frozen=True, eq=False)
class RingPartition:
    """A hemisphere divided into rings, each divided into equal patches.

    Partitions are equal if all their patches are; names are ignored.

    Attributes
    ----------
    name : name of the partition in files and messages
    count : number of patches in each ring, in the order of patch numbers
    theta : polar angles of the ring limits [rad], from 0 to π/2 or from π/2 to 0
    azimuth : "compass" from +y towards +x (skies) or "polar" from +x towards +y
        (windows)
    """

    name: str
    count: Int[np.ndarray, " rings"]
    theta: Float[np.ndarray, " limits"]
    azimuth: Literal["compass", "polar"] = "compass"

    __repr__ = brief

    def __post_init__(self) -> None:
        require(
            len(self.theta) == len(self.count) + 1 and np.all(self.count >= 1),
            f"{self.name}: {len(self.count)} rings with {len(self.theta)} limits;"
            " one limit more than rings, and patches in each ring, expected",
        )
        step, ends = np.diff(self.theta), np.sort(self.theta[[0, -1]])
        require(
            (np.all(step > 0) or np.all(step < 0))
            and np.allclose(ends, [0, np.pi / 2], rtol=0, atol=1e-6),
            f"{self.name}: ring limits {np.degrees(self.theta).tolist()}°; monotonic"
            " limits from 0 to 90° expected",
        )

    def __len__(self) -> int:
        return int(self.count.sum())

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, RingPartition):
            return NotImplemented
        return self._patches == other._patches

    def __hash__(self) -> int:
        return hash(self._patches)

    @property
    def _patches(self) -> tuple[str, bytes, bytes]:
        count, theta = self.count.astype(np.int64), self.theta.astype(np.float64)
        return self.azimuth, count.tobytes(), theta.tobytes()

    @property
    def first(self) -> Indices:
        """Index of the first patch of each ring."""
        return np.asarray(np.cumsum(self.count) - self.count)

    def matches(self, other: "RingPartition") -> bool:
        """Whether two partitions have the same patches; names are ignored."""
        return (
            self.azimuth == other.azimuth
            and np.array_equal(self.count, other.count)
            and bool(np.allclose(self.theta, other.theta, atol=2e-3))
        )

    def solid_angles(self) -> Values:
        """Solid angle of each patch [sr]; the values sum to 2π."""
        ring = 2 * np.pi * np.abs(np.diff(np.cos(self.theta)))
        return np.repeat(ring / self.count, self.count)

    def projected_solid_angles(self) -> Values:
        """Solid angle of each patch weighted by the cosine to the pole [sr].

        A patch of uniform radiance L and projected solid angle Λ causes the
        irradiance ΛL on the base plane. The values sum to π.
        """
        ring = np.pi * np.abs(np.diff(np.sin(self.theta) ** 2))
        return np.repeat(ring / self.count, self.count)

    def find(self, direction: Directions) -> Indices:
        """Index of the patch that contains each direction; -1 if z is not positive."""
        x, y, z = np.moveaxis(np.asarray(direction, dtype=float), -1, 0)
        theta = np.arctan2(np.hypot(x, y), z)

        # Find the ring, for increasing or decreasing limits
        inner = self.theta[1:-1]
        if self.theta[0] > self.theta[-1]:
            ring = len(inner) - np.searchsorted(inner[::-1], theta, side="left")
        else:
            ring = np.searchsorted(inner, theta, side="right")

        # Find the patch within the ring; the first patch is centred on azimuth 0
        count = self.count[ring]
        along, across = (y, x) if self.azimuth == "compass" else (x, y)
        turn = np.arctan2(across, along) / (2 * np.pi)
        within = np.floor(turn * count + 0.5).astype(int) % count
        return np.where(z > 0, self.first[ring] + within, -1)

    def centres(self) -> Directions:
        """Unit vectors to the patch centres, midway in polar angle and azimuth."""
        middle = (self.theta[1:] + self.theta[:-1]) / 2
        middle = np.where(
            (self.count == 1) & (self.theta[:-1] * self.theta[1:] == 0), 0, middle
        )
        every = np.arange(len(self))
        return self._directions(np.repeat(middle, self.count), 0.0 * every, every)

    def sample(self, patch: Indices, u: Points2) -> Directions:
        """Cosine-distributed directions within the given patches.

        Parameters
        ----------
        patch : index of the patch of each direction
        u : random points in the unit square, one per direction
        """
        ring = np.repeat(np.arange(len(self.count)), self.count)[patch]
        low, high = np.sin(self.theta[ring]) ** 2, np.sin(self.theta[ring + 1]) ** 2
        theta = np.arcsin(np.sqrt(low + (high - low) * u[..., 0]))
        return self._directions(theta, u[..., 1] - 0.5, patch)

    def _directions(self, theta: Values, offset: Values, patch: Indices) -> Directions:
        # `offset`: azimuth from the patch centre, in patch widths
        ring = np.repeat(np.arange(len(self.count)), self.count)[patch]
        phi = 2 * np.pi * (patch - self.first[ring] + offset) / self.count[ring]
        along, across = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)
        x, y = (across, along) if self.azimuth == "compass" else (along, across)
        return np.stack([x, y, np.cos(theta)], axis=-1)
