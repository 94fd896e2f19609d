"""Which way the windows face, in words, and whether that can be right.

A window turned front to back, or an up vector lying on its side, is the
commonest mistake in studies with BSDFs, and no number gives it away.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.report.content import ReportContent, WindowSurface
from clerestory.report.markup import Markup, element

_COMPASS = (
    *("north", "north-north-east", "north-east", "east-north-east"),
    *("east", "east-south-east", "south-east", "south-south-east"),
    *("south", "south-south-west", "south-west", "west-south-west"),
    *("west", "west-north-west", "north-west", "north-north-west"),
)


@dataclass(frozen=True)
class Orientation:
    """What can be said of one window.

    Attributes
    ----------
    window : its name
    area : [m²]
    room_side, outer_side : where its front and its back face, in words
    up : where the up direction of its BSDF points, in words
    seen : share of the sensors in front of it, 0…1
    doubt : what looks wrong, empty if nothing does
    """

    window: str
    area: float
    room_side: str
    outer_side: str
    up: str
    seen: float
    doubt: str


def orientation(window: WindowSurface, content: ReportContent) -> Orientation:
    """Return what can be said of one window."""
    ahead = (content.sensors.position - window.centre) @ window.normal
    seen = float(np.mean(ahead > -1e-6))
    doubt = ""
    if seen < 0.5:
        doubt = (
            f"The front faces away from {1 - seen:.0%} of the sensors."
            " The front must face the room: turn the polygon’s vertices round."
        )
    elif abs(window.normal[2]) < 0.5 and abs(window.up[2]) < 0.7:
        doubt = (
            "The up direction lies on its side: a horizontal slat of the BSDF stands"
            " upright here."
        )
    elif abs(window.normal[2]) < 0.5 and window.up[2] < 0:
        doubt = "The up direction points down: the BSDF stands on its head."
    return Orientation(
        window.name,
        window.area,
        compass(window.normal, north=content.north),
        compass(-window.normal, north=content.north),
        compass(window.up, north=content.north),
        seen,
        doubt,
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


def orientation_table(rows: list[Orientation]) -> Markup:
    """Return the windows as a table."""
    head = (
        "Window",
        "Area",
        "Room side faces",
        "Outer side faces",
        "BSDF’s up",
        "Check",
    )
    body = []
    for row in rows:
        check = (
            element("td", row.doubt, class_="doubt")
            if row.doubt
            else element("td", f"{row.seen:.0%} of the sensors in front", class_="fine")
        )
        cells = (f"{row.area:.2f} m²", row.room_side, row.outer_side, row.up)
        body.append(
            element(
                "tr",
                element("th", row.window, scope="row"),
                *(element("td", cell) for cell in cells),
                check,
            )
        )
    titles = (element("th", title, scope="col") for title in head)
    return element(
        "table", element("thead", element("tr", *titles)), element("tbody", *body)
    )
