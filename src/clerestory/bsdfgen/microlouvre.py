"""Microlouvres: woven metal mats of small bars that block the high sun.

No direct light passes above the cut-off angle, the profile angle above which each bar
shades the gap below it.
"""

import math
from dataclasses import replace

from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.shading_system import System
from clerestory.bsdfgen.system_parameters import Share, positive
from clerestory.bsdfgen.venetian_geometry import venetian
from clerestory.errors import InputError


def microlouvre(
    *,
    depth: float = 1.25e-3,
    thickness: float = 0.22e-3,
    cutoff_deg: float = 40.0,
    tilt_deg: float = 0.0,
    reflectance: Share = 0.1,
    solar_reflectance: float | None = None,
) -> System:
    """Return the unit cell of an endless microlouvre.

    Parameters
    ----------
    depth, thickness : of a bar [m]
    cutoff_deg : profile angle above which no direct light passes
    tilt_deg : of the bars; positive if the outer edge is the lower one
    reflectance : of the bars
    solar_reflectance : in the solar band; None for the visible band only

    Examples
    --------
    >>> louvre = microlouvre()
    >>> round(louvre.area.thickness * 1e3, 3)
    1.25
    """
    positive(depth=depth, thickness=thickness)
    if not (0 < cutoff_deg < 90 and abs(tilt_deg) < 90):
        raise InputError(
            f"cutoff_deg = {cutoff_deg} at tilt_deg = {tilt_deg}; 0 to 90, and"
            " less than 90, expected"
        )
    louvre = venetian(
        slat_width=depth,
        spacing=_spacing(depth, thickness, math.radians(cutoff_deg), tilt_deg),
        tilt_deg=tilt_deg,
        thickness=thickness,
        reflectance=reflectance,
        solar_reflectance=solar_reflectance,
    )
    name = (
        f"Microlouvre, bars of {depth * 1e3:g} mm by {thickness * 1e3:g} mm,"
        f" cut-off {cutoff_deg:g} degrees"
    )
    return replace(louvre, product=Product(name=name))


def _spacing(depth: float, thickness: float, cutoff: float, tilt_deg: float) -> float:
    # A ray at the cut-off falls by tan(cutoff) per length; a bar covers, across it, the
    # projection of its tilted rectangular section
    turn = cutoff + math.radians(tilt_deg)
    across = depth * abs(math.sin(turn)) + thickness * abs(math.cos(turn))
    return across / math.cos(cutoff)
