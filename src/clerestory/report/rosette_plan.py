"""Floor plans with a rosette at each position: a sector for each view direction."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, UInt8

from clerestory.brief_repr import brief
from clerestory.report.colour import hexadecimal
from clerestory.report.content import ReportContent
from clerestory.report.floor_plan import PlanFrame, frame_around, plan_drawing
from clerestory.report.markup import Markup, element

_UP = np.array([0.0, 0.0, 1.0])

# Radius of rosettes: share of the distance between positions, and limits in drawing
# units; share of the radius that is open in the middle
_REACH, _SMALLEST, _LARGEST = 0.46, 2.5, 22.0
_OPEN = 0.28

# Points on the arc of a sector
_ARC = 5


@dataclass(frozen=True, eq=False)
class Rosettes:
    """Places of the rosettes of positions at one height, in a plan.

    `centre` and `radius` are in drawing units, `azimuth` is clockwise from the scene's
    +y [rad].
    """

    frame: PlanFrame
    centre: Float[np.ndarray, "position 2"]
    radius: float
    azimuth: Float[np.ndarray, " direction"]

    __repr__ = brief

    def outlines(self) -> Float[np.ndarray, "position direction corner 2"]:
        """Return the outline of each sector in drawing units."""
        half = np.pi / max(len(self.azimuth), 3)
        turn = self.azimuth[:, None] + np.linspace(-half, half, _ARC)
        ahead = np.stack([np.sin(turn), -np.cos(turn)], axis=-1)
        ring = np.concatenate([ahead, _OPEN * ahead[:, ::-1]], axis=1)
        return np.asarray(self.centre[:, None, None] + self.radius * ring)

    def data(self) -> dict[str, Any]:
        """Return places, radius and azimuths as JSON values."""
        x, y = self.centre.round(1).T.tolist()
        azimuth = self.azimuth.round(4).tolist()
        return {"x": x, "y": y, "radius": round(self.radius, 1), "azimuth": azimuth}


def rosettes(
    content: ReportContent,
    position: Float[np.ndarray, "position 3"],
    azimuth_deg: Float[np.ndarray, " direction"],
    *,
    identifier: str,
) -> Rosettes:
    """Return the rosettes of positions at one height."""
    up = np.tile(_UP, (len(position), 1))
    frame = frame_around(content, position, up, identifier=identifier)
    centre = frame.place(position[:, :2])
    radius = float(np.clip(_REACH * _closest(centre), _SMALLEST, _LARGEST))
    return Rosettes(frame, centre, radius, np.radians(azimuth_deg))


def _closest(centre: Float[np.ndarray, "position 2"]) -> float:
    # Smallest distance between positions that are drawn apart
    if len(centre) < 2:
        return np.inf
    nearest = [
        np.partition(np.linalg.norm(centre - one, axis=1), 1)[1] for one in centre
    ]
    return float(np.min(nearest))


def rosette_plan(
    drawn: Rosettes,
    colours: UInt8[np.ndarray, "position direction 3"],
    content: ReportContent,
    *,
    label: str,
) -> Markup:
    """Return a plan whose sectors have the given sRGB colours."""
    shown = np.array(hexadecimal(colours.reshape(-1, 3)))
    outline = drawn.outlines().reshape(len(shown), -1, 2)
    painted = [
        element("path", d=_paths(outline[shown == colour]), fill=colour)
        for colour in dict.fromkeys(shown.tolist())
    ]
    return plan_drawing(
        drawn.frame,
        content,
        label,
        element("g", *painted, class_="sectors"),
        element("path", class_="pointed", d=""),
        class_="plan rosettes",
        data_rosettes=drawn.frame.identifier,
    )


def _paths(outlines: Float[np.ndarray, "outline corner 2"]) -> str:
    return "".join(
        "M" + "L".join(f"{x:.1f},{y:.1f}" for x, y in outline) + "Z"
        for outline in outlines.tolist()
    )
