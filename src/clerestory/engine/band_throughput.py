"""Throughput of paths in more than three bands.

A BSDF value has the channels black, brightest, brightest (`at_two_reflectances`). Its
value in band b is f_0 + c_b (f_1 − f_0), where c_b is the reflectance of the surface in
the band, relative to its brightest band.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Shaped

from clerestory.engine.channels import channels_of, shares_of_brightest
from clerestory.engine.upload import on_device
from clerestory.scene.model import Scene


@dataclass
class BandThroughput:
    """Reflectance of each shape in each band, relative to the brightest band.

    `shares` is a table of materials × bands.
    """

    shares: mi.Float
    row_of_shape: mi.UInt32
    count: int

    @classmethod
    def of(
        cls, scene: Scene | None, materials: Shaped[np.ndarray, " shape"]
    ) -> "BandThroughput | None":
        """Return the table of a scene with coloured materials; None for three channels.

        `materials` are the names of the materials of the shapes, "" for black ones.
        """
        if scene is None or channels_of(scene) == 1:
            return None
        count = len(scene.bands)
        names, row = np.unique(materials, return_inverse=True)
        table = [
            shares_of_brightest(scene.materials[name], count)
            if name
            else np.ones(count)
            for name in names
        ]
        return cls(
            on_device(mi.Float, np.concatenate(table)), on_device(mi.UInt32, row), count
        )

    def uniform(self, value):
        """Return the same throughput in all bands: a number, or the first channel."""
        first = mi.Float(value[0] if isinstance(value, mi.Color3f) else value)
        return mi.ArrayXf([first] * self.count)

    def at(self, shape: mi.UInt32, active: mi.Bool):
        """Return the function from channels to bands at points of shapes."""
        row = dr.gather(mi.UInt32, self.row_of_shape, shape, active) * self.count
        shares = [
            dr.gather(mi.Float, self.shares, row + band, active)
            for band in range(self.count)
        ]

        def in_bands(value: mi.Color3f):
            added = value[1] - value[0]
            return mi.ArrayXf([dr.fma(share, added, value[0]) for share in shares])

        return in_bands
