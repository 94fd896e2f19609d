"""Tregenza and Reinhart sky partitions, with the ground as patch 0.

Patches are numbered in rows from the horizon to the zenith, in each row clockwise from
north. Directions are in scene coordinates: x east, y north, z up.

References: P. R. Tregenza, Lighting Research and Technology 19 (1), 1987; C. F.
Reinhart, O. Walkenhorst, Energy and Buildings 33 (7), 2001.
"""

from dataclasses import dataclass

import numpy as np

from clerestory.array_types import Directions, Indices, Values
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.hemisphere.partition import RingPartition

_TREGENZA_COUNT = (30, 30, 24, 24, 18, 12, 6)


@dataclass(frozen=True, eq=False)
class SkyPartition:
    """A sky divided into patches 1…n, with the ground as patch 0.

    Attributes
    ----------
    subdivision : Reinhart's MF, 1 for Tregenza's sky
    dome : partition of the sky without the ground

    Examples
    --------
    >>> [len(reinhart(mf)) for mf in (1, 2, 4)]
    [146, 578, 2306]
    """

    subdivision: int
    dome: RingPartition

    __repr__ = brief

    def __len__(self) -> int:
        return 1 + len(self.dome)

    @property
    def name(self) -> str:
        """Name of the partition in files and messages."""
        return f"Reinhart MF:{self.subdivision} with ground"

    def find(self, direction: Directions) -> Indices:
        """Patch index of each direction; 0 at and below the horizon."""
        return self.dome.find(direction) + 1

    def solid_angles(self) -> Values:
        """Solid angle of each patch [sr]; 2π for the ground."""
        return np.concatenate([[2 * np.pi], self.dome.solid_angles()])

    def centres(self) -> Directions:
        """Unit vectors to the patch centres; straight down for the ground."""
        return np.concatenate([[[0.0, 0.0, -1.0]], self.dome.centres()])


def reinhart(subdivision: int) -> SkyPartition:
    """Return the sky with each Tregenza patch divided along both of its sides.

    Each side has `subdivision` parts; the zenith patch is not divided.

    Raises
    ------
    InputError : the subdivision is not 1…6
    """
    message = f"sky subdivision is {subdivision!r}; a whole number from 1 to 6 expected"
    require(subdivision in range(1, 7), message)
    rows = 7 * subdivision
    altitude = np.append(np.arange(rows + 1) * np.pi / (2 * rows + 1), np.pi / 2)
    count = subdivision * np.repeat(np.array(_TREGENZA_COUNT), subdivision)
    dome = RingPartition(
        f"Reinhart MF:{subdivision}", np.append(count, 1), np.pi / 2 - altitude
    )
    return SkyPartition(subdivision, dome)
