"""Orientation of windows in words, with quality checks.

Reversed windows and horizontal up vectors are the most common mistakes in studies with
BSDFs, and results alone do not reveal such mistakes.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.report.content import ReportContent, WindowSurface

_COMPASS = (
    *("north", "north-north-east", "north-east", "east-north-east"),
    *("east", "east-south-east", "south-east", "south-south-east"),
    *("south", "south-south-west", "south-west", "west-south-west"),
    *("west", "west-north-west", "north-west", "north-north-west"),
)


@dataclass(frozen=True)
class Orientation:
    """Orientation of one window, with compass directions in words.

    `in_front` is the fraction of sensors in front of the window, 0…1. `problem`
    describes a wrong orientation, and is empty for a correct one.
    """

    window: str
    area: float
    room_side: str
    outer_side: str
    up: str
    in_front: float
    problem: str


def orientation(window: WindowSurface, content: ReportContent) -> Orientation:
    """Return the orientation of one window."""
    apart = content.sensors.position - window.centre
    ahead = apart @ window.normal > -1e-6
    in_front = float(np.mean(ahead))
    # In a building most sensors may be in other rooms, but not the nearest
    nearest = np.linalg.norm(apart, axis=1).argmin()
    problem = ""
    if in_front < 0.5 and not ahead[nearest]:
        problem = (
            f"The front faces away from {1 - in_front:.0%} of the sensors."
            " The front must face the room: reverse the polygon’s vertices."
        )
    elif abs(window.normal[2]) < 0.5 and abs(window.up[2]) < 0.7:
        problem = (
            "The up direction is horizontal: a horizontal slat of the BSDF is"
            " vertical here."
        )
    elif abs(window.normal[2]) < 0.5 and window.up[2] < 0:
        problem = "The up direction points down: the BSDF is upside down."
    return Orientation(
        window.name,
        window.area,
        compass(window.normal, north=content.north),
        compass(-window.normal, north=content.north),
        compass(window.up, north=content.north),
        in_front,
        problem,
    )


def compass(direction: Float[np.ndarray, "3"], *, north: float = 0.0) -> str:
    """Return a direction in words; `north` is the azimuth of the scene's +y [rad].

    >>> compass(np.array([1.0, 0, 0])), compass(np.array([0, -0.6, 0.8]))
    ('east', 'south, 53° upwards')
    """
    altitude = math.degrees(math.asin(max(-1.0, min(1.0, float(direction[2])))))
    if abs(altitude) > 85:
        return "straight up" if altitude > 0 else "straight down"
    azimuth = math.atan2(float(direction[0]), float(direction[1])) + north
    words = _COMPASS[round(math.degrees(azimuth) / 22.5) % 16]
    if abs(altitude) < 0.5:
        return words
    return f"{words}, {abs(altitude):.0f}° {'upwards' if altitude > 0 else 'downwards'}"
