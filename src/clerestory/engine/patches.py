"""Hemisphere partitions in kernels: patch of a direction, and sampling of patches.

The tables are built from the rings of `hemisphere.partition`; a test compares the patch
look-up with that of `hemisphere` for random directions.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.upload import on_device
from clerestory.hemisphere.partition import RingPartition


@dataclass
class PatchTable:
    """Dr.Jit arrays of a ring partition.

    Attributes
    ----------
    inner : sin² of the polar angle at the limits between rings, increasing
    count, first : number of patches in each ring and index of its first patch, from the
        pole
    low, high : sin² of the polar angle at the limits of each patch
    phi, width : azimuth of each patch's centre, and its width in azimuth [rad]
    compass : whether azimuth is measured from +y to +x, and not from +x to +y
    """

    inner: list[float]
    count: "mi.UInt32"
    first: "mi.UInt32"
    low: "mi.Float"
    high: "mi.Float"
    phi: "mi.Float"
    width: "mi.Float"
    compass: bool

    @classmethod
    def of(cls, partition: RingPartition) -> "PatchTable":
        """Return the Dr.Jit arrays of a partition."""
        outwards = partition.theta[0] < partition.theta[-1]
        order = slice(None) if outwards else slice(None, None, -1)
        count, first = partition.count[order], partition.first[order]
        limits = np.sin(np.sort(partition.theta)) ** 2
        ring = np.repeat(np.arange(len(partition.count)), partition.count)
        edges = np.sin(partition.theta) ** 2
        near = np.minimum(edges[ring], edges[ring + 1])
        far = np.maximum(edges[ring], edges[ring + 1])
        width = 2 * np.pi / partition.count[ring]
        return cls(
            inner=[float(limit) for limit in limits[1:-1]],
            count=on_device(mi.UInt32, count),
            first=on_device(mi.UInt32, first),
            low=on_device(mi.Float, near),
            high=on_device(mi.Float, far),
            phi=on_device(
                mi.Float, (np.arange(len(ring)) - partition.first[ring]) * width
            ),
            width=on_device(mi.Float, width),
            compass=partition.azimuth == "compass",
        )

    def find(self, direction):
        """Return the patch of a direction in local coordinates, z > 0."""
        # Index of the ring: number of ring limits below sin² of the polar angle
        sin2 = dr.square(direction.x) + dr.square(direction.y)
        ring = mi.UInt32(0)
        for limit in self.inner:
            ring += dr.select(sin2 > limit, mi.UInt32(1), mi.UInt32(0))
        count = dr.gather(mi.UInt32, self.count, ring)
        first = dr.gather(mi.UInt32, self.first, ring)
        along, across = direction.x, direction.y
        if self.compass:
            along, across = across, along
        return first + _sector(across, along, count)

    def sample(self, patch, u, v):
        """Return a cosine-distributed direction within a patch."""
        low = dr.gather(mi.Float, self.low, patch)
        high = dr.gather(mi.Float, self.high, patch)
        sin2 = low + (high - low) * u
        phi = dr.gather(mi.Float, self.phi, patch)
        phi += (v - 0.5) * dr.gather(mi.Float, self.width, patch)
        sine, cosine = dr.sincos(phi)
        flat = dr.sqrt(sin2)
        x, y = flat * cosine, flat * sine
        if self.compass:
            x, y = y, x
        return mi.Vector3f(x, y, dr.safe_sqrt(1 - sin2))


@dataclass
class SkyTable:
    """Dr.Jit arrays of sky patches, with the ground as patch 0.

    Rows of patches are ordered from the horizon to the zenith, which is the last row.
    Each row has a number of patches, and the index of its first patch.
    """

    rows: int
    count: "mi.UInt32"
    first: "mi.UInt32"

    @classmethod
    def of(cls, partition) -> "SkyTable":
        """Return the Dr.Jit arrays of a `SkyPartition`."""
        dome = partition.dome
        count = on_device(mi.UInt32, dome.count)
        return cls(len(dome.count), count, on_device(mi.UInt32, dome.first + 1))

    def find(self, direction):
        """Return the patch in a direction; 0 at and below the horizon."""
        # All rows have equal height, except the zenith with half that height
        altitude = dr.asin(dr.clip(direction.z, -1, 1))
        row = mi.Int32(dr.floor(altitude * ((2 * self.rows - 1) / dr.pi)))
        row = mi.UInt32(dr.clip(row, 0, self.rows - 1))
        count = dr.gather(mi.UInt32, self.count, row)
        patch = dr.gather(mi.UInt32, self.first, row)
        patch += _sector(direction.x, direction.y, count)
        return dr.select(direction.z > 0, patch, 0)


def _sector(across, along, count):
    # Number of the azimuth sector; sector 0 is centred on `along`
    turn = dr.atan2(across, along) * (0.5 * dr.inv_pi)
    within = mi.Int32(dr.floor(turn * mi.Float(count) + 0.5))
    within = dr.select(within < 0, within + mi.Int32(count), within)
    return mi.UInt32(dr.select(within >= mi.Int32(count), 0, within))
