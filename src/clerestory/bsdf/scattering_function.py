"""Interface of scattering functions.

Directions are unit vectors that point away from the layer, in window coordinates, x
right and y up; incident directions point towards the source. Only x and y are used: the
name of the function determines the sides of incidence and exit.
"""

from abc import ABC, abstractmethod
from typing import Literal, NamedTuple, get_args

import numpy as np
from jaxtyping import Float, Int

from clerestory.array_types import Directions, ExitIncident, Indices, Points2, Values
from clerestory.hemisphere.partition import RingPartition

Function = Literal[
    "transmission_front", "transmission_back", "reflection_front", "reflection_back"
]
FUNCTIONS: tuple[Function, ...] = get_args(Function)

# Number of direction pairs evaluated together, so that arrays fit into the CPU cache.
CHUNK = 1 << 15

Side = Literal["front", "back"]
SIDES: tuple[Side, ...] = get_args(Side)

# Transmission and reflection of light incident on each side
OF_SIDE: dict[Side, tuple[Function, Function]] = {
    "front": ("transmission_front", "reflection_front"),
    "back": ("transmission_back", "reflection_back"),
}

# Reciprocal of each transmission; a reflection is its own reciprocal
OTHER_SIDE: dict[Function, Function] = {
    "transmission_front": "transmission_back",
    "transmission_back": "transmission_front",
}


def pairs_by_function(
    incident: Float[np.ndarray, "pair 3"], leaving: Float[np.ndarray, "pair 3"]
) -> dict[Function, Int[np.ndarray, " some"]]:
    """Indices of the direction pairs to which each of the four functions applies.

    `incident`, `leaving`: directions that point away from the layer; z points into the
    room.

    >>> up, down = np.array([[0.0, 0.0, 1.0]]), np.array([[0.0, 0.0, -1.0]])
    >>> pairs_by_function(down, up)["transmission_front"].tolist()
    [0]
    """
    from_sky, to_room = incident[:, 2] < 0, leaving[:, 2] > 0
    return {
        "transmission_front": np.flatnonzero(from_sky & to_room),
        "transmission_back": np.flatnonzero(~from_sky & ~to_room),
        "reflection_front": np.flatnonzero(from_sky & ~to_room),
        "reflection_back": np.flatnonzero(~from_sky & to_room),
    }


class CellValues(NamedTuple):
    """Cells, or pairs of patches, to which direction pairs belong.

    Attributes
    ----------
    value : BSDF [1/sr]
    size : projected solid angle of the exit cell [sr]
    number : number of the cell
    """

    value: Values
    size: Values
    number: Indices


class ScatteringFunction(ABC):
    """One scattering function of a layer, in one channel."""

    @abstractmethod
    def evaluate(self, incident: Directions, leaving: Directions) -> Values:
        """BSDF [1/sr] for pairs of directions."""

    @abstractmethod
    def hemispherical(self, incident: Directions) -> Values:
        """Directional-hemispherical transmittance or reflectance."""

    @abstractmethod
    def sample(self, incident: Directions, u: Points2) -> tuple[Directions, Values]:
        """Sample exit directions; return them and their probability density [1/sr].

        The density is BSDF × exit cosine / directional-hemispherical transmittance or
        reflectance. Directions have z ≥ 0 for exit on either side. If no light is
        scattered, the density is 0 and the direction is the normal.

        `u`: random points in the unit square [0, 1)², one per direction.
        """

    @abstractmethod
    def resolution(self, incident: Directions, leaving: Directions) -> Values:
        """Projected solid angle of the exit cell of each direction pair [sr]."""

    @abstractmethod
    def cell_values(self, incident: Directions, leaving: Directions) -> CellValues:
        """Value, size and number of the cell of each direction pair."""

    @abstractmethod
    def average(self, exits: RingPartition, incidents: RingPartition) -> ExitIncident:
        """BSDF averaged over pairs of patches by projected solid angle [1/sr].

        Incident patches are indexed by the direction of propagation.
        """

    @abstractmethod
    def extrema(self) -> tuple[float, float]:
        """Smallest and largest BSDF [1/sr]."""

    @abstractmethod
    def reciprocal(self) -> "ScatteringFunction":
        """Return the function with incident and exit directions exchanged.

        By Helmholtz reciprocity the result is the transmission of the other side, or
        the same reflection.
        """

    @abstractmethod
    def tabulated(self) -> "ScatteringFunction":
        """Return the function as a matrix or tree, for ray tracing."""

    @abstractmethod
    def own_partitions(self) -> tuple[RingPartition, RingPartition] | None:
        """Exit and incident patches; None if the function has no patches."""
