"""Air flow through blinds, woven shades and perforated screens, after WINDOW.

The opening through which buoyancy drives air follows from the permeable share of the
area, by fits of R. Hart, H. Goudey and D. C. Curcija, Journal of Building Performance
Simulation 11 (2), 2018, as in LBNL's Windows-CalcEngine (`EffectiveMultipliers`).
"""

import math
from typing import NamedTuple

from clerestory.glazing.screen import PerforatedScreen, WovenShade
from clerestory.glazing.venetian import VenetianBlind

Shade = VenetianBlind | WovenShade | PerforatedScreen


class AirFlow(NamedTuple):
    """Permeable share of the area, opening for air per area, and thickness [m]."""

    permeability: float
    opening: float
    thickness: float


def air_flow(shade: Shade) -> AirFlow:
    """Return the permeability of a shade to air, and its thermal thickness."""
    thickness = shade.material.thickness
    if isinstance(shade, VenetianBlind):
        return _between_slats(shade, thickness)
    if isinstance(shade, WovenShade):
        hole = 1 - shade.thread_diameter / shade.thread_spacing
        permeability = max(0.0, hole) ** 2
    else:
        circle, rectangle = math.pi * shade.size[0] ** 2, math.prod(shade.size)
        hole = circle if shade.shape == "circular" else rectangle
        permeability = hole / math.prod(shade.spacing)
    return AirFlow(permeability, 0.078 * permeability**1.2, thickness)


def _between_slats(blind: VenetianBlind, thickness: float) -> AirFlow:
    slats, space = blind.slats, blind.slats.spacing + thickness
    arc = slats.width
    if radius := abs(slats.curvature_radius):
        arc = 2 * radius * math.asin(slats.width / 2 / radius)
    # Slats close when they touch; vertical slats have no opening in the fit
    closed = min(abs(slats.tilt), math.acos(thickness / space))
    wide = arc * math.cos(closed) + thickness * math.sin(closed)
    permeability = max(0.0, 1 - thickness * arc / (wide * space))
    cos, sin = math.cos(slats.tilt), math.sin(slats.tilt)
    opening = 0.016 * (permeability * cos**-0.63) ** 0.53
    depth = 0.043 * (slats.width * cos + thickness * sin)
    # The fit grows without limit towards 90°, where pywincalc finds no solution
    return AirFlow(permeability, min(opening, permeability), depth)
