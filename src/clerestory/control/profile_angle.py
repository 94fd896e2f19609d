"""Profile angle of the sun and cut-off tilt of slats.

The profile angle ψ is the solar altitude projected to the plane perpendicular to the
slats. The direct-direct transmittance of slats of width w and spacing s, tilted by β
with the outer edge down, is 1 − (w/s)|sin(β + ψ)|/cos ψ, at least 0.

Reference: ISO 15099:2003, 7.3 (direct transmittance of flat slats), solved for β.
"""

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.checks import positive
from clerestory.directions import Frame


def profile_angle(
    sun: Float[np.ndarray, "time 3"], frame: Frame, *, vertical: bool = False
) -> Float[np.ndarray, " time"]:
    """Profile angle of the sun [rad], measured upwards from the window normal.

    `sun` are unit vectors; `frame` is the frame of the window, with the normal into the
    room. The angle is NaN if the sun is behind the window. For vertical slats, the
    profile angle is measured to the right as seen from the room.

    >>> y, z = np.eye(3)[1:]
    >>> south = Frame.from_normal_up(y, z)
    >>> high = np.array([[0.0, -0.5, np.sqrt(0.75)]])
    >>> np.degrees(profile_angle(high, south)).round(6).tolist()
    [60.0]
    """
    outward = -(sun @ frame.normal)
    across = sun @ (frame.right if vertical else frame.up)
    return np.where(outward > 0, np.arctan2(across, outward), np.nan)


def cut_off_tilt(
    profile: Float[np.ndarray, " time"], *, width: float, spacing: float
) -> Float[np.ndarray, " time"]:
    """Cut-off tilt: smallest slat tilt that blocks direct sunlight, 0 to π/2 [rad].

    Slats with tilt 0 are horizontal; positive tilts turn the outer edge down. If no
    tilt blocks direct sunlight, the tilt of smallest transmittance is returned. The
    result is NaN for a profile angle of NaN.

    >>> wide = cut_off_tilt(np.array([0.0]), width=0.08, spacing=0.04)
    >>> np.degrees(wide).round(6).tolist()  # sin β = s/w
    [30.0]
    """
    positive(width, "slat width", unit="m")
    positive(spacing, "slat spacing", unit="m")
    sine = np.minimum(spacing / width * np.cos(profile), 1)
    return np.asarray(np.clip(np.arcsin(sine) - profile, 0, np.pi / 2))


def direct_share(
    profile: Float[np.ndarray, "*batch"],
    tilt: Float[np.ndarray, "*batch"] | float,
    *,
    width: float,
    spacing: float,
) -> Float[np.ndarray, "*batch"]:
    """Direct-direct transmittance of flat slats; 0 if the sun is behind the window."""
    hidden = width / spacing * np.abs(np.sin(tilt + profile)) / np.cos(profile)
    return np.asarray(np.nan_to_num(np.maximum(1 - hidden, 0)))


def blocking_states(
    profile: Float[np.ndarray, " time"],
    *,
    tilts: Float[np.ndarray, " state"],
    width: float,
    spacing: float,
    sunny: Bool[np.ndarray, " time"] | None = None,
) -> Int[np.ndarray, " time"]:
    """Most open state that blocks direct sunlight, or the last state if none does.

    Parameters
    ----------
    profile : profile angle [rad]; NaN (sun behind the window) gives state 0
    tilts : slat tilt of each state [rad], from the most open to the most closed state
    width, spacing : width and spacing of the slats [m]
    sunny : whether there is direct sunlight at each time step; default: at all

    >>> tilts = np.radians([0.0, 60.0, 75.0])
    >>> sun = np.radians([60.0, 10.0, np.nan])
    >>> blocking_states(sun, tilts=tilts, width=0.08, spacing=0.072).tolist()
    [0, 1, 0]
    """
    passed = np.stack(
        [direct_share(profile, tilt, width=width, spacing=spacing) for tilt in tilts]
    )
    stops = passed <= 1e-9
    state = np.where(stops.any(axis=0), stops.argmax(axis=0), len(tilts) - 1)
    return state if sunny is None else np.where(sunny, state, 0)
