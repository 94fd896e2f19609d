"""Expansion of symmetric intensity tables to all directions."""

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError

_SAME_DEG = 1e-6


def unfold_type_c(
    horizontal_deg: Float[np.ndarray, " given"],
    intensity: Float[np.ndarray, "given vertical"],
) -> tuple[Float[np.ndarray, " all"], Float[np.ndarray, "all vertical"]]:
    """Return horizontal angles from 0° to 360°, and the intensities at these angles.

    Tables of a quadrant (0 to 90°) are reflected twice, half tables (0 to 180°, 90
    to 270° or −90 to 90°) once; a single angle means rotational symmetry.
    """
    if len(horizontal_deg) == 1:
        return np.zeros(1), intensity
    ends = (horizontal_deg[0], horizontal_deg[-1])
    h = horizontal_deg
    if _near(ends, 0, 90):
        return _joined([h, 180 - h, 180 + h, 360 - h], intensity)
    if _near(ends, 0, 180):
        return _joined([h, 360 - h], intensity)
    if _near(ends, 90, 270) or _near(ends, -90, 90):
        return _joined([h, 180 - h], intensity)
    if _near(ends, 0, 360) or (ends[0] >= 0 and 180 < ends[1] - ends[0] < 360):
        return _joined([h], intensity)
    raise InputError(
        f"horizontal angles from {ends[0]:g}° to {ends[1]:g}°; 0 to 90, 180 or 360,"
        " or 90 to 270 expected"
    )


def unfold_sides(
    horizontal_deg: Float[np.ndarray, " given"],
    intensity: Float[np.ndarray, "given vertical"],
) -> tuple[Float[np.ndarray, " all"], Float[np.ndarray, "all vertical"]]:
    """Return a type A or B table; if it starts at 0°, reflect it to negative angles."""
    if len(horizontal_deg) > 1 and abs(horizontal_deg[0]) < _SAME_DEG:
        angle = np.concatenate([-horizontal_deg[:0:-1], horizontal_deg])
        return angle, np.concatenate([intensity[:0:-1], intensity])
    return horizontal_deg, intensity


def _near(ends: tuple[float, float], low: float, high: float) -> bool:
    return bool(abs(ends[0] - low) < _SAME_DEG and abs(ends[1] - high) < _SAME_DEG)


def _joined(
    copies: list[Float[np.ndarray, " given"]],
    intensity: Float[np.ndarray, "given vertical"],
) -> tuple[Float[np.ndarray, " all"], Float[np.ndarray, "all vertical"]]:
    # Merge the reflected copies of a table into distinct angles from 0° to 360°
    angle = np.mod(np.concatenate(copies), 360.0).round(6)
    table = np.concatenate([intensity] * len(copies))
    angle, first = np.unique(angle, return_index=True)
    table = table[first]
    start = table[:1]
    if angle[0] != 0:
        # Interpolate between the last and the first angle
        share = (360 - angle[-1]) / (angle[0] + 360 - angle[-1])
        start = table[-1:] * (1 - share) + start * share
        angle, table = np.append(0.0, angle), np.concatenate([start, table])
    return np.append(angle, 360.0), np.concatenate([table, start])
