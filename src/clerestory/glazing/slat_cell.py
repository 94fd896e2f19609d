"""Cross-section of a blind of equal slats, with view factors by ray casting.

The first coordinate points from outdoors to indoors, the second upwards. The section is
one period of the blind: the two faces of a slat, and vertical openings to the sky and
to the room beyond its edges. Rays are intersected with the copies of the slat above and
below, so slats may be curved, tilted and closed. Flux is conserved.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Indices, Points2, Values
from clerestory.checks import positive, require, within
from clerestory.directions import circular_arc

# Points and angles per face for view factors, and rays per opening for beams.
_POINTS, _ANGLES, _BEAMS = 16, 128, 1024

# Distance from the slat edges to the openings, as a fraction of the slat width
_MARGIN = 1e-6

# Largest change of direction along a segment of a curved slat [rad]
_SEGMENT_TURN = np.radians(5)
_MOST_SEGMENTS = 100


@final
@dataclass(frozen=True)
class SlatGeometry:
    """Cross-section of a venetian blind.

    Attributes
    ----------
    width : chord of a slat [m]
    spacing : distance between adjacent slats [m]
    tilt : tilt angle, positive if the outdoor edge is lowered [rad]
    curvature_radius : radius of curvature of the slats [m]; 0 for flat slats, positive
        if the middle of an untilted slat is above its edges
    segments : number of straight segments per slat; default: 5 as in WINDOW, more for
        slats that are strongly curved or close together
    """

    width: float
    spacing: float
    tilt: float = 0.0
    curvature_radius: float = 0.0
    segments: int | None = None

    def __post_init__(self) -> None:
        positive([self.width, self.spacing], "width or spacing of the slats", unit="m")
        within(np.degrees(self.tilt), "tilt of the slats", least=-90, most=90, unit="°")
        radius = abs(self.curvature_radius)
        require(
            radius == 0 or radius > self.width / 2,
            f"the curvature radius of slats {self.width:g} m wide is {radius:g} m; more"
            " than half the width, or 0 for flat slats, expected",
        )
        count = self.segment_count
        within(count, "number of segments per slat", least=1, most=_MOST_SEGMENTS)

    @property
    def segment_count(self) -> int:
        """Number of straight segments per slat.

        With constant radiosity on each of them, reflectance is within 0.02 of that of
        circular arcs, for any curvature and spacing.
        """
        if self.segments is not None:
            return self.segments
        turned = 0.0
        if self.curvature_radius:
            turned = 2 * np.arcsin(self.width / 2 / abs(self.curvature_radius))
        wanted = max(5, 4 * self.width / self.spacing, turned / _SEGMENT_TURN)
        return min(int(np.ceil(wanted)), _MOST_SEGMENTS)

    def polyline(self) -> Points2:
        """Points of a slat from outdoors to indoors, relative to mid-chord [m]."""
        count = self.segment_count
        if self.curvature_radius:
            half = np.arcsin(self.width / 2 / abs(self.curvature_radius))
            x, y = circular_arc(self.curvature_radius, half, count).T
        else:
            x = np.linspace(-0.5, 0.5, count + 1) * self.width
            y = np.zeros_like(x)
        cos, sin = np.cos(self.tilt), np.sin(self.tilt)
        return np.stack([x * cos - y * sin, x * sin + y * cos], axis=1)


@final
@dataclass(frozen=True, eq=False)
class SlatCell:
    """Faces of one period of a blind; unit normals point into the air between slats.

    Faces are, in this order: the upper faces of the segments of a slat from outdoors to
    indoors, their lower faces, the opening to the sky and the opening to the room.
    """

    start: Float[np.ndarray, "face 2"]
    end: Float[np.ndarray, "face 2"]
    normal: Float[np.ndarray, "face 2"]
    spacing: float

    @classmethod
    def between(cls, slats: SlatGeometry) -> "SlatCell":
        """Return the faces of one slat and the openings up to the next slat."""
        slat = slats.polyline()
        margin = _MARGIN * slats.width
        outermost = slat[[slat[:, 0].argmin(), slat[:, 0].argmax()]]
        openings = outermost + np.array([[-margin, 0.0], [margin, 0.0]])
        above = np.array([0, slats.spacing])
        along = np.diff(slat, axis=0)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        upper = np.stack([-along[:, 1], along[:, 0]], axis=1)
        return cls(
            np.concatenate([slat[:-1], slat[:-1], openings]),
            np.concatenate([slat[1:], slat[1:], openings + above]),
            np.concatenate([upper, -upper, [[1.0, 0.0], [-1.0, 0.0]]]),
            slats.spacing,
        )

    @property
    def segments(self) -> int:
        """Number of segments of a slat."""
        return (len(self.start) - 2) // 2

    @property
    def sky(self) -> int:
        """Face number of the opening to the sky."""
        return 2 * self.segments

    @property
    def room(self) -> int:
        """Face number of the opening to the room."""
        return 2 * self.segments + 1

    @property
    def lengths(self) -> Values:
        """Length of each face [m]."""
        return np.asarray(np.linalg.norm(self.end - self.start, axis=1))

    def view_factors(self) -> Float[np.ndarray, "face face"]:
        """View factors between all faces."""
        part = (np.arange(_POINTS) + 0.5) / _POINTS
        sine = (np.arange(_ANGLES) + 0.5) / _ANGLES * 2 - 1
        factors = np.zeros((len(self.start), len(self.start)))
        for face in range(len(self.start)):
            along = (self.end - self.start)[face]
            point = self.start[face] + part[:, None] * along
            tangent = along / np.linalg.norm(along)
            direction = (
                sine[:, None] * tangent
                + np.sqrt(1 - sine[:, None] ** 2) * self.normal[face]
            )
            origin = np.repeat(point, _ANGLES, axis=0)
            hit = self._hits(origin, np.tile(direction, (_POINTS, 1)), face)
            factors[face] = np.bincount(hit, minlength=len(self.start)) / len(hit)
        return self._reciprocal(factors)

    def beam(
        self, direction: Float[np.ndarray, "direction 2"], *, opening: int
    ) -> Float[np.ndarray, "direction face"]:
        """Fraction of a collimated beam through an opening that reaches each face.

        `direction`: directions of travel, into the blind. `opening`: `sky` or `room`.
        """
        part = ((np.arange(_BEAMS) + 0.5) / _BEAMS)[:, None]
        origin = self.start[opening] + part * (self.end - self.start)[opening]
        shares = np.zeros((len(direction), len(self.start)))
        for row, toward in enumerate(direction):
            hit = self._hits(origin, np.broadcast_to(toward, origin.shape), opening)
            shares[row] = np.bincount(hit, minlength=len(self.start)) / _BEAMS
        return shares

    @cached_property
    def _copies(self) -> tuple[Points2, Points2, int]:
        # End points of the segments of all slats that a ray can reach, and index of the
        # first segment of the middle slat
        start, end = self.start[: self.segments], self.end[: self.segments]
        height = np.ptp(np.concatenate([start, end])[:, 1])
        reach = int(np.ceil(2 * height / self.spacing)) + 2
        shift = np.arange(-reach, reach + 1)[:, None, None] * [0, self.spacing]
        first = reach * self.segments
        return (start + shift).reshape(-1, 2), (end + shift).reshape(-1, 2), first

    def _hits(self, origin: Points2, direction: Points2, leaving: int) -> Indices:
        # Number of the face that each ray from the face `leaving` reaches
        start, end, first = self._copies
        along = end - start
        away = start - origin[:, None]
        cross = _cross(direction[:, None], along)
        parallel = np.abs(cross) < 1e-14 * np.linalg.norm(along, axis=1)
        cross = np.where(parallel, 1, cross)
        distance = _cross(away, along) / cross
        place = _cross(away, direction[:, None]) / cross
        slack = 1e-9
        met = ~parallel & (distance > 0) & (place >= -slack) & (place <= 1 + slack)
        if leaving < self.sky:
            met[:, first + leaving % self.segments] = False
        segment = np.argmin(np.where(met, distance, np.inf), axis=1) % self.segments
        below = np.sum(direction * self.normal[segment], axis=1) > 0
        slat = segment + self.segments * below
        opening = np.where(direction[:, 0] > 0, self.room, self.sky)
        return np.asarray(np.where(met.any(axis=1), slat, opening))

    def _reciprocal(
        self, factors: Float[np.ndarray, "face face"]
    ) -> Float[np.ndarray, "face face"]:
        # Enforce reciprocity, L_i F_ij = L_j F_ji, and keep row sums of 1
        length = self.lengths[:, None]
        flux = length * factors
        for _ in range(50):
            flux = (flux + flux.T) / 2
            flux *= length / flux.sum(axis=1, keepdims=True)
        return np.asarray(flux / length)


def _cross(
    a: Float[np.ndarray, "*a 2"], b: Float[np.ndarray, "*b 2"]
) -> Float[np.ndarray, "*batch"]:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
