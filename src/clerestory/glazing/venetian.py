"""Venetian blinds by radiosity between Lambertian slats.

In cross-section, the irradiance of each face follows from geometry, its radiosity from
the flux balance of all faces, and the exit radiance from the visible fraction of each
face. Slats are infinitely long: directions are projected onto the section (profile
angle).

References: ISO 15099:2003, 7.2 and 7.3; D. Carli, Calculation of optical properties for
a venetian blind type of shading device, Carli Inc., 2006 (the model of WINDOW); J. H.
Klems, Solar heat gain through fenestration systems containing shading, LBNL 46682,
2000.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, NamedTuple, final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, PerWavelength, Points2, Values
from clerestory.glazing.layer import MaterialLayer, diagonal
from clerestory.glazing.optics import Optics
from clerestory.glazing.slat_cell import SlatCell, SlatGeometry
from clerestory.hemisphere.partition import RingPartition

Distribution = Literal["directional", "uniform"]


class _Beams(NamedTuple):
    """Flux fractions of beams that reach each face or miss the slats, per direction."""

    entering: Float[np.ndarray, "direction face"]
    straight: Float[np.ndarray, " direction"]


@final
@dataclass(frozen=True, eq=False)
class VenetianBlind(MaterialLayer):
    """A blind of parallel slats.

    Attributes
    ----------
    material : slat material; its front side is the upper face of the slats
    slats : cross-section of the slats
    distribution : "directional" uses the fraction of each face that is visible from
        each exit patch; "uniform" distributes exit radiance uniformly
    vertical : whether slats are vertical; positive tilt then turns the outdoor edge to
        the left, as seen from the room
    """

    slats: SlatGeometry
    distribution: Distribution = "directional"
    vertical: bool = False

    @property
    def name(self) -> str:
        """Name of the material, and tilt angle of the slats."""
        return f"{self.material.name}, slats at {np.degrees(self.slats.tilt):.0f}°"

    @property
    def thickness(self) -> float:
        """Depth of the tilted slats plus the thickness of the material [m]."""
        return float(np.ptp(self.slats.polyline()[:, 0])) + self.material.thickness

    def matrices(self, wavelength_nm: Values, partition: RingPartition) -> Optics:
        """BSDFs [1/sr] by wavelength, exit patch and incident patch."""
        measure = partition.projected_solid_angles()
        if partition not in self._traced:
            self._traced[partition] = self._trace(self._section(partition))
        front, back, leaving, returning = self._traced[partition]
        sent = [self._sent(beams.entering, wavelength_nm) for beams in (front, back)]
        to_room, to_sky = leaving.entering, returning.entering
        if self.distribution == "uniform":
            # View factors from each opening to the faces
            faces, openings = to_room.shape[1], (self._cell.room, self._cell.sky)
            to_room, to_sky = (
                np.broadcast_to(self._view[opening, :faces], to_room.shape)
                for opening in openings
            )
        pairs = ((to_room, 0), (to_sky, 1), (to_sky, 0), (to_room, 1))
        parts = [
            np.einsum("of,wfi->woi", seen, sent[side]) / np.pi for seen, side in pairs
        ]
        straight = [diagonal((b.straight / measure)[None]) for b in (front, back)]
        parts[:2] = [part + beam for part, beam in zip(parts, straight, strict=False)]
        return Optics(*parts)

    def openness(self, direction: Directions) -> Values:
        """Fraction of the flux in each direction that passes between the slats."""
        x, y, z = direction.T
        profile = np.arctan2(x if self.vertical else y, z)
        angle, share = self._passing
        return np.asarray(np.interp(profile, angle, share))

    def flipped(self) -> "VenetianBlind":
        """Return the blind turned about its vertical axis."""
        if self.vertical:
            return replace(self, material=self.material.flipped())
        return replace(self, slats=replace(self.slats, tilt=-self.slats.tilt))

    @cached_property
    def _cell(self) -> SlatCell:
        return SlatCell.between(self.slats)

    @cached_property
    def _view(self) -> Float[np.ndarray, "face face"]:
        return self._cell.view_factors()

    @cached_property
    def _passing(self) -> tuple[Values, Values]:
        # Direct transmittance at profile angles in steps of a quarter degree
        angle = np.radians(np.linspace(-89.75, 89.75, 719))
        section = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return angle, self._beams(section, self._cell.sky).straight

    def _section(self, partition: RingPartition) -> Points2:
        # Components of directions of travel: into the room, and up (or right)
        x, y, z = partition.centres().T
        return np.stack([z, x if self.vertical else y], axis=1)

    @cached_property
    def _traced(self) -> dict[RingPartition, tuple[_Beams, ...]]:
        # Beams by partition, which are the same at all wavelengths
        return {}

    def _trace(self, section: Points2) -> tuple[_Beams, ...]:
        # Beams on the front and on the back. By reciprocity, the fractions that are
        # visible from room and sky equal the sunlit fractions for reversed rays
        sky, room = self._cell.sky, self._cell.room
        ways = ((1, 1), sky), ((-1, 1), room), ((-1, -1), room), ((1, -1), sky)
        return tuple(self._beams(section * turned, opening) for turned, opening in ways)

    def _beams(self, direction: Points2, opening: int) -> _Beams:
        shares = self._cell.beam(direction, opening=opening)
        other = self._cell.room if opening == self._cell.sky else self._cell.sky
        return _Beams(shares[:, : 2 * self.slats.segment_count], shares[:, other])

    def _sent(
        self,
        entering: Float[np.ndarray, "direction face"],
        wavelength_nm: PerWavelength,
    ) -> Float[np.ndarray, "wavelength face direction"]:
        # Radiosity of each face per unit irradiance of the blind, after all reflections
        count = self.slats.segment_count
        spacing, length = self.slats.spacing, self._cell.lengths[: 2 * count]
        passes = self._material_matrix(wavelength_nm)
        among = self._view[: 2 * count, : 2 * count]
        fall = entering.T * spacing / length[:, None]
        balance = np.eye(2 * count) - passes @ among
        return np.asarray(np.linalg.solve(balance, passes @ fall))

    def _material_matrix(
        self, wavelength_nm: PerWavelength
    ) -> Float[np.ndarray, "wavelength face face"]:
        # Each face reflects flux, and transmits flux from the other side of the slat
        shares = self.material.at(wavelength_nm)
        count = self.slats.segment_count
        same, across = np.eye(count), np.eye(count)
        upper = [shares.reflection_front, shares.transmission_back]
        lower = [shares.transmission_front, shares.reflection_back]
        rows = [
            np.concatenate(
                [one[:, None, None] * same, two[:, None, None] * across], axis=2
            )
            for one, two in (upper, lower)
        ]
        return np.concatenate(rows, axis=1)
