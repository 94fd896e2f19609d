"""Luminous intensity distribution, luminous shape and flux of luminaires.

The nadir of the luminaire is −z; photometric 0° is +x. For a direction of emission l,
the angles of the intensity table are:

- type C: vertical angle from the nadir; horizontal angle from +x towards +y;
- type B: vertical angle atan2(lx, −lz) about the y axis; horizontal angle asin(−ly)
  from the xz plane;
- type A: horizontal angle atan2(−ly, −lz) about the x axis; vertical angle asin(lx)
  from the yz plane.

Reference: I. Ashdown, Thinking photometrically, LightFair 2001 (types A, B and C);
IES LM-63-02.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import not_negative, require

PhotometricType = Literal["A", "B", "C"]

# Tolerance of angles [deg]
_SAME_DEG = 1e-6


@dataclass(frozen=True)
class LuminousShape:
    """The luminous shape of a luminaire, centred at the origin; sizes in metres.

    A height `z` of 0 means a flat area; `x` and `y` equal the diameter of a cylinder
    or sphere.
    """

    kind: Literal["box", "cylinder", "sphere"]
    x: float
    y: float
    z: float

    def __post_init__(self) -> None:
        sizes = (self.x, self.y, self.z)
        require(
            min(sizes[:2]) > 0 and self.z >= 0 and np.all(np.isfinite(sizes)),
            f"the luminous {self.kind} is {self.x:g} × {self.y:g} × {self.z:g} m; sizes"
            " above 0 expected",
        )


@dataclass(frozen=True)
class TiltTable:
    """Multipliers of the luminous flux by tilt of the luminaire.

    `geometry`: lamp-to-luminaire geometry, 1 for vertical lamps, 2 and 3 for
    horizontal.
    """

    geometry: int
    angle_deg: tuple[float, ...]
    factor: tuple[float, ...]

    def at(self, tilt_deg: float) -> float:
        """Return the multiplier of the luminous flux at a tilt angle."""
        return float(np.interp(abs(tilt_deg), self.angle_deg, self.factor))


@dataclass(frozen=True, eq=False)
class Luminaire:
    """An absolute luminous intensity distribution with shape and lamp data.

    Attributes
    ----------
    name : name in the file
    photometry : photometric type of the angles
    horizontal_deg : ascending horizontal angles; 0 to 360 for type C, or a single 0 for
        rotational symmetry
    vertical_deg : ascending vertical angles; outside them the intensity is zero
    intensity : luminous intensity [cd]
    shape : luminous shape
    lamp_lumens : luminous flux of all lamps [lm]; None for absolute photometry
    watts : electric power [W]
    keywords : other data in the file, by keyword
    tilt : flux multipliers by tilt angle; None if the flux is independent of tilt
    """

    name: str
    photometry: PhotometricType
    horizontal_deg: Float[np.ndarray, " horizontal"]
    vertical_deg: Float[np.ndarray, " vertical"]
    intensity: Float[np.ndarray, "horizontal vertical"]
    shape: LuminousShape
    lamp_lumens: float | None = None
    watts: float = 0.0
    keywords: Mapping[str, str] = field(default_factory=dict)
    tilt: TiltTable | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        low, high = (0.0, 180.0) if self.photometry == "C" else (-90.0, 90.0)
        _check_angles("vertical", self.vertical_deg, low, high, 2)
        wide = (0.0, 360.0) if self.photometry == "C" else (-180.0, 180.0)
        _check_angles("horizontal", self.horizontal_deg, *wide, 1)
        not_negative(self.intensity, "an intensity", unit="cd")

    def candela(
        self, direction: Float[np.ndarray, "*batch 3"]
    ) -> Float[np.ndarray, "*batch"]:
        """Return luminous intensities [cd] in directions in the luminaire's frame."""
        horizontal, vertical = self.angles(direction)
        row, across, inside = _place(self.horizontal_deg, horizontal)
        column, along, within = _place(self.vertical_deg, vertical)
        last = len(self.horizontal_deg) - 1
        first, second = (
            self.intensity[at, column] * (1 - along)
            + self.intensity[at, column + 1] * along
            for at in (row, np.minimum(row + 1, last))
        )
        value = first * (1 - across) + second * across
        return np.where(inside & within, value, 0.0)

    def angles(
        self, direction: Float[np.ndarray, "*batch 3"]
    ) -> tuple[Float[np.ndarray, "*batch"], Float[np.ndarray, "*batch"]]:
        """Return horizontal and vertical photometric angles [deg] of directions."""
        x, y, z = np.moveaxis(direction, -1, 0)
        match self.photometry:
            case "C":
                horizontal = np.mod(np.degrees(np.arctan2(y, x)), 360.0)
                vertical = np.degrees(np.arccos(np.clip(-z, -1, 1)))
            case "B":
                horizontal = np.degrees(np.arcsin(np.clip(-y, -1, 1)))
                vertical = np.degrees(np.arctan2(x, -z))
            case _:
                horizontal = np.degrees(np.arctan2(-y, -z))
                vertical = np.degrees(np.arcsin(np.clip(x, -1, 1)))
        return np.asarray(horizontal), np.asarray(vertical)

    def flux(self) -> float:
        """Return the luminous flux [lm]: integral of the interpolated intensity."""
        if self.photometry == "B":
            # In type B the horizontal angle is the latitude
            weights = _latitude_weights(self.horizontal_deg)
            turn, table = self.vertical_deg, self.intensity
        else:
            polar = self.vertical_deg - (90.0 if self.photometry == "C" else 0.0)
            weights = _latitude_weights(polar)
            turn, table = self.horizontal_deg, self.intensity.T
        around = weights @ table
        if len(turn) == 1:
            return float(2 * np.pi * around[0])
        return float(np.trapezoid(around, np.radians(turn)))

    def scaled(self, factor: float) -> "Luminaire":
        """Return the luminaire with scaled intensity and lamp flux."""
        not_negative(factor, "the factor of a luminaire")
        lumens = None if self.lamp_lumens is None else self.lamp_lumens * factor
        return replace(self, intensity=self.intensity * factor, lamp_lumens=lumens)


def _check_angles(
    what: str, angle: Float[np.ndarray, " angles"], low: float, high: float, least: int
) -> None:
    require(
        len(angle) >= least and np.all(np.diff(angle) > 0),
        f"{len(angle)} {what} angles; {least} or more in increasing order expected",
    )
    require(
        angle[0] >= low - _SAME_DEG and angle[-1] <= high + _SAME_DEG,
        f"{what} angles from {angle[0]:g}° to {angle[-1]:g}°; {low:g}° to {high:g}°"
        " expected",
    )


def _place(
    angles: Float[np.ndarray, " angles"], at: Float[np.ndarray, "*batch"]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    # Per angle: table interval, position in the interval, and whether in the table
    if len(angles) == 1:
        zero = np.zeros(at.shape)
        return zero.astype(int), zero, np.ones(at.shape, dtype=bool)
    cell = np.clip(np.searchsorted(angles, at, side="right") - 1, 0, len(angles) - 2)
    share = (at - angles[cell]) / (angles[cell + 1] - angles[cell])
    inside = (at >= angles[0] - _SAME_DEG) & (at <= angles[-1] + _SAME_DEG)
    return cell, np.clip(share, 0, 1), inside


def _latitude_weights(
    latitude_deg: Float[np.ndarray, " angles"],
) -> Float[np.ndarray, " angles"]:
    # Weights for which ∫ f cos λ dλ = weights @ f if f is linear between the angles;
    # `upper` is the weight of the upper end of each interval
    lam = np.radians(latitude_deg)
    width = np.diff(lam)
    whole = np.diff(np.sin(lam))
    upper = np.sin(lam[1:]) + np.diff(np.cos(lam)) / width
    weights = np.zeros(len(lam))
    weights[1:] += upper
    weights[:-1] += whole - upper
    return weights
