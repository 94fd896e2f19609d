"""Perforated screens and woven fabrics, by the models of WINDOW.

Flux through the openings is undeviated; the remaining flux is scattered by the
Lambertian material. Openness follows from geometry, and forward scattering by threads
from an empirical formula.

References: W. R. McCluney, L. Mills, ASHRAE Transactions 99 (2), 1993 (woven); LBNL,
WINDOW 7 technical documentation (perforated screens).
"""

from dataclasses import dataclass
from typing import Literal, final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, PerWavelength, Values
from clerestory.bsdf.scattering_function import Function
from clerestory.checks import positive, require
from clerestory.glazing.layer import Sheet, diagonal, lambertian_matrices
from clerestory.glazing.optics import Optics
from clerestory.hemisphere.partition import RingPartition

Opening = Literal["circular", "rectangular"]


@final
@dataclass(frozen=True, eq=False)
class PerforatedScreen(Sheet):
    """A sheet with holes in a regular grid; its thickness limits oblique transmission.

    Attributes
    ----------
    shape : shape of the holes
    spacing : horizontal and vertical distance between the hole centres [m]
    size : width and height of rectangular holes, or radius of circular holes (first
        number) [m]
    """

    shape: Opening
    spacing: tuple[float, float]
    size: tuple[float, float]

    def __post_init__(self) -> None:
        widest = [2 * self.size[0]] * 2 if self.shape == "circular" else self.size
        positive([*self.spacing, *widest], f"a length of {self.name!r}", unit="m")
        require(
            all(w <= s for w, s in zip(widest, self.spacing, strict=True)),
            f"screen {self.name!r} has holes of {tuple(widest)} m every"
            f" {self.spacing} m, which overlap; smaller holes expected",
        )

    def openness(self, direction: Directions) -> Values:
        """Fraction of the flux in each direction that passes through the holes."""
        x, y, z = direction.T
        deep = self.material.thickness
        if self.shape == "rectangular":
            free = [
                np.maximum((size - deep * np.abs(side) / z) / spacing, 0)
                for side, size, spacing in zip(
                    (x, y), self.size, self.spacing, strict=True
                )
            ]
            return np.asarray(free[0] * free[1])
        radius, area = self.size[0], self.spacing[0] * self.spacing[1]
        slope = np.hypot(x, y) / z
        hole = np.pi * radius**2 - np.pi / 2 * radius * deep * slope
        return np.where(slope * deep <= 2 * radius, np.maximum(hole, 0) / area, 0)

    def matrices(self, wavelength_nm: Values, partition: RingPartition) -> Optics:
        """BSDFs [1/sr] by wavelength, exit patch and incident patch."""
        free = self.openness(partition.centres())
        even = lambertian_matrices(self.material.at(wavelength_nm), 1 - free)
        return _with_openings(even, free, partition)


@final
@dataclass(frozen=True, eq=False)
class WovenShade(Sheet):
    """A fabric of threads that cross at right angles; lengths in metres."""

    thread_diameter: float
    thread_spacing: float

    def __post_init__(self) -> None:
        require(
            0 < self.thread_diameter <= self.thread_spacing,
            f"fabric {self.name!r} has threads of {self.thread_diameter:g} m every"
            f" {self.thread_spacing:g} m; 0 < diameter ≤ spacing expected",
        )

    def openness(self, direction: Directions) -> Values:
        """Fraction of the flux in each direction that passes between the threads."""
        altitude, azimuth = _altitude_azimuth(direction)
        profile = np.arctan(np.tan(altitude) / np.cos(altitude))
        gamma = self.thread_diameter / self.thread_spacing
        free = [np.maximum(1 - gamma / np.cos(a), 0) for a in (azimuth, profile)]
        return np.asarray(free[0] * free[1])

    def matrices(self, wavelength_nm: Values, partition: RingPartition) -> Optics:
        """BSDFs [1/sr] by wavelength, exit patch and incident patch."""
        shares = self.material.at(wavelength_nm)
        free = self.openness(partition.centres())
        even = lambertian_matrices(shares, 1 - free)
        forwards = {
            side: self._scattered_forwards(back, partition.centres())[:, None] / np.pi
            for side, back in (
                ("front", shares.reflection_back),
                ("back", shares.reflection_front),
            )
        }
        # Forward scattering by threads increases transmission and decreases reflection
        gain = {"transmission": 1, "reflection": -1}

        def total(name: Function) -> Float[np.ndarray, "wavelength exit incident"]:
            kind, side = name.split("_")
            return np.maximum(even.of(name) + gain[kind] * forwards[side], 0)

        return _with_openings(Optics.gather(total), free, partition)

    def _scattered_forwards(
        self, reflectance: PerWavelength, direction: Float[np.ndarray, "direction 3"]
    ) -> Float[np.ndarray, "wavelength direction"]:
        # Regression of measured fabrics; angles in degrees
        gamma = self.thread_diameter / self.thread_spacing
        if gamma >= 1:
            return np.zeros((len(reflectance), len(direction)))
        rho = np.maximum(reflectance, 1e-12)[:, None]
        delta = np.hypot(*np.degrees(_altitude_azimuth(direction)))
        peak_at = 89.7 - 10 * gamma / 0.16
        most = (
            0.0229 * gamma
            + 0.2971 * rho
            - 0.03624 * gamma**2
            + 0.04763 * rho**2
            - 0.44416 * gamma * rho
        )
        level = 0.2 * rho * most * (1 - gamma)
        peak = 1 / (0.2 * rho * (1 - gamma))
        beyond = delta > peak_at
        power = np.where(beyond, 2.5, 2.0)
        bell = np.exp(-(np.abs(delta - peak_at) ** power) / 600)
        fall = np.where(beyond, np.maximum((delta - peak_at) / (90 - peak_at), 0), 0)
        scattered = level * (1 + (peak - 1) * bell) - level * fall
        return np.where(reflectance[:, None] > 0, np.maximum(scattered, 0), 0)


def _with_openings(even: Optics, free: Values, partition: RingPartition) -> Optics:
    # Add the undeviated transmission of the openings in both directions
    straight = diagonal((free / partition.projected_solid_angles())[None])
    return Optics(
        even.transmission_front + straight,
        even.transmission_back + straight,
        even.reflection_front,
        even.reflection_back,
    )


def _altitude_azimuth(direction: Directions) -> tuple[Values, Values]:
    # Absolute values of altitude and azimuth relative to the normal [rad]
    x, y, z = direction.T
    return np.arcsin(np.clip(np.abs(y), 0, 1)), np.arctan2(np.abs(x), z)
