"""What every scattering function can be asked, however its values are kept.

Directions are unit vectors in the frame of the window: x right, y up. Only x and y
are looked at, for the function says which side light meets and leaves. Incident
directions point to where light comes from, as all directions point away from the
layer.
"""

from abc import ABC, abstractmethod
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float, Int

from clerestory.array_types import Directions, ExitIncident, Points2, Values
from clerestory.hemisphere.partition import RingPartition

Function = Literal[
    "transmission_front", "transmission_back", "reflection_front", "reflection_back"
]
FUNCTIONS: tuple[Function, ...] = get_args(Function)

# Pairs that are evaluated together: their arrays stay in the processor's cache.
TOGETHER = 1 << 15

OTHER_SIDE: dict[Function, Function] = {
    "transmission_front": "transmission_back",
    "transmission_back": "transmission_front",
}


def by_function(
    incident: Float[np.ndarray, "pair 3"], leaving: Float[np.ndarray, "pair 3"]
) -> dict[Function, Int[np.ndarray, " some"]]:
    """Numbers of the pairs that each of the four functions is for.

    Parameters
    ----------
    incident, leaving : away from the layer; z points into the room

    Examples
    --------
    >>> up, down = np.array([[0.0, 0.0, 1.0]]), np.array([[0.0, 0.0, -1.0]])
    >>> by_function(down, up)["transmission_front"].tolist()
    [0]
    """
    from_sky, to_room = incident[:, 2] < 0, leaving[:, 2] > 0
    return {
        "transmission_front": np.flatnonzero(from_sky & to_room),
        "transmission_back": np.flatnonzero(~from_sky & ~to_room),
        "reflection_front": np.flatnonzero(from_sky & ~to_room),
        "reflection_back": np.flatnonzero(~from_sky & to_room),
    }


class ScatteringFunction(ABC):
    """One scattering function of a layer, in one channel."""

    @abstractmethod
    def evaluate(self, incident: Directions, leaving: Directions) -> Values:
        """BSDF [1/sr] for pairs of directions."""

    @abstractmethod
    def hemispherical(self, incident: Directions) -> Values:
        """Share of the light from each direction that is scattered in all."""

    @abstractmethod
    def sample(self, incident: Directions, u: Points2) -> tuple[Directions, Values]:
        """Directions into which light leaves, and their probability density [1/sr].

        The density is the BSDF times the cosine of the leaving direction over the
        share scattered in all. Directions have z ≥ 0, whichever side they leave.
        Where nothing is scattered the density is 0 and the direction the normal.

        Parameters
        ----------
        u : points of the unit square [0, 1)², one per direction
        """

    @abstractmethod
    def resolution(self, incident: Directions, leaving: Directions) -> Values:
        """Projected solid angle of the leaving cell that holds each pair [sr]."""

    @abstractmethod
    def average(self, exits: RingPartition, incidents: RingPartition) -> ExitIncident:
        """BSDF averaged over pairs of patches [1/sr]; flux is conserved.

        Averages are weighted by projected solid angle. Incident patches are
        numbered by where light goes straight on.
        """

    @abstractmethod
    def extrema(self) -> tuple[float, float]:
        """Smallest and largest value [1/sr]."""

    @abstractmethod
    def reciprocal(self) -> "ScatteringFunction":
        """Return the function with incident and leaving directions exchanged.

        By Helmholtz reciprocity it is the transmission of the other side.
        """

    @abstractmethod
    def tabulated(self) -> "ScatteringFunction":
        """Return the function as a matrix or tree, which kernels can look up."""

    @abstractmethod
    def own_partitions(self) -> tuple[RingPartition, RingPartition] | None:
        """Exit and incident patches of its own; None if it is not made of patches."""
