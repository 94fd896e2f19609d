"""Geometry of venetian blinds and microlouvres, horizontal or vertical.

At tilt 0 slats are perpendicular to the window. Positive tilts lower the outer edge of
horizontal slats, which blocks the sun, and turn the outer edge of vertical slats to the
left, as seen from the room. Microlouvres are woven metal screens of small bars that
block direct light at profile angles above the cut-off angle.
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clerestory.array_types import Points2
from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.channel_weights import Share, channel_values, system_bands
from clerestory.bsdfgen.extrusion import arc, extruded, rotated
from clerestory.bsdfgen.shading_system import SampleArea, System
from clerestory.checks import not_negative, positive, require, within
from clerestory.scene.model import Plastic, Polygon, Scene

# Default ratio of thickness to width for slats with two different reflectances.
_THIN = 1e-3

# Smallest ratio of the unit cell's width and height to its depth, so that few rays
# cross its sides.
_SLENDER = 8.0

_MOST_SLATS, _MOST_STRIPS = 100_000, 200_000


def venetian(
    *,
    slat_width: float,
    spacing: float,
    tilt_deg: float = 0.0,
    rise: float = 0.0,
    thickness: float = 0.0,
    reflectance: Share = 0.5,
    reflectance_below: Share | None = None,
    solar_reflectance: float | None = None,
    solar_reflectance_below: float | None = None,
    specularity: float = 0.0,
    roughness: float = 0.0,
    vertical: bool = False,
    slats: int | None = None,
    length: float | None = None,
) -> System:
    """Return the unit cell of an infinite blind, or a finite sample of a blind.

    Parameters
    ----------
    slat_width : chord of a slat [m]
    spacing : distance between slats [m]
    tilt_deg : slat angle, −90 to 90; 0 is perpendicular to the window, and positive
        angles lower the outer edge, or turn it to the left for vertical slats
    rise : height of the middle of a curved slat above its chord [m]; negative if below
    thickness : slat thickness [m]
    reflectance : reflectance of the upper side at tilt 0, or of the right side of
        vertical slats
    reflectance_below : reflectance of the opposite side; default: `reflectance`
    solar_reflectance, solar_reflectance_below : reflectances in the solar band; None
        for the visible band only
    specularity, roughness : parameters of Radiance's material `plastic`, for both sides
    vertical : whether the slats are vertical
    slats : number of slats of a finite sample; None for an infinite blind
    length : slat length of a finite sample [m]; default: number of slats × spacing

    Examples
    --------
    >>> blind = venetian(slat_width=0.08, spacing=0.072, tilt_deg=45, reflectance=0.48)
    >>> round(blind.area.thickness, 6), blind.area.periodic
    (0.056569, True)
    """
    positive([slat_width, spacing], "slat_width or spacing", unit="m")
    not_negative(thickness, "thickness", unit="m")
    within(tilt_deg, "tilt_deg", least=-90, most=90)
    within(rise, "rise", least=-slat_width / 2, most=slat_width / 2, unit="m")
    below = reflectance if reflectance_below is None else reflectance_below
    solar = solar_reflectance
    solar_below = solar if solar_reflectance_below is None else solar_reflectance_below
    known = solar is not None or solar_below is None
    require(known, "solar_reflectance_below without solar_reflectance; both expected")
    upper, lower = (
        Plastic(name, channel_values(what, value, band), specularity, roughness)
        for name, what, value, band in (
            ("upper", "reflectance", reflectance, solar),
            ("lower", "reflectance_below", below, solar_below),
        )
    )
    alike = bool(np.all(upper.reflectance == lower.reflectance))
    if not alike and thickness == 0:
        thickness = _THIN * slat_width

    section = _section(slat_width, rise, thickness, math.radians(tilt_deg))
    high, low = section[:, 1].max(), section[:, 1].min()
    section = section - np.array([0, high])
    depth = max(high - low, 1e-3 * slat_width)
    layout = (
        _cell(spacing, depth, float(np.abs(section[:, 0]).max()))
        if slats is None
        else _sample(spacing, slats, length)
    )
    total = (layout.slats + 2 * layout.beyond) * len(section)
    message = f"{total} flat strips of slats; at most {_MOST_STRIPS} expected"
    require(total <= _MOST_STRIPS, message)
    surfaces: list[Polygon] = []
    for number in range(-layout.beyond, layout.slats + layout.beyond):
        strips = extruded(
            section + np.array([(number + 0.5) * spacing, 0]),
            ends=layout.ends,
            material="upper",
            name=f"slat{number}",
            closed=thickness > 0,
        )
        surfaces += rotated(strips) if vertical else strips
    if not alike:
        surfaces = [_painted(s, len(section) // 2) for s in surfaces]
    name = (
        f"{'Vertical' if vertical else 'Horizontal'} blind, slats of"
        f" {slat_width * 1e3:g} mm every {spacing * 1e3:g} mm at {tilt_deg:g} degrees"
    )
    materials = {"upper": upper} if alike else {"upper": upper, "lower": lower}
    corner = np.array([layout.across, layout.slats * spacing, 0.0])
    low = np.array([0, 0, -depth])
    if vertical:
        low, corner = low - [0, corner[0], 0], corner[[1, 2, 2]]
    return System(
        Scene(materials, tuple(surfaces)),
        SampleArea(np.stack([low, corner]), periodic=slats is None),
        system_bands(solar),
        Product(name=name, device_type="Venetian Blinds"),
    )


class _Layout(NamedTuple):
    # `slats`: slats in the sample area; `beyond`: slats on each side of the area that
    # extend into the area; `across`: area width [m]; `ends`: range of x of slats [m]
    slats: int
    beyond: int
    across: float
    ends: tuple[float, float]


def _cell(spacing: float, depth: float, reach: float) -> _Layout:
    count = max(1, math.ceil(_SLENDER * depth / spacing))
    beyond = math.ceil(max(0.0, reach - spacing / 2) / spacing)
    across = max(count * spacing, _SLENDER * depth)
    return _Layout(count, beyond, across, (-0.01 * across, 1.01 * across))


def _sample(spacing: float, slats: int, length: float | None) -> _Layout:
    whole = float(slats).is_integer() and 1 <= slats <= _MOST_SLATS
    require(whole, f"slats is {slats}; a whole number from 1 to {_MOST_SLATS} expected")
    across = slats * spacing if length is None else length
    positive(across, "length", unit="m")
    return _Layout(int(slats), 0, across, (0.0, across))


def _section(width: float, rise: float, thickness: float, tilt: float) -> Points2:
    # Points (y, z) of a slat around its middle: the upper side from the inner to the
    # outer edge, then the lower side from the outer to the inner edge
    line = arc(width, rise)[::-1]
    lift = np.array([0, thickness / 2])
    points = line + lift
    if thickness > 0:
        points = np.concatenate([points, line[::-1] - lift])
    along, above = points.T
    y = along * np.sin(tilt) + above * np.cos(tilt)
    z = along * np.cos(tilt) - above * np.sin(tilt)
    return np.stack([y, z], axis=1)


def _painted(strip: Polygon, half: int) -> Polygon:
    number = int(strip.name.rpartition(".")[2])
    lower = number >= half
    return Polygon(strip.vertices, "lower" if lower else "upper", strip.name)


def microlouvre(
    *,
    depth: float = 1.25e-3,
    thickness: float = 0.22e-3,
    cutoff_deg: float = 40.0,
    tilt_deg: float = 0.0,
    reflectance: Share = 0.1,
    solar_reflectance: float | None = None,
) -> System:
    """Return the unit cell of an infinite microlouvre.

    Parameters
    ----------
    depth, thickness : dimensions of a bar [m]
    cutoff_deg : profile angle above which no direct light passes
    tilt_deg : tilt of the bars; positive if the outer edge is lower
    reflectance : reflectance of the bars
    solar_reflectance : reflectance in the solar band; None for the visible band only
    """
    require(
        0 < cutoff_deg < 90 and abs(tilt_deg) < 90,
        f"cutoff_deg is {cutoff_deg} and tilt_deg {tilt_deg}; a cut-off angle between"
        " 0 and 90° and a tilt between -90 and 90° expected",
    )
    # At the cut-off angle the projections of adjacent bars along the ray just touch
    cutoff = math.radians(cutoff_deg)
    turn = cutoff + math.radians(tilt_deg)
    across = depth * abs(math.sin(turn)) + thickness * abs(math.cos(turn))
    louvre = venetian(
        slat_width=depth,
        spacing=across / math.cos(cutoff),
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
