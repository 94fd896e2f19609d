"""Cross-section of the space between two slats, with view factors by ray casting.

The first coordinate points from outdoors to indoors, the second upwards. The space is
bounded by the lower face of the upper slat, the upper face of the lower slat, and the
openings to the sky and to the room. View factors, sunlit fractions and visible
fractions are computed by intersecting rays with these faces, so that flux is conserved.
"""

from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Indices, Points2, Values
from clerestory.checks import positive, require, within

# Points and angles per face for view factors, and rays per opening for beams.
_POINTS, _ANGLES, _BEAMS = 16, 128, 1024


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
    segments : number of straight segments per slat
    """

    width: float
    spacing: float
    tilt: float = 0.0
    curvature_radius: float = 0.0
    segments: int = 5

    def __post_init__(self) -> None:
        positive([self.width, self.spacing], "width or spacing of the slats", unit="m")
        tilt_deg = np.degrees(self.tilt)
        within(tilt_deg, "tilt of the slats", least=-90, most=90, unit="°")
        radius = abs(self.curvature_radius)
        require(
            radius == 0 or radius > self.width / 2,
            f"slats {self.width:g} m wide bent to a radius of {radius:g} m; more than"
            " half the width expected, or 0 for flat slats",
        )
        within(self.segments, "number of segments per slat", least=1, most=100)

    def polyline(self) -> Points2:
        """Points of a slat from outdoors to indoors, relative to mid-chord [m]."""
        if self.curvature_radius:
            radius = self.curvature_radius
            half = np.arcsin(self.width / 2 / abs(radius))
            angle = np.linspace(-half, half, self.segments + 1)
            x = abs(radius) * np.sin(angle)
            y = radius * (np.cos(angle) - np.cos(half))
        else:
            x = np.linspace(-0.5, 0.5, self.segments + 1) * self.width
            y = np.zeros_like(x)
        cos, sin = np.cos(self.tilt), np.sin(self.tilt)
        return np.stack([x * cos - y * sin, x * sin + y * cos], axis=1)


@final
@dataclass(frozen=True, eq=False)
class SlatCell:
    """Faces of the space between two slats, with unit normals into the space.

    Faces are, in this order: the segments of the upper face of the lower slat from
    outdoors to indoors, the segments of the lower face of the upper slat, the opening
    to the sky and the opening to the room.
    """

    start: Float[np.ndarray, "face 2"]
    end: Float[np.ndarray, "face 2"]
    normal: Float[np.ndarray, "face 2"]
    segments: int

    @classmethod
    def between(cls, slats: SlatGeometry) -> "SlatCell":
        """Return the space between two slats."""
        lower = slats.polyline()
        upper = lower + np.array([0, slats.spacing])
        start = np.concatenate([lower[:-1], upper[:-1], lower[[0, -1]]])
        end = np.concatenate([lower[1:], upper[1:], upper[[0, -1]]])
        along = (end - start) / np.linalg.norm(end - start, axis=1, keepdims=True)
        normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
        count = slats.segments
        normal[count : 2 * count] *= -1
        normal[2 * count] *= -1
        return cls(start, end, normal, count)

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

        `direction`: directions of travel, into the space. `opening`: `sky` or `room`.
        """
        part = ((np.arange(_BEAMS) + 0.5) / _BEAMS)[:, None]
        origin = self.start[opening] + part * (self.end - self.start)[opening]
        shares = np.zeros((len(direction), len(self.start)))
        for row, toward in enumerate(direction):
            hit = self._hits(origin, np.broadcast_to(toward, origin.shape), opening)
            shares[row] = np.bincount(hit, minlength=len(self.start)) / _BEAMS
        return shares

    def _hits(self, origin: Points2, direction: Points2, leaving: int) -> Indices:
        # Number of the first face that each ray intersects
        along = self.end - self.start
        away = self.start - origin[:, None]
        cross = _cross(direction[:, None], along)
        parallel = np.abs(cross) < 1e-14 * np.linalg.norm(along, axis=1)
        cross = np.where(parallel, 1, cross)
        distance = _cross(away, along) / cross
        place = _cross(away, direction[:, None]) / cross
        slack = 1e-9
        met = ~parallel & (distance > 0) & (place >= -slack) & (place <= 1 + slack)
        met[:, leaving] = False
        hit = np.argmin(np.where(met, distance, np.inf), axis=1)
        lost = ~met.any(axis=1)
        # Rays along an edge may miss all faces; they leave through the opposite opening
        hit[lost] = np.where(direction[lost, 0] > 0, self.room, self.sky)
        return np.asarray(hit)

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
