"""Light of narrow beams of sunlight on receivers, kept for several products.

The light is proportional to the direct normal irradiance of the sun. For the cells of a
view point, which are few, it is traced once per sun, and multiplied by the irradiance
of all time steps that are asked for.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float, Float32, Int
from scipy.sparse import csc_array, hstack


@dataclass(eq=False)
class KeptBeams:
    """Light by beams, per direct normal irradiance of each sun.

    Attributes
    ----------
    shape : numbers of batches, outputs and receivers
    column : column of each sun in the light, -1 for suns that are not known
    light : light of batches, outputs and receivers by column
    """

    shape: tuple[int, int, int]
    column: Int[np.ndarray, " sun"]
    light: csc_array = field(init=False)

    def __post_init__(self) -> None:
        self.light = csc_array((int(np.prod(self.shape)), 0), dtype=np.float32)

    def missing(self, suns: Int[np.ndarray, " some"]) -> Int[np.ndarray, " few"]:
        """Return the suns whose light is not known, each once."""
        return np.unique(suns[self.column[suns] < 0])

    def keep(self, suns: Int[np.ndarray, " some"], parts: Iterable[Any]) -> None:
        """Keep the light of suns that are not known yet.

        `parts` are of `engine.lambertian_beams.BeamLight`, their steps are indices of
        suns.
        """
        rows, shape = self.shape[2], (self.light.shape[0], len(suns))
        values, places, columns = [np.zeros(0, "f4")], [np.zeros(0, int)], []
        columns.append(places[0])
        for part in parts:
            for output, light in enumerate(part.values):
                used = np.flatnonzero(light)
                number = part.batch[used].astype(np.int64) * self.shape[1] + output
                places.append(number * rows + part.row[used])
                columns.append(part.step[used])
                values.append(light[used])
        where = np.concatenate(places), np.concatenate(columns)
        new = csc_array((np.concatenate(values), where), shape)
        self.column[suns] = self.light.shape[1] + np.arange(len(suns))
        self.light = csc_array(hstack([self.light, new], format="csc"))

    def add(
        self,
        total: Float32[np.ndarray, "batch out row step"],
        suns: Int[np.ndarray, " some"],
        irradiance: Float[np.ndarray, " some"],
    ) -> None:
        """Add the light of suns of given irradiance, one for each of the steps."""
        own = self.light[:, self.column[suns]].tocoo()
        row, step = own.coords
        values = own.data * irradiance.astype(np.float32)[step]
        total.reshape(self.light.shape[0], -1)[row, step] += values
