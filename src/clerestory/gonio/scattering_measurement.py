"""Measured scattering of one function of a layer.

A scan is the light scattered from one incident direction, a measurement the scans of
one function of a sample. Directions are unit vectors away from the layer in the frame
of the window, x right and y up seen from the room, with z ≥ 0 on both sides.
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

# Fewest points of a scan.
_FEWEST_POINTS = 4


@dataclass(frozen=True, eq=False)
class Scan:
    """Light scattered from one incident direction.

    Attributes
    ----------
    incident : unit vector towards the source
    leaving : unit vectors of the measured directions
    values : BSDF at them [1/sr]; noise may make it negative
    source : file, for messages

    Raises
    ------
    InputError : different lengths, values that are not finite or all zero, or too few

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
                " as many expected"
            )
        if len(self.values) < _FEWEST_POINTS:
            raise self._error(
                f"{len(self.values)} measured points; {_FEWEST_POINTS} or more expected"
            )
        arrays = (self.incident, self.leaving, self.values)
        if not all(np.all(np.isfinite(array)) for array in arrays):
            raise self._error("a value is not finite; BSDF values [1/sr] expected")
        if min(self.incident[2], self.leaving[:, 2].min()) < -1e-9:
            raise self._error("a direction lies below the layer; z ≥ 0 expected")
        if not np.any(self.values > 0):
            raise self._error(
                "no value is above zero; the light scattered from"
                f" {self.words} expected"
            )

    @property
    def theta_deg(self) -> float:
        """Polar angle of the incident direction [°]."""
        return float(
            np.degrees(np.arctan2(np.hypot(*self.incident[:2]), self.incident[2]))
        )

    @property
    def phi_deg(self) -> float:
        """Azimuth of the incident direction from right upwards [°], 0 to 360."""
        return float(np.degrees(np.arctan2(self.incident[1], self.incident[0])) % 360)

    @property
    def words(self) -> str:
        """Incident direction for messages."""
        return f"(θ {self.theta_deg:.1f}°, φ {self.phi_deg:.1f}°)"

    def _error(self, message: str) -> InputError:
        return InputError(message, file=self.source)


@dataclass(frozen=True, eq=False)
class Measurement:
    """Scans of one function of a sample, in one channel.

    Attributes
    ----------
    scans : one per incident direction
    function : such as "transmission_front"
    channel : "visible", "cie-x", …
    name : of the sample
    claimed : symmetry in the file; None if it has none
    notes : irregularities of the files and how they were resolved

    Raises
    ------
    InputError : no scan, or two of the same incident direction
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
                f" {first.source or 'another scan'}; one scan per direction expected:"
                " join them (--merge, merge_scans) or leave one out",
                file=second.source,
            )

    @property
    def symmetry(self) -> Symmetry:
        """Symmetry in the file, or else that of the incident directions."""
        return self.claimed or deduce_symmetry(self.incidents)

    @property
    def incidents(self) -> Directions:
        """Incident directions of the scans."""
        return np.array([scan.incident for scan in self.scans])


def merge_scans(scans: Iterable[Scan]) -> tuple[Scan, ...]:
    """Return the scans with those of the same incident direction joined.

    Goniophotometers often scan a peak again at a finer resolution.
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
