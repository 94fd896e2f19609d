"""Measurements of one scattering function of a layer.

A scan contains the BSDF values of one incident direction; a measurement contains the
scans of one scattering function of a sample. Directions are unit vectors that point
away from the layer, in window coordinates: x right and y up as seen from the room, and
z ≥ 0 on both sides of the layer.

For integration, directions are projected onto the unit disc, where areas are projected
solid angles, and triangulated. The weight of a point is a third of the area of the
triangles around it; these weights integrate the piecewise linear interpolation exactly.
Between the outermost points and the horizon, the value of the nearest point is used.
"""

import functools
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import Delaunay, QhullError, cKDTree

from clerestory.array_types import Directions, Values
from clerestory.brief_repr import brief
from clerestory.bsdf.scattering_function import Function
from clerestory.checks import finite, require, same_length
from clerestory.errors import InputError, located
from clerestory.gonio.symmetry import Symmetry, deduce_symmetry

# Number of points added on the horizon, each with the value of the nearest point.
_RIM = 240

# Number of decimal places to which equal points agree (at the normal, all azimuths are
# one point).
_DIGITS = 9

_AT_RIM = 0.9995  # points at larger radii on the unit disc count as on the horizon


def integration_weights(direction: Directions) -> Values:
    """Projected solid angle of each point [sr]; the sum is π."""
    # Cached: many instruments measure the same directions in every scan
    return _weights_of(np.ascontiguousarray(direction[:, :2]).tobytes())


@functools.lru_cache(maxsize=4)
def _weights_of(pattern: bytes) -> Values:
    every = np.round(np.frombuffer(pattern).reshape(-1, 2), _DIGITS)
    disc, place, count = np.unique(
        every, axis=0, return_inverse=True, return_counts=True
    )
    angle = 2 * np.pi * (np.arange(_RIM) + 0.5) / _RIM
    rim = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    _, nearest = cKDTree(disc).query(rim)
    inside = np.hypot(*disc.T) < _AT_RIM
    joined = np.concatenate([disc, rim])
    owner = np.concatenate([np.arange(len(disc)), nearest])
    weight = _thirds(joined, owner, len(disc))
    if not np.any(inside):
        weight = count.astype(float)
    weight = (weight / count)[place.ravel()] * (np.pi / weight.sum())
    weight.setflags(write=False)
    return np.asarray(weight)


def _thirds(
    point: Float[np.ndarray, "points 2"], owner: Int[np.ndarray, " points"], count: int
) -> Float[np.ndarray, " owners"]:
    try:
        mesh = Delaunay(point)
    except QhullError:  # all points are on one line
        return np.ones(count)
    corner = point[mesh.simplices]
    (ax, ay), (bx, by) = (
        (corner[:, 1] - corner[:, 0]).T,
        (corner[:, 2] - corner[:, 0]).T,
    )
    area = np.abs(ax * by - ay * bx) / 2
    share = np.bincount(mesh.simplices.ravel(), np.repeat(area / 3, 3), len(point))

    # Distribute the weight of a corner equally among coinciding points
    mates = np.ones(len(point))
    if len(mesh.coplanar):
        left, kept = mesh.coplanar[:, 0], mesh.coplanar[:, 2]
        np.add.at(mates, kept, 1)
        share[left] = share[kept] / mates[kept]
        share[kept] /= np.where(np.isin(np.arange(len(point)), kept), mates, 1)[kept]
    return np.bincount(owner, share, count)


# Largest angle between equal incident directions [rad]: 0.05°.
SAME_DIRECTION = np.radians(0.05)
_COS_SAME = np.cos(SAME_DIRECTION)

# Smallest number of points of a scan.
_FEWEST_POINTS = 4


@dataclass(frozen=True, eq=False)
class Scan:
    """BSDF values measured for one incident direction.

    Raises
    ------
    InputError : array lengths differ, a value is not finite, no value is positive, or
        there are fewer than four values
    """

    incident: Float[np.ndarray, "3"]  # unit vector towards the source
    leaving: Float[np.ndarray, "points 3"]  # unit vectors of the scattered directions
    # BSDF [1/sr]; negative values from noise are allowed
    values: Float[np.ndarray, " points"]
    source: str | None = None  # file name, for error messages

    __repr__ = brief

    def __post_init__(self) -> None:
        with located(file=self.source):
            same_length(self.values, self.leaving, "BSDF values", "directions")
            count = f"number of measured points is {len(self.values)}"
            message = f"{count}; {_FEWEST_POINTS} or more expected"
            require(len(self.values) >= _FEWEST_POINTS, message)
            finite(self.incident, "coordinate of the incident direction")
            finite(self.leaving, "coordinate of a scattered direction")
            finite(self.values, "BSDF value")
            lowest = min(self.incident[2], self.leaving[:, 2].min())
            require(lowest >= -1e-9, "a direction lies below the layer; z ≥ 0 expected")
            message = f"no value is above zero in the scan from {self.words}"
            require(np.any(self.values > 0), f"{message}; scattered light expected")

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
    def flux(self) -> float:
        """Directional-hemispherical transmittance or reflectance."""
        return float(self.values @ integration_weights(self.leaving))

    @property
    def words(self) -> str:
        """Incident direction as text, for messages."""
        return f"(θ {self.theta_deg:.1f}°, φ {self.phi_deg:.1f}°)"


@dataclass(frozen=True, eq=False)
class Measurement:
    """Scans of one scattering function of a sample, in one channel.

    Raises
    ------
    InputError : there is no scan, or two scans have the same incident direction
    """

    scans: tuple[Scan, ...]  # scans with different incident directions
    function: Function  # name of the scattering function, such as "transmission_front"
    channel: str = "visible"  # spectral channel, such as "visible" or "cie-x"
    name: str = ""  # name of the sample
    claimed: Symmetry | None = None  # symmetry stated in the file; None if not stated
    notes: tuple[str, ...] = ()  # irregularities of the files, and their treatment

    __repr__ = brief

    def __post_init__(self) -> None:
        require(self.scans, "no scan; one per incident direction expected")
        place = self.incidents
        pairs = np.argwhere(np.triu(place @ place.T > _COS_SAME, 1))
        if len(pairs):
            first, second = (self.scans[k] for k in pairs[0])
            raise InputError(
                f"incident direction {second.words} is also measured in"
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
        same = (g for g in groups if g[0].incident @ scan.incident > _COS_SAME)
        group = next(same, None)
        if group is None:
            groups.append([scan])
        else:
            group.append(scan)
    return tuple(
        replace(
            group[0],
            leaving=np.concatenate([scan.leaving for scan in group]),
            values=np.concatenate([scan.values for scan in group]),
        )
        for group in groups
    )
