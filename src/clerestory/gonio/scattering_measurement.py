"""Measurements of one scattering function of a layer.

A scan contains the BSDF values of one incident direction; a measurement contains the
scans of one scattering function of a sample. Directions are unit vectors that point
away from the layer, in window coordinates: x right and y up as seen from the room, and
z ≥ 0 on both sides of the layer.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions
from clerestory.bsdf.scattering_function import Function
from clerestory.errors import InputError
from clerestory.gonio.symmetry import Symmetry, deduce_symmetry

# Largest angle between equal incident directions [rad]: 0.05°.
SAME_DIRECTION = np.radians(0.05)

# Smallest number of points of a scan.
_FEWEST_POINTS = 4


@dataclass(frozen=True, eq=False)
class Scan:
    """BSDF values measured for one incident direction.

    Attributes
    ----------
    incident : unit vector towards the source
    leaving : unit vectors of the scattered directions
    values : BSDF [1/sr]; negative values from noise are allowed
    source : file name, for error messages

    Raises
    ------
    InputError : array lengths differ, a value is not finite, no value is positive, or
        there are fewer than four values

    Examples
    --------
    >>> from clerestory.gonio.angles import from_degrees
    >>> leaving = from_degrees(np.array([0, 20, 20, 20.0]), np.array([0, 0, 90, 180.0]))
    >>> round(Scan(from_degrees(30.0, 0.0), leaving, np.full(4, 0.2)).theta_deg, 6)
    30.0
    """

    incident: Float[np.ndarray, "3"]
    leaving: Float[np.ndarray, "points 3"]
    values: Float[np.ndarray, " points"]
    source: str | None = None

    def __post_init__(self) -> None:
        if len(self.leaving) != len(self.values):
            raise self._error(
                f"{len(self.values)} values at {len(self.leaving)} directions;"
                " one value per direction expected"
            )
        if len(self.values) < _FEWEST_POINTS:
            raise self._error(
                f"{len(self.values)} measured points; {_FEWEST_POINTS} or more expected"
            )
        arrays = (self.incident, self.leaving, self.values)
        if not all(np.all(np.isfinite(array)) for array in arrays):
            raise self._error("a value is not finite; finite BSDF values expected")
        if min(self.incident[2], self.leaving[:, 2].min()) < -1e-9:
            raise self._error("a direction lies below the layer; z ≥ 0 expected")
        if not np.any(self.values > 0):
            raise self._error(
                f"no value is above zero in the scan from {self.words}; scattered light"
                " expected"
            )

    @property
    def theta_deg(self) -> float:
        """Polar angle of the incident direction [°]."""
        return float(
            np.degrees(np.arctan2(np.hypot(*self.incident[:2]), self.incident[2]))
        )

    @property
    def phi_deg(self) -> float:
        """Azimuth of the incident direction from right to up [°], 0 to 360."""
        return float(np.degrees(np.arctan2(self.incident[1], self.incident[0])) % 360)

    @property
    def words(self) -> str:
        """Incident direction as text, for messages."""
        return f"(θ {self.theta_deg:.1f}°, φ {self.phi_deg:.1f}°)"

    def _error(self, message: str) -> InputError:
        return InputError(message, file=self.source)


@dataclass(frozen=True, eq=False)
class Measurement:
    """Scans of one scattering function of a sample, in one channel.

    Attributes
    ----------
    scans : scans with different incident directions
    function : name of the scattering function, such as "transmission_front"
    channel : spectral channel, such as "visible" or "cie-x"
    name : name of the sample
    claimed : symmetry stated in the file; None if not stated
    notes : irregularities of the files and their treatment

    Raises
    ------
    InputError : there is no scan, or two scans have the same incident direction
    """

    scans: tuple[Scan, ...]
    function: Function
    channel: str = "visible"
    name: str = ""
    claimed: Symmetry | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.scans:
            raise InputError("no scan; one per incident direction expected")
        place = self.incidents
        near = place @ place.T > np.cos(SAME_DIRECTION)
        pairs = np.argwhere(np.triu(near, 1))
        if len(pairs):
            first, second = (self.scans[k] for k in pairs[0])
            raise InputError(
                f"incident direction {second.words} is also that of"
                f" {first.source or 'another scan'}; one scan per direction expected;"
                " join the scans (--merge, merge_scans) or omit one",
                file=second.source,
            )

    @property
    def symmetry(self) -> Symmetry:
        """Symmetry stated in the file, otherwise implied by the incident directions."""
        return self.claimed or deduce_symmetry(self.incidents)

    @property
    def incidents(self) -> Directions:
        """Incident directions of the scans."""
        return np.array([scan.incident for scan in self.scans])


def merge_scans(scans: Iterable[Scan]) -> tuple[Scan, ...]:
    """Join scans with the same incident direction.

    Goniophotometers often scan a peak a second time at finer resolution.
    """
    groups: list[list[Scan]] = []
    for scan in scans:
        for group in groups:
            if group[0].incident @ scan.incident > np.cos(SAME_DIRECTION):
                group.append(scan)
                break
        else:
            groups.append([scan])
    return tuple(
        group[0]
        if len(group) == 1
        else Scan(
            group[0].incident,
            np.concatenate([scan.leaving for scan in group]),
            np.concatenate([scan.values for scan in group]),
            group[0].source,
        )
        for group in groups
    )
